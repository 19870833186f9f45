"""Where and with what a result was made, as plain values."""

from __future__ import annotations

import sys
from datetime import UTC, datetime
from pathlib import Path

from contwalk.system import System
from contwalk.workflow.machine import name_of_machine, versions_and_processor


def made_with(path: Path, reference: str, system: System) -> dict[str, str]:
    """Versions, machine, time, run file and plugin."""
    return {
        **versions_and_processor(),
        "python": sys.version.split()[0],
        "platform": name_of_machine(),
        "time": datetime.now(UTC).isoformat(timespec="seconds"),
        "run_file": str(path),
        "run_file_directory": str(path.resolve().parent),
        "system_reference": reference,
        "plugin_sha256": system.source,
    }


def made_with_but_the_hour(path: Path, reference: str, system: System) -> dict[str, str]:
    """As `made_with`, without the hour: files of the same study are the same to the last bit."""
    return {name: value for name, value in made_with(path, reference, system).items() if name != "time"}

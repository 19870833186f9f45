"""The command line in a folder of its own."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from contwalk.cli.entry import run


@pytest.fixture
def contwalk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture) -> Callable:
    """Runs a command in an empty folder; its exit code, and all that it has said."""
    monkeypatch.chdir(tmp_path)

    def called(*arguments: str) -> tuple[int, str]:
        code = run(arguments)
        return code, "".join(capsys.readouterr())

    return called

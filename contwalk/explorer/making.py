"""How the file of a page was made, and how to make it again, for whoever has the page alone."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from contwalk.printable import printable

# What made it, as far as a file tells, in the order in which it is told.
MADE_WITH = ("contwalk_version", "python", "numpy", "numba", "llvmlite", "h5py", "processor", "time")
CALLED = {"contwalk_version": "contwalk", "python": "Python"}


def making_of(config: str, provenance: Mapping[str, Any], command: str) -> dict[str, Any]:
    """Sentences, and the text of the run file, as plain JSON values; empty where the file has no such text.

    Parameters
    ----------
    config : str
        Text of the run file, as it is stored.
    provenance : mapping
        What is stored of the run: versions, names, hashes.
    command : str
        What was done with the run file, as `continue`.
    """
    if not config:
        return {}
    run = Path(str(provenance.get("run_file") or "run.yaml")).name
    reference = str(provenance.get("system_reference", ""))
    told = [f"{CALLED.get(name, name)} {provenance[name]}" for name in MADE_WITH if provenance.get(name)]
    facts = [f"Made with {', '.join(told)}."] if told else []
    if (accuracy := provenance.get("accuracy")) is not None:
        facts.append(f"Requested relative error of special points: {accuracy}.")
    beside = ""
    if reference.startswith("equations:"):
        facts.append("The equations are in the run file below.")
    elif reference.endswith(".py"):
        plugin = Path(reference).name
        sha256 = provenance.get("plugin_files", {}).get(plugin) or provenance.get("plugin_sha256")
        facts.append(
            f"The equations are in the plugin {plugin}, which is not in this page: ask whoever sent it. "
            f"Its sha256 is {sha256}."
        )
        beside = f", {plugin} where it names it,"
    elif reference:
        facts.append(
            f"The equations are those of the system {reference}, which comes with contwalk or a package."
        )
    facts.append(f"To make it again, save the text below as {run}{beside} and run: contwalk {command} {run}")
    return {
        "facts": [printable(fact) for fact in facts],
        "config": "\n".join(printable(line) for line in config.splitlines()),
    }

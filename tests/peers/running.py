"""The problems in `problems/`, and running one study as a user would: from a run file into a database."""

from __future__ import annotations

import json
import time
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from peers.form import Peer, Study

import contwalk as cw
from contwalk.branch import Branch

# Problems, and machines with events as they stand in the literature.
FOLDERS = ("problems", "machines")


@dataclass(frozen=True)
class Ran:
    """What a study left behind, and what it cost."""

    branches: list[Branch]
    seconds: float


def peers() -> dict[str, Peer]:
    """All problems by the name of their file."""
    modules = {name: import_module(f"peers.{path.parent.name}.{name}") for name, path in _files().items()}
    return {name: module.PEER for name, module in modules.items() if hasattr(module, "PEER")}


def _files() -> dict[str, Path]:
    """Files by their names: with problems, and what they use; not with tests."""
    found = [path for folder in FOLDERS for path in sorted((Path(__file__).parent / folder).glob("*.py"))]
    return {path.stem: path for path in found if not path.stem.startswith("test_")}


def machines() -> dict[str, Peer]:
    """Those of `machines/`, in the order of their titles."""
    found = [name for name, path in _files().items() if path.parent.name == "machines"]
    known = {name: peer for name, peer in peers().items() if name in found}
    return dict(sorted(known.items(), key=lambda item: item[1].title))


def write_run_file(problem: str, study: Study, path: Path) -> None:
    """The run file of a study, with the whole path of its plugin."""
    text = {"contwalk": 1, "system": str(_files()[problem]), **study.run}
    path.write_text(json.dumps(text, indent=1) + "\n", encoding="utf-8")  # JSON is YAML


def run_study(problem: str, study: Study, folder: Path) -> Ran:
    """Run a study in `folder`; `seconds` are of processor time."""
    path = folder / "study.yaml"
    write_run_file(problem, study, path)
    began = time.process_time()
    result = cw.run(cw.read_run_file(path, output=folder / "study.h5"), figures=False)
    return Ran(result.branches, time.process_time() - began)

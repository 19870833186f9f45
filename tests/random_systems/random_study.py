"""One random study: run through the command line in a folder of its own, read back, checked."""

from __future__ import annotations

import contextlib
import io
import json
import os
import tempfile
import time
import warnings
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from random_checks import Fault, Study, faults
from random_recipes import Recipe, recipe

from contwalk.cli.entry import run
from contwalk.errors import DatabaseError
from contwalk.storage import open_database


def studied(chosen: Recipe, folder: Path) -> Study:
    """The study of a recipe, as the command line leaves it behind."""
    (folder / "machine.py").write_text(chosen.plugin_text(), encoding="utf-8")
    (folder / "run.yaml").write_text(chosen.run_text(), encoding="utf-8")
    output = folder / "run.h5"
    said = io.StringIO()
    before = os.environ.get("CONTWALK_TRACEBACK")
    os.environ["CONTWALK_TRACEBACK"] = "1"
    try:
        with (
            warnings.catch_warnings(record=True) as caught,
            contextlib.redirect_stderr(said),
            contextlib.redirect_stdout(said),
        ):
            warnings.simplefilter("always")
            code = run(
                [
                    "continue",
                    str(folder / "run.yaml"),
                    "--output",
                    str(output),
                    "--quiet",
                    "--no-figures",
                    "--force",
                ]
            )
    finally:
        if before is None:
            del os.environ["CONTWALK_TRACEBACK"]
        else:
            os.environ["CONTWALK_TRACEBACK"] = before
    branches, notes = [], {}
    with contextlib.suppress(DatabaseError), open_database(output) as db:
        branches, notes = db.branches(), dict(db.notes())
    warned = tuple(f"{Path(w.filename).name}:{w.lineno}: {w.message}" for w in caught)
    return Study(chosen, branches, notes, code, said.getvalue(), warned)


def checked(chosen: Recipe) -> dict[str, Any]:
    """A record of a recipe's study: how everything ended, and every fault."""
    with tempfile.TemporaryDirectory() as folder:
        begin = time.process_time()
        study = studied(chosen, Path(folder))
        middle = time.process_time()
        left_out: list[str] = []
        found = list(faults(study, left_out))
        end = time.process_time()
    return record(study, found) | {
        "left_out": len(left_out),
        "seconds": round(middle - begin, 3),
        "checking": round(end - middle, 3),
    }


def record(study: Study, found: list[Fault]) -> dict[str, Any]:
    """What a study's line in the results says."""
    points = [p for b in study.branches for p in b.special_points]
    return {
        "seed": study.recipe.seed,
        "family": study.recipe.family,
        "states": study.recipe.states,
        "code": study.code,
        "branches": dict(Counter(b.info.problem for b in study.branches)),
        "rows": int(sum(len(b) for b in study.branches)),
        "reasons": dict(Counter(str(p.kind) for p in points if p.label == "EP"))
        | dict(Counter(f"start: {b.outcome.reason}" for b in study.branches if not len(b))),
        "outcomes": dict(Counter(f"{b.info.problem}: {b.outcome.reason}" for b in study.branches)),
        "points": dict(Counter(p.label for p in points if p.label != "EP" and p.status == "located")),
        "unlocated": dict(Counter(p.label for p in points if p.status == "unlocated")),
        "faults": [asdict(f) for f in found],
    }


def main_of(seed: int) -> str:
    """One line of results, for a seed."""
    return json.dumps(checked(recipe(seed)), default=plain)


def plain(value: Any) -> Any:
    """What JSON has no form for."""
    return value.item() if isinstance(value, np.generic) else str(value)

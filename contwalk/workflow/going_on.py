"""A stored run that goes on with wider settings: what is allowed, and which branch belongs to which start."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from contwalk.branch import BranchInfo
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.opening import Opening
from contwalk.storage.database import Database, RunHeader
from contwalk.workflow.file_names import output_of
from contwalk.workflow.run_file.reading import RunFile

WIDENED = "widened"  # of the provenance: whether the run has gone on with other settings since it began
KEY = "diagram.effort"
CLOSE = 1e-6  # in typical magnitudes: the same start, corrected in another metric


def differences(run_file: RunFile, header: RunHeader) -> list[str]:
    """Keys of the run file that forbid to go on with a stored run; none where it asks for the same, or more.

    More is a larger `max_points` or `effort`, and a range that contains the one before; not along a path,
    which begins at an end of its range.
    """
    stored, asked = run_file.settings_of(header.config), run_file.settings_of(run_file.data)
    if stored is None or asked is None:
        return ["the whole file"]
    walked, now = stored.pop("continue_"), asked.pop("continue_")
    before, most = (study["diagram"].pop("effort") for study in (stored, asked))
    found = [key for key in asked if asked[key] != stored.get(key)]
    for key in now:
        if now[key] == walked[key]:
            continue
        larger = key == "max_points" and now[key] > walked[key]
        wider = key == "range" and asked["path"] is None and _contains(now[key], walked[key])
        if not (larger or wider):
            found.append(f"continue.{key}")
    if before != most and most is not None and (before is None or most < before):
        found.append("diagram.effort")
    return found


def command_without_bound(run_file: RunFile) -> str:
    """The command that goes on with a run, whatever that costs."""
    words = ["contwalk", "continue", str(run_file.path)]
    for override in run_file.overrides:
        words += [] if override.partition("=")[0].strip() == KEY else ["--set", override]
    if run_file.output != output_of(run_file.path, run_file.data.get("output")):
        words += ["--output", str(run_file.output)]
    return shlex.join([*words, "--resume", "--set", f"{KEY}=none"])


def _contains(outer: Any, inner: Any) -> bool:
    if isinstance(outer, dict) and isinstance(inner, dict):
        return outer.keys() == inner.keys() and all(_contains(outer[name], inner[name]) for name in outer)
    if isinstance(outer, dict) or isinstance(inner, dict):
        return False
    return bool(outer) and bool(inner) and outer[0] <= inner[0] and inner[1] <= outer[1]


def header_of_both(run_file: RunFile, header: RunHeader) -> RunHeader:
    """The stored header with the run file that it goes on with."""
    same = run_file.same_study(header.config)
    provenance = header.provenance if same else {**header.provenance, WIDENED: True}
    return replace(header, config=run_file.config(), provenance=provenance)


class Claims:
    """Which stored branch belongs to which start, of a run that has gone on with wider settings.

    A branch that goes on may get further special points, and so starts may come in another order than that in
    which branches were stored. A start is told by where it leaves its parent, and by its first point.

    Attributes
    ----------
    left : list of str
        Stored branches that no start has claimed.
    """

    def __init__(self, db: Database) -> None:
        self._db = db
        self.left = db.branch_names()

    def __call__(self, start: Start) -> str | None:
        """The name of the stored branch, or None."""
        found = next((name for name in self.left if self._belongs(name, start)), None)
        if found is not None:
            self.left.remove(found)
        return found

    def _belongs(self, name: str, start: Start) -> bool:
        info = self._db.branch(name).info
        if not _of_one_origin(info, start):
            return False
        rows = self._db.rows(name)
        if not len(rows) or not isinstance(start.opening, Opening):
            return not len(rows)
        z = start.opening.state.sample.z
        first, weights = rows[0]["unknowns"], rows[0]["weights"]
        first = np.append(first[np.isfinite(first)], rows[0]["free"][0])
        return len(first) == len(z) and bool(np.all(np.abs(first - z) <= CLOSE * weights[: len(z)]))


def claims_of(db: Database) -> dict[str, Any]:
    """How starts find their stored branches, where these need not be in the order of the starts."""
    if not db.header.provenance.get(WIDENED):
        return {}
    return {"claim": Claims(db), "taken": db.branch_names()}


def _of_one_origin(info: BranchInfo, start: Start) -> bool:
    if info.parent is not None or start.parent is not None:
        return info.parent == start.parent
    fixed: Mapping[str, float] = {k: v for k, v in info.parameters.items() if k not in info.free}
    return info.origin == start.origin and all(start.parameters.get(k) == v for k, v in fixed.items())

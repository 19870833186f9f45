"""The JSON document of a run: what `contwalk show DB --json` prints.

Its `schema_version` is 1, 2 where there are curves in two parameters, and 3 where stability is not known
somewhere: what tells it is null there.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from importlib.resources import files
from itertools import chain
from typing import Any

import numpy as np

from contwalk.branch import FIXED_POINT, NOT_KNOWN, Branch, BranchInfo, SpecialPoint
from contwalk.labels import LOCUS
from contwalk.quantities import NEUTRAL_SADDLE, saddles
from contwalk.signatures import is_iterated
from contwalk.special_point import nearest_to
from contwalk.storage.database import Database

DOCUMENT_VERSION, WITH_LOCI, WITH_UNKNOWN = 1, 2, 3
SIDES = ("unstable_before", "unstable_after")


def interface_schema() -> dict[str, Any]:
    """The JSON Schema that every document obeys."""
    text = files("contwalk.storage").joinpath("interface.schema.json").read_text(encoding="utf-8")
    schema: dict[str, Any] = json.loads(text)
    return schema


def document(db: Database, points: bool = False, only: Sequence[str] | None = None) -> dict[str, Any]:
    """The run as plain JSON values.

    Parameters
    ----------
    db : Database
    points : bool
        Whether to include every point of each branch.
    only : sequence of str, optional
        Names of the branches to include; all for None.

    Raises
    ------
    DatabaseError
        If a branch does not exist, or the file is damaged.
    """
    header = db.header
    loaded: dict[str, Branch] = {}
    names = db.branch_names() if only is None else only
    branches = [_branch(db, _load(db, name, loaded), loaded, points) for name in names]
    return {
        "schema_version": _version(branches),
        "contwalk_version": str(header.provenance.get("contwalk_version", "unknown")),
        "author": header.provenance.get("author"),
        "description": header.provenance.get("description"),
        "system": header.system,
        "model": _json(header.model),
        "config": header.config,
        "branches": branches,
        "notes": [{"key": key, "text": text} for key, text in db.notes().items()],
    }


def _version(branches: Sequence[Mapping[str, Any]]) -> int:
    """The least version that has all that the document tells."""
    sides = (point[side] for branch in branches for point in branch["special_points"] for side in SIDES)
    rows = (row["unstable"] for branch in branches for row in branch.get("points", ()))
    if any(count is None for count in chain(sides, rows)):
        return WITH_UNKNOWN
    return WITH_LOCI if any(branch["problem"] == LOCUS for branch in branches) else DOCUMENT_VERSION


def _load(db: Database, name: str, loaded: dict[str, Branch]) -> Branch:
    if name not in loaded:
        loaded[name] = db.branch(name)
    return loaded[name]


def _branch(db: Database, branch: Branch, loaded: dict[str, Branch], points: bool) -> dict[str, Any]:
    info = branch.info
    entry = {
        "name": info.name,
        "problem": info.problem_by_name,
        "parent": _parent(db, branch, loaded),
        "free": list(info.free),
        "closure": info.closure,
        "signature": None if is_iterated(info.signature) else _json(info.signature),
        "subharmonic": info.subharmonic,
        "mirror": _json(info.settings.get("mirror")),
        "n_points": len(branch),
        "status": branch.outcome.status,
        "reason": branch.outcome.reason,
        "message": branch.outcome.message,
        "cost": _json(branch.cost),
        "special_points": [_special(point) for point in branch.special_points],
    }
    if info.problem == LOCUS:
        entry |= {"of": info.settings["of"], "of_problem": _of_problem(info)}
    return entry | {"points": [_point(branch, row) for row in branch.points]} if points else entry


def _of_problem(info: BranchInfo) -> str:
    """What solutions a curve is of: cycles of a map are fixed points."""
    return FIXED_POINT if is_iterated(info.signature) else str(info.settings["of_problem"])


def _parent(db: Database, branch: Branch, loaded: dict[str, Branch]) -> str | None:
    """`b1/HB1`: the special point of the parent nearest to the arclength at which the branch left it."""
    if branch.info.parent is None or branch.info.parent[0] not in db.branch_names():
        return None
    name, s = branch.info.parent
    point = nearest_to(_load(db, name, loaded).special_points, s)
    return None if point is None else f"{name}/{point.name}"


def _special(point: SpecialPoint) -> dict[str, Any]:
    extra = {name: _json(getattr(point, name)) for name in ("errors", "mark") if getattr(point, name)}
    return extra | {
        "name": point.name,
        "label": point.label,
        "kind": point.kind,
        "status": point.status,
        "index": point.index,
        "parameters": _json(point.parameters),
        "state": _json(point.state),
        "period": _finite(point.period),
        "period_full": _finite(point.period_full),
        "spectrum": _json(point.spectrum),
        "spectrum_full": _json(point.spectrum_full),
        "trivial_error": _finite(point.trivial_error),
        "unstable_before": point.unstable_before,
        "unstable_after": point.unstable_after,
        "error": _finite(point.error),
        "criticality": point.criticality,
        "coefficients": _json(point.coefficients),
        "admissible": point.admissible,
        "margin": _json(point.margin),
        "note": point.note,
    }


def _point(branch: Branch, row: np.void) -> dict[str, Any]:
    info = branch.info
    kind = {"kind": kind_of_row(branch, row)} if info.problem == LOCUS else {}
    return kind | {
        "free": _json(row["free"]),
        "state": dict(zip(info.states, _json(row["state"]), strict=True)),
        "observables": dict(zip(info.observables, _json(row["observables"]), strict=True)),
        "period": _finite(row["period"]),
        "unstable": None if row["undecided"] else int(row["unstable"]),
        "stable": None if row["stable"] == NOT_KNOWN else bool(row["stable"]),
        "admissible": bool(row["admissible"]),
        "s": _json(row["s"]),
        "special": bool(row["special"]),
        "spectrum_error": _json(row["spectrum_error"]),
    }


def kind_of_row(branch: Branch, row: np.void) -> str | None:
    """`neutral_saddle` where a curve of pairs goes on with real eigenvalues; else None."""
    return NEUTRAL_SADDLE if saddles(branch.info.observables, row["observables"][None])[0] else None


def _finite(value: float | None) -> float | None:
    """A number where the document allows only numbers: null for one that is absent or not finite."""
    return float(value) if value is not None and math.isfinite(value) else None


def _json(value: Any) -> Any:
    """Plain JSON values: complex numbers as [re, im], numbers that are not finite as text."""
    if isinstance(value, np.generic | np.ndarray):
        value = value.tolist()
    if isinstance(value, complex):
        return [_json(value.real), _json(value.imag)]
    if isinstance(value, float) and not math.isfinite(value):
        return repr(value)
    if isinstance(value, Mapping):
        return {key: _json(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_json(item) for item in value]
    return value

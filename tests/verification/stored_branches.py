"""Branches as text: what a database holds of a branch, as far as `verify` asks for it."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from contwalk.branch import Branch, BranchInfo, Outcome
from contwalk.branch_point import SpecialPoints
from contwalk.special_point import SpecialPoint

FOLDER = Path(__file__).parent / "stored"


def written(branch: Branch, rows: slice, names: tuple[str, ...]) -> str:
    """A part of a branch as text; special points keep their numbers of rows, counted from the part."""
    points = branch.points[rows]
    columns = {
        name: np.stack([points[name].real, points[name].imag]).tolist()
        if points.dtype[name].base.kind == "c"
        else points[name].tolist()
        for name in points.dtype.names or ()
    }
    special = [
        asdict(point)
        | {"index": point.index - rows.start}
        | {"spectrum": [[v.real, v.imag] for v in point.spectrum], "spectrum_full": None}
        for point in branch.special_points
        if point.name in names
    ]
    parts = {"info": asdict(branch.info), "outcome": asdict(branch.outcome)}
    return json.dumps({**parts, "points": columns, "special_points": special}, indent=1) + "\n"


def read(name: str) -> Branch:
    """The branch of a file in `stored/`."""
    found: dict[str, Any] = json.loads((FOLDER / name).read_text(encoding="utf-8"))
    info = BranchInfo(**{key: _tuples(value) for key, value in found["info"].items()})
    columns = found["points"]
    points = np.zeros(len(columns["s"]), dtype=info.point_dtype())
    for key, values in columns.items():
        if points.dtype[key].base.kind == "c":
            points[key] = np.array(values[0]) + 1j * np.array(values[1])
        else:
            points[key] = np.array(values)
    special = SpecialPoints()
    for each in found["special_points"]:
        spectrum = tuple(complex(*value) for value in each["spectrum"])
        kept = each | {"unknowns": tuple(each["unknowns"]), "tangent": tuple(each["tangent"])}
        special.append(SpecialPoint(**kept | {"spectrum": spectrum}))
    return Branch(info, points, special, Outcome(**found["outcome"]))


def _tuples(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value

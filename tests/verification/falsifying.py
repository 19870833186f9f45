"""What may be wrong of a stored record: each falsification by what was done to it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from contwalk.branch import Branch, SpecialPoint
from contwalk.labels import END, LOCUS, MARK

# What a row says: how it is changed so that it is no longer so.
ROWS = {
    "its stability turned": ("stable", lambda row: 1 - row["stable"]),
    "one more unstable direction": ("unstable", lambda row: row["unstable"] + 1),
    "another leading eigenvalue": ("spectrum", lambda row: 1.001 * row["spectrum"] + 0.1),
    "its admissibility turned": ("admissible", lambda row: not row["admissible"]),
    "another state": (
        "unknowns",
        lambda row: row["unknowns"] + 1e-3 * row["weights"][: len(row["unknowns"])],
    ),
}
WORDS = ("bound", "closed", "homoclinic", "shrunk", "unbounded", "grazing")


def moved(branch: Branch, point: SpecialPoint, errors: float, which: int = 0) -> SpecialPoint:
    """A point at another value of a free parameter, so many errors, or roundings of its size, away."""
    free, place = branch.info.free[which], -1 - which
    unknowns = list(point.unknowns)
    size = max(abs(unknowns[place]), float(branch.points["weights"][point.index][len(unknowns) + place]))
    error = point.error if which == 0 else point.errors.get(free)
    unknowns[place] += errors * max(error or 0.0, 4.0 * float(np.spacing(size)))
    parameters = {**point.parameters, free: unknowns[place]}
    return replace(point, unknowns=tuple(unknowns), parameters=parameters)


def points(branch: Branch, point: SpecialPoint) -> Iterator[tuple[str, SpecialPoint]]:
    """A special point with something wrong, by what was done to it."""
    if point.label in (END, MARK) or point.status != "located":
        return
    for which in range(len(branch.info.free)):
        for way in (100.0, -100.0):
            yield f"{branch.info.free[which]} moved by {way:+g} errors", moved(branch, point, way, which)
    yield "admissible turned", replace(point, admissible=not point.admissible)
    for name, value in point.margin.items():
        yield f"margin {name} changed", replace(point, margin={**point.margin, name: 1.01 * value + 0.01})
    if branch.info.problem == LOCUS:
        return
    if point.criticality:
        other = {"supercritical": "subcritical", "subcritical": "supercritical"}[point.criticality]
        yield "another criticality", replace(point, criticality=other)
        for name in sorted({"l1", "c", "d"} & set(point.coefficients)):
            turned = {**point.coefficients, name: -point.coefficients[name]}
            yield "criticality and coefficient turned", replace(point, criticality=other, coefficients=turned)
            larger = {**point.coefficients, name: 2.0 * point.coefficients[name]}
            yield "a coefficient twice as large", replace(point, coefficients=larger)
    if "omega" in point.coefficients:
        coefficients = {**point.coefficients, "omega": 2.0 * point.coefficients["omega"]}
        yield "another pair's omega", replace(point, coefficients=coefficients)
    if point.label in ("HB", "PD", "NS"):
        yield "another pair", replace(point, spectrum=(1.5 * point.spectrum[0] + 0.1, *point.spectrum[1:]))
        before, after = point.unstable_before or 0, point.unstable_after or 0
        yield "other counts", replace(point, unstable_before=before + 1, unstable_after=after + 1)
        yield "labelled LP", replace(point, label="LP", criticality=None, coefficients={})
    if "'ceiling'" in (point.note or ""):
        note = (point.note or "").replace("ceiling", "speed")
        kind = "speed" if point.kind == "ceiling" else point.kind
        yield "another touch", replace(point, note=note, kind=kind)


def ends(branch: Branch) -> Iterator[tuple[str, SpecialPoint]]:
    """Ends with wrong words."""
    for end in branch.special_points:
        if end.label == END:
            for word in WORDS:
                if word != end.kind:
                    yield f"the end {end.kind} called {word}", replace(end, kind=word)


def rows(branch: Branch, of: int = 1) -> Iterator[tuple[str, Branch, int]]:
    """Branches with a wrong row, `of` of them along each."""
    ordinary = [k for k in range(1, len(branch)) if not branch.points[k]["special"]]
    for k in range(of):
        row = ordinary[(2 * k + 1) * len(ordinary) // (2 * of)]
        for what, (column, change) in ROWS.items():
            if branch.info.problem == LOCUS and column == "stable":
                continue
            points_ = branch.points.copy()
            points_[column][row] = change(points_[row])
            yield what, replace(branch, points=points_), row

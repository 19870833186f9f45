"""Branches in a line of text, and as tables with a small diagram for notebooks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from contwalk import quantities, tables
from contwalk.labels import LOCUS
from contwalk.signatures import told_problem
from contwalk.small_picture import Line, svg
from contwalk.special_point import told_sides, told_what


def told_branch(branch: Any) -> str:
    """`b2: 64 points, periodic orbit, delta 0.003 to 0.006; PD1 UZ1; complete (bound)`."""
    info, outcome, what = branch.info, branch.outcome, told_problem(branch.info.problem_by_name)
    parts = [f"{info.name}: {len(branch)} point{'' if len(branch) == 1 else 's'}, {what}"]
    if len(branch) and info.free:
        values = branch[info.free[0]]
        parts[0] += f", {info.free[0]} {values.min():.6g} to {values.max():.6g}"
    parts.append(_names([point.name for point in branch.special_points]))
    parts.append(f"{outcome.status} ({outcome.reason})")
    return "; ".join(part for part in parts if part)


def _names(names: Sequence[str], most: int = 8) -> str:
    """Names of special points; the first ones of many."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return " ".join(names[:most]) + more


def table_of_special_points(branch: Any) -> tables.Table:
    """The special points of a branch, one a row."""
    free = branch.info.free[0] if branch.info.free else ""
    rows = [["name", "what", free, "error", "criticality", "unstable"]]
    for point in branch.special_points:
        value = point.parameters.get(free, float(branch[free][point.index]) if free and len(branch) else None)
        rows.append(
            [
                point.name,
                told_what(point),
                "" if value is None else f"{value:.12g}",
                "" if point.error is None else f"{point.error:.1e}",
                point.criticality or "",
                told_sides(point, "\u2192"),
            ]
        )
    return rows


def table_of_branches(branches: Sequence[Any]) -> tables.Table:
    """Branches, one a row."""
    rows = [["branch", "problem", "points", "range", "special points", "ended", "origin"]]
    for branch in branches:
        info, free = branch.info, branch.info.free[0] if branch.info.free else ""
        span = ""
        if free and len(branch):
            span = f"{free} {branch[free].min():.6g} to {branch[free].max():.6g}"
        names = _names([point.name for point in branch.special_points])
        ended = f"{branch.outcome.status} ({branch.outcome.reason})"
        rows.append(
            [info.name, told_problem(info.problem_by_name), str(len(branch)), span, names, ended, info.origin]
        )
    return rows


def small_diagram(branches: Sequence[Any]) -> str:
    """Branches along their first parameter as SVG: of curves the second one, of others the first state that
    moves, of orbits its largest value. Empty where there is nothing to draw.
    """
    whole = [branch for branch in branches if len(branch) and branch.info.free]
    solutions = [branch for branch in whole if branch.info.problem != LOCUS] or whole
    if not solutions:
        return ""
    free = solutions[0].info.free
    alike = [branch for branch in solutions if branch.info.free == free]
    if alike[0].info.problem == LOCUS:
        return svg([_line(branch, free[0], free[1]) for branch in alike], free[0], free[1])
    moving = [name for name in alike[0].info.states if any(np.ptp(_values(b, name)) > 0 for b in alike)]
    name = (moving or list(alike[0].info.states))[0]
    orbits = any(b.info.problem != "equilibrium" and b.knows(quantities.MAX + name) for b in alike)
    upwards = f"{name}, of orbits the largest" if orbits else name
    return svg([_line(branch, free[0], name) for branch in alike], free[0], upwards)


def _values(branch: Any, name: str) -> np.ndarray:
    """A state along a branch, shape (k,); its largest value where orbits have one."""
    largest = quantities.MAX + name
    return np.asarray(branch[largest if branch.knows(largest) else name], dtype=float)


def _line(branch: Any, across: str, upwards: str) -> Line:
    x, y = (np.asarray(_values(branch, name), dtype=float) for name in (across, upwards))
    stable, special = branch["stable"], branch.points["special"]
    # At a special point itself it is decided by rounding: the other end of a segment tells.
    of_segments = np.where(special[1:], stable[:-1], stable[1:])
    points = [(p.name, told_what(p), x[p.index], y[p.index]) for p in branch.special_points]
    return Line(branch.name, x, y, of_segments, points)

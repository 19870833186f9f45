"""What a page draws of branches: their values along every axis, styles of their stretches, special points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from contwalk import quantities
from contwalk.branch import Branch, SpecialPoint
from contwalk.explorer.packing import short
from contwalk.labels import EVERY_MEANING, LOCUS
from contwalk.number_words import exact, in_brackets, with_unit
from contwalk.plotting.orbit_values import default_y, drawn_by
from contwalk.plotting.quantities import BUILT_IN_OBSERVABLES, candidates_for_y, default_x, unit_of
from contwalk.plotting.segments import runs
from contwalk.printable import printable
from contwalk.signatures import told_problem
from contwalk.special_point import told_sides, told_what
from contwalk.workflow.stored.point_words import free_value


def diagram_of(branches: Sequence[Branch], units: Mapping[str, str]) -> dict[str, Any]:
    """Branches of solutions and curves in two parameters, as plain JSON values."""
    solutions = [branch for branch in branches if branch.info.problem != LOCUS and len(branch)]
    curves = [branch for branch in branches if branch.info.problem == LOCUS and len(branch)]
    return {
        "branches": [_branch(branch, units) for branch in branches],
        "diagram": _panel(solutions, units) if solutions else None,
        "plane": _plane(curves, units) if curves else None,
        "meanings": dict(EVERY_MEANING),
    }


def _panel(branches: Sequence[Branch], units: Mapping[str, str]) -> dict[str, Any]:
    """What may stand on the axes, and what does at first."""
    across = dict.fromkeys(
        [
            default_x(branches),
            *(name for branch in branches for name in branch.info.free),
            *_varying(branches),
        ]
    )
    upwards = dict.fromkeys([default_y(branches), *candidates_for_y(branches), *_further(branches)])
    return {
        "names": [branch.name for branch in branches],
        "x": [[name, _label(name, units)] for name in across],
        "y": [
            [name, drawn_by(branches, name, {}).label + _unit(name, units), _drawn(branches, name)]
            for name in upwards
        ],
    }


def _plane(curves: Sequence[Branch], units: Mapping[str, str]) -> dict[str, Any]:
    """The plane of two parameters of curves."""
    names = list(dict.fromkeys(name for curve in curves for name in curve.info.free))
    return {
        "names": [curve.name for curve in curves],
        "x": [[name, _label(name, units)] for name in names],
        "y": [[name, _label(name, units), {}] for name in [*names[1:], names[0]]],
    }


def _varying(branches: Sequence[Branch]) -> list[str]:
    """Parameters that differ from branch to branch."""
    values: dict[str, set[float]] = {}
    for branch in branches:
        for name, value in branch.info.parameters.items():
            values.setdefault(name, set()).add(float(value))
    return [name for name, found in values.items() if len(found) > 1]


def _further(branches: Sequence[Branch]) -> list[str]:
    """Quantities beside observables and states: periods, margins, how stable."""
    found = [name for branch in branches for name in branch.info.observables if not quantities.of_orbit(name)]
    periods = ["period"] if any(np.isfinite(branch.points["period"]).any() for branch in branches) else []
    own = [name for name in BUILT_IN_OBSERVABLES if any(branch.knows(name) for branch in branches)]
    return [*own, *periods, *found]


def _drawn(branches: Sequence[Branch], name: str) -> dict[str, list[str]]:
    """By which quantities each branch is drawn, where these are others than the name itself."""
    having = [branch for branch in branches if branch.knows(name)]
    names = drawn_by(having, name, {}).names
    return {b.name: list(own) for b, own in zip(having, names, strict=True) if own != (name,)}


def _label(name: str, units: Mapping[str, str]) -> str:
    return name + _unit(name, units)


def _unit(name: str, units: Mapping[str, str]) -> str:
    return in_brackets(unit_of(name, units))


def _branch(branch: Branch, units: Mapping[str, str]) -> dict[str, Any]:
    """One branch: what is told of it, its values, stretches of one style, its special points."""
    info, outcome = branch.info, branch.outcome
    of = info.settings.get("of")
    return {
        "name": info.name,
        "problem": told_problem(info.problem_by_name) + (f" of {of}" if of else ""),
        "origin": printable(info.origin),
        "ended": printable(f"{outcome.status} ({outcome.reason}): {outcome.message}"),
        "free": list(info.free),
        "plane": info.problem == LOCUS,
        "orbit": info.settings.get("of_problem", info.problem) != "equilibrium",
        "count": len(branch),
        "values": {name: short(values) for name, values in _values(branch).items()},
        "fixed": {name: short(np.array([float(value)]))[0] for name, value in info.parameters.items()},
        "runs": [[run.first, run.last, run.stable, run.admissible] for run in runs(branch)],
        "gaps": branch.gaps(),
        "unstable": branch["unstable"].tolist(),
        "spectrum": [_spectrum(branch.points["spectrum"][row]) for row in range(len(branch))],
        "points": [_special(branch, point, units) for point in branch.special_points],
    }


def _values(branch: Branch) -> dict[str, np.ndarray]:
    """Every quantity that may stand on an axis, by its name."""
    info = branch.info
    found = {name: branch[name] for name in (*info.observables, *info.states)}
    if np.isfinite(branch.points["period"]).any():
        found["period"] = branch.points["period"]
    found |= {name: branch.points["free"][:, k] for k, name in enumerate(info.free)}
    return found


def _spectrum(numbers: Sequence[complex] | np.ndarray) -> list[list[float]]:
    """Eigenvalues or multipliers as they are stored; what is not finite is left out."""
    return [[float(n.real), float(n.imag)] for n in map(complex, numbers) if np.isfinite(n)]


def _special(branch: Branch, point: SpecialPoint, units: Mapping[str, str]) -> dict[str, Any]:
    """A special point: its name, what it is, and between which rows it lies."""
    free = branch.info.free[0]
    row, share = point.index, 0.0
    if not branch.points["special"][row]:
        s = branch.points["s"]
        row = int(np.clip(np.searchsorted(s, point.s, side="right") - 1, 0, len(s) - 1))
        beyond = s[min(row + 1, len(s) - 1)] - s[row]
        share = float(np.clip((point.s - s[row]) / beyond, 0.0, 1.0)) if beyond > 0.0 else 0.0
    unit = with_unit(free, units)
    return {
        "name": point.name,
        "label": point.label,
        "what": printable(told_what(point)),
        "where": printable(f"{free} = {exact(free_value(branch, point))} {unit}".strip()),
        "sides": told_sides(point, "→"),
        "criticality": point.criticality or "",
        "located": point.status == "located",
        "index": point.index,
        "at": [row, round(share, 6)],
        "spectrum": _spectrum(point.spectrum),
    }

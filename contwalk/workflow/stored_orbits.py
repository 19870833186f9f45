"""Orbits of stored points integrated once more, to be drawn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from contwalk.branch import ORBITS, Branch, SpecialPoint
from contwalk.continuation.reopening import reopened
from contwalk.errors import ContwalkError
from contwalk.problems.orbit.discretization import Discretization
from contwalk.system import System

# Orbits of one branch, and branches, that one figure shows if it is not told which.
MOST_ORBITS, MOST_BRANCHES = 5, 6
# What a picture needs, and a little more.
PICTURE = Discretization(accuracy=1e-7)


@dataclass(frozen=True)
class Orbit:
    """A closed orbit of a stored point.

    Parameters
    ----------
    branch, point : str
        Names, as `b2` and `PD1`, or `12` for the row of this number.
    label : str
        The point with its parameter and period.
    states : ndarray, shape (k, n)
        In the order of time, over the whole period; the last row is the first one's again.
    stable : bool
        Whether it is stable on both sides of the point.
    """

    branch: str
    point: str
    label: str
    states: np.ndarray
    stable: bool


def orbits_of(system: System, branches: Sequence[Branch]) -> list[list[Orbit]]:
    """A handful of orbits of each branch of orbits: of its special points, then marked values, then ends.

    If none of them is stable but others are, one of those is added.

    Raises
    ------
    ContwalkError
        If there is no branch of orbits with a point, or none of the system's.
    """
    chosen = [b for b in branches if b.info.problem in ORBITS and len(b)][:MOST_BRANCHES]
    if not chosen:
        raise ContwalkError(
            "No branch has periodic orbits, so there is no phase portrait.",
            "Follow a Hopf point (diagram: {follow: [HB]}), or use `contwalk simulate` for a motion.",
        )
    result = []
    for branch in chosen:
        orbits = [orbit_at(system, branch, point) for point in _handful(branch)]
        if not any(orbit.stable for orbit in orbits):  # what one would see is shown in any case
            orbits = [*[orbit_at(system, branch, row) for row in _typical(branch)], *orbits]
        result.append(orbits)
    return result


def _handful(branch: Branch) -> list[SpecialPoint] | list[int]:
    """The points of a branch whose orbits are drawn, along the branch; its last one if none is special."""
    points = [p for p in branch.special_points if p.unknowns and p.status == "located"]
    first = sorted(points, key=lambda p: {"EP": 2, "UZ": 1}.get(p.label, 0))[:MOST_ORBITS]
    return sorted(first, key=lambda p: p.s) if first else [len(branch) - 1]


def _typical(branch: Branch) -> list[int]:
    """The row in the middle of the stable part, where there is one."""
    stable = np.flatnonzero(branch.points["stable"] & ~branch.points["special"])
    return [int(stable[len(stable) // 2])] if len(stable) else []


def orbit_at(system: System, branch: Branch, point: SpecialPoint | int) -> Orbit:
    """The orbit of one stored point.

    Raises
    ------
    ContwalkError
        If the branch is not one of orbits, or is of another system.
    """
    if branch.info.problem not in ORBITS:
        raise ContwalkError(
            f"Branch {branch.name} is one of {branch.info.problem.replace('_', ' ')} points.",
            "Name a point on a branch of periodic orbits.",
        )
    problem, sample = reopened(system, branch, point, PICTURE)
    _, states = problem.motion_of(sample.z)  # type: ignore[attr-defined]
    name, counts = str(point), [sample.unstable]
    if isinstance(point, SpecialPoint):
        name, counts = point.name, [point.unstable_before, point.unstable_after]
    fold = int(branch.info.settings.get("fold", 1))
    free = branch.info.free[0]
    label = f"{name}:  {free} = {sample.parameter:.6g},  T = {fold * sample.period:.4g} s"
    return Orbit(branch.name, name, label, states, not any(counts))


def columns_of(system: System, orbit: Orbit, names: Sequence[str]) -> np.ndarray:
    """Some states of an orbit, shape (k, m); angles that turn are folded into one turn, NaN between.

    Raises
    ------
    ContwalkError
        For a name that is no state.
    """
    known = system.state_names
    for name in names:
        if name not in known:
            from contwalk.system.declarations import nearest

            raise ContwalkError(
                f"'{name}' is not a state of '{system.name}'.",
                f"{nearest(name, known)} Known: {', '.join(known)}.".strip(),
            )
    curve = np.array([orbit.states[:, known.index(name)] for name in names]).T
    for column, name in enumerate(names):
        period = system.states[known.index(name)].period
        if period and np.ptp(curve[:, column]) >= period * (1.0 - 1e-9):
            turns = np.floor(curve[:, column] / period + 0.5)
            curve[:, column] -= turns * period
            breaks = np.flatnonzero(np.diff(turns)) + 1
            curve = np.insert(curve, breaks, np.nan, axis=0)
    return curve

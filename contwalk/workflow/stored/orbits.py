"""Orbits of stored points integrated once more, to be drawn."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

from contwalk.branch import ORBITS, Branch, SpecialPoint
from contwalk.diagram.reopening import reopened
from contwalk.errors import ContwalkError
from contwalk.plotting.segments import at_birth
from contwalk.problems.orbit.discretization import Discretization
from contwalk.system import System
from contwalk.workflow.quantities import values_along

# Orbits of one branch, and branches, that one figure shows if it is not told which.
MOST_ORBITS, MOST_BRANCHES = 5, 6
# Labels whose orbits come after those of bifurcations, in this order; those of limits only where admissible.
AFTER = {"UZ": 1, "GR": 2, "OC": 3, "AZ": 4, "BE": 5, "EP": 6}
LIMITS = ("GR", "OC", "AZ", "BE")
# Ends of a branch that lie on a bifurcation of another one.
ENDS_AT_BIFURCATION = ("shrunk", "rejoined")
# What a picture needs, and a little more.
PICTURE = Discretization(accuracy=1e-7)
SMOOTH = 128  # even parts of a leg, so that its curve has no corners


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
        In the order of time, over the whole period; the last row is the first one's again. Of a hybrid orbit,
        both sides of each event, over one closure; the last row is the one before the event that closes it.
    stable : bool
        Whether it is stable on both sides of the point; an orbit at a bifurcation is not, nor is one at
        which a branch was born.
    times : ndarray, shape (k,)
        Seconds; at an event, the same time twice.
    events : tuple of str
        Names of the events in their order, the one that closes the orbit last.
    breaks : tuple of int
        The rows right after the events, all but the last event's, which is row 0.
    closures : int
        Repetitions of `states` in a period: two where names are swapped in each.
    turns : ndarray, shape (n,), optional
        By how much each state of a hybrid orbit is larger after a closure.
    admissible : bool
        Whether the machine can move so.
    parameters : mapping
        All of the system's, by name.
    there : ndarray of bool, shape (k, n), optional
        Which states exist at the instants, where not all do in each mode.
    """

    branch: str
    point: str
    label: str
    states: np.ndarray
    stable: bool
    times: np.ndarray = field(default_factory=lambda: np.zeros(0))
    events: tuple[str, ...] = ()
    breaks: tuple[int, ...] = ()
    closures: int = 1
    turns: np.ndarray | None = None
    admissible: bool = True
    parameters: Mapping[str, float] = field(default_factory=dict)
    there: np.ndarray | None = None

    @property
    def period(self) -> float:
        """The whole period, seconds."""
        return self.closures * float(self.times[-1] - self.times[0])


def titled(orbit: Orbit) -> str:
    """The orbit's branch and label, and whether the machine can move so."""
    return f"{orbit.branch}/{orbit.label}" + ("" if orbit.admissible else ",  not admissible")


def orbits_of(
    system: System, branches: Sequence[Branch], report: Callable[[str], None] = lambda text: None
) -> list[list[Orbit]]:
    """A handful of orbits of each branch of orbits: of its special points, then marked values, then ends.

    If none of them is stable and admissible, one that is, or is stable at least, is added. `report` is
    given a sentence for each that cannot be integrated once more, such as one at a homoclinic end; it is left
    out.

    Raises
    ------
    ContwalkError
        If there is no branch of orbits with a point, or none of its orbits can be integrated.
    """
    chosen = [b for b in branches if b.info.problem in ORBITS and len(b)][:MOST_BRANCHES]
    if not chosen:
        raise ContwalkError(
            "No branch has periodic orbits, so there is no phase portrait.",
            "Follow a Hopf point (diagram: {follow: [HB]}), or use `contwalk simulate` for a motion.",
        )
    result, missing = [], []
    for branch in chosen:
        orbits, without = _all_at(system, branch, _handful(branch))
        missing += without
        if not any(orbit.stable and orbit.admissible for orbit in orbits):  # what one would see is shown
            typical, without = _all_at(system, branch, _typical(branch))
            orbits, missing = [*typical, *orbits], [*missing, *without]
        if orbits:
            result.append(orbits)
    if not result:
        raise missing[0]
    for error in missing:
        report(f"An orbit is left out. {error.sentence}")
    return result


def _all_at(
    system: System, branch: Branch, points: Sequence[SpecialPoint | int]
) -> tuple[list[Orbit], list[ContwalkError]]:
    """Orbits of some points, and why others cannot be had."""
    found, missing = [], []
    for point in points:
        try:
            found.append(orbit_at(system, branch, point))
        except ContwalkError as error:
            missing.append(error)
    return found, missing


def _handful(branch: Branch) -> list[SpecialPoint] | list[int]:
    """The points of a branch whose orbits are drawn, along the branch; its last one if none is special."""
    located = [p for p in branch.special_points if p.unknowns and p.status == "located"]
    # An orbit is drawn once: a branch may end at a special point.
    others = [p.s for p in located if p.label != "EP"]
    points = [
        p
        for p in located
        if (p.admissible or p.label not in (*LIMITS, "EP"))
        and (p.label != "EP" or not np.any(np.isclose(p.s, others, rtol=1e-9, atol=0.0)))
    ]
    first = sorted(points, key=lambda p: AFTER.get(p.label, 0))[:MOST_ORBITS]
    return sorted(first, key=lambda p: p.s) if first else [len(branch) - 1]


def _typical(branch: Branch) -> list[int]:
    """The row in the middle of the part that is stable and admissible, or else stable, where there is one."""
    rows = branch.points
    stable = (rows["stable"] == 1) & ~rows["special"] & ~at_birth(branch)
    found = np.flatnonzero(stable & rows["admissible"] if np.any(stable & rows["admissible"]) else stable)
    return [int(found[len(found) // 2])] if len(found) else []


def orbit_at(
    system: System, branch: Branch, point: SpecialPoint | int, solved: tuple[Any, Any] | None = None
) -> Orbit:
    """The orbit of one stored point; `solved` is what `reopened` gives of it, if that is known.

    Raises
    ------
    ContwalkError
        If the branch is not one of orbits, or is of another system, or the orbit cannot be integrated.
    """
    if branch.info.problem not in ORBITS:
        raise ContwalkError(
            f"Branch {branch.name} is one of {branch.info.problem.replace('_', ' ')} points.",
            "Name a point on a branch of periodic orbits.",
        )
    if isinstance(point, SpecialPoint):
        name, admissible = point.name, point.admissible
        stable = point.unstable_before == point.unstable_after == 0
        stable &= not (point.label == "EP" and point.kind in ENDS_AT_BIFURCATION)
    else:
        row = branch.points[point]
        name, admissible, stable = str(point), bool(row["admissible"]), _is_stable(branch, point)
    hybrid = branch.info.problem == "hybrid_orbit"
    try:
        with np.errstate(all="ignore"):  # what is not finite is told in a sentence
            given, sample = solved or reopened(system, branch, point, PICTURE)
            problem: Any = given
            if hybrid:
                times, states, breaks, there = _segments(problem, sample.z)
            else:
                times, states, breaks, there = *_motion(problem, sample.z), (), None
    except (ArithmeticError, ValueError) as error:  # numpy.linalg.LinAlgError is a ValueError
        raise ContwalkError(
            f"The orbit of {branch.name}/{name} cannot be integrated once more ({error}).",
            "Name another point: near a homoclinic orbit, and where deviations grow beyond all numbers, "
            "no computation is sharp enough.",
        ) from error
    fold = int(branch.info.settings.get("fold", 1))
    free = branch.info.free[0]
    value = f"{sample.parameter:.6g} {_unit(system, free)}".strip()
    label = f"{name}:  {free} = {value},  T = {system.lasting(fold * sample.period, '.4g')}"
    events = tuple(s.name for s in problem.stretches(sample.z) if s.name) if hybrid else ()
    return Orbit(
        branch.name,
        name,
        label,
        states,
        stable,
        times=times,
        events=events,
        breaks=breaks,
        closures=fold // problem.rounds if hybrid else 1,
        turns=_growth(problem, sample.z) if hybrid else None,
        admissible=admissible,
        parameters=problem.values_of(sample.z),
        there=there,
    )


def _is_stable(branch: Branch, row: int) -> bool:
    """Whether a row is stable, on both sides where it is one of a special point, and no bifurcation."""
    points = [p for p in branch.special_points if p.index == row and branch.points["special"][row]]
    beside = all(p.unstable_before == p.unstable_after == 0 for p in points)
    return bool(branch["unstable"][row] == 0 and beside and not at_birth(branch)[row])


def _unit(system: System, free: str) -> str:
    """The free parameter's unit as figures write it; empty where it has none."""
    from contwalk.plotting.quantities import written

    unit = next((p.unit for p in system.parameters if p.name == free), "1")
    return "" if unit in ("", "1") else written(unit)


def _motion(problem: Any, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Times and states of a smooth orbit, over the whole period."""
    times, states = problem.motion_of(z)
    kept = np.append(True, np.diff(times) > 0.0)  # segments share their ends
    return times[kept], states[kept]


def _segments(problem: Any, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, tuple[int, ...], np.ndarray]:
    """Times and states of a hybrid orbit, the rows with which a segment begins, without the first, and which
    states exist."""
    times, states, there = [], [], []
    for segment in problem.stretches(z):
        own_times, own_states = segment.at(np.union1d(segment.view.times, np.linspace(0.0, 1.0, SMOOTH + 1)))
        times.append(own_times)
        states.append(own_states)
        there.append(np.tile(np.isin(np.arange(own_states.shape[1]), segment.exists), (len(own_times), 1)))
    for before, after in pairwise(times):  # both sides of an event have one time, to the last bit
        after[0] = before[-1]
    breaks = np.cumsum([len(t) for t in times])[:-1]
    risen = np.maximum.accumulate(np.concatenate(times))  # two that are one but for rounding may fall by that
    return risen, np.concatenate(states), tuple(breaks.tolist()), np.concatenate(there)


def columns_of(system: System, orbit: Orbit, names: Sequence[str]) -> np.ndarray:
    """Some states and signals of an orbit, shape (k, m); angles that turn are folded into one turn.

    A row of NaN stands where the curve is broken: at an event, and where an angle comes round.

    Raises
    ------
    ContwalkError
        For a name that is neither a state nor a signal.
    """
    values, periods = _values(system, orbit, names), _folded(system, orbit, names)
    curve = np.insert(values, orbit.breaks, np.nan, axis=0)
    for column, period in enumerate(periods):
        if period:
            turns = np.floor(curve[:, column] / period + 0.5)
            curve[:, column] -= turns * period
            changes = np.diff(turns)
            breaks = np.flatnonzero(np.isfinite(changes) & (changes != 0.0)) + 1
            curve = np.insert(curve, breaks, np.nan, axis=0)
    return curve


def jumps_of(system: System, orbit: Orbit, names: Sequence[str]) -> np.ndarray:
    """Some states and signals before and after each event, shape (j, 2, m), folded as those of `columns_of`
    are; events at which one of them begins or ceases to exist are left out.

    Raises
    ------
    ContwalkError
        For a name that is neither a state nor a signal.
    """
    values, periods = _values(system, orbit, names), _folded(system, orbit, names)
    after = [*orbit.breaks, 0] if orbit.events else []
    ends = values[[[row - 1, row] for row in after]] if after else np.zeros((0, 2, len(names)))
    for column, period in enumerate(periods):
        if period:
            ends[..., column] -= np.floor(ends[..., column] / period + 0.5) * period
    return ends[np.isfinite(ends).all(axis=(1, 2))]


def _values(system: System, orbit: Orbit, names: Sequence[str]) -> np.ndarray:
    times = orbit.times if len(orbit.times) else np.zeros(len(orbit.states))
    found = values_along(system, names, times, orbit.states, orbit.parameters)
    return without_absent(system, names, found, orbit.there)


def without_absent(
    system: System, names: Sequence[str], values: np.ndarray, there: np.ndarray | None
) -> np.ndarray:
    """Values (k, m) of quantities, NaN where they are states that do not exist in the mode."""
    for column, name in enumerate(names if there is not None else ()):
        if there is not None and name in system.state_names:
            values[~there[:, system.state_names.index(name)], column] = np.nan
    return values


def _folded(system: System, orbit: Orbit, names: Sequence[str]) -> list[float]:
    """Periods of the angles that go all the way round; 0 of what is drawn as it is."""
    states = system.state_names
    periods = [(system.states[states.index(name)].period or 0.0) if name in states else 0.0 for name in names]
    found = _values(system, orbit, names)
    ranges = np.nanmax(found, axis=0, initial=-np.inf) - np.nanmin(found, axis=0, initial=np.inf)
    if orbit.turns is None and len(found):
        # Round it goes, but for the error of the orbit, which is not small near a homoclinic one.
        grown = np.abs(np.nan_to_num(found[-1] - found[0]))
        ranges = np.array(
            [p if p and round(g / p) else r for p, g, r in zip(periods, grown, ranges, strict=True)]
        )
    return [p if 0.0 < p * (1.0 - 1e-9) <= r else 0.0 for p, r in zip(periods, ranges, strict=True)]


def _growth(problem: Any, z: np.ndarray) -> np.ndarray:
    """By how much each state is larger after the whole motion of a hybrid orbit."""
    from contwalk.problems.orbit.motion import growth

    return growth(problem, z)

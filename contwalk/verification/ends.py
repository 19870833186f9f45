"""How a branch ended, checked where its own rows can tell."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace

import numpy as np

from contwalk.branch import Branch, SpecialPoint
from contwalk.labels import LOCUS
from contwalk.system import System
from contwalk.verification.branching import Unfolded
from contwalk.verification.curves import of_curve, unfolds
from contwalk.verification.equations import Equations, Evaluation
from contwalk.verification.finding import AGREES, CANNOT_TELL, DISAGREES, SLACK, CannotTell, Finding
from contwalk.verification.limits import KINDS, named
from contwalk.verification.orbit import OrbitEquations
from contwalk.verification.passage import COARSER, EPSILON, TIGHT
from contwalk.verification.records import equations_of, of_orbits
from contwalk.verification.rows import along_curve
from contwalk.verification.solving import ROUGH, Held, Sheet, solved

# Ends at a limit that is a special point of its own.
LIMITS = {"grazing": "GR", "order_change": "OC", "inadmissible": "AZ", "boundary_equilibrium": "BE"}
# What is said where a curve of branch points is none any more.
NOT_KEPT = "does not persist"
Ranges = Mapping[str, tuple[float, float]]


def checked_end(system: System, branch: Branch, end: SpecialPoint, ranges: Ranges) -> Finding:
    """Whether a branch ends as it says.

    Parameters
    ----------
    ranges : mapping
        From where to where the run went, by parameter; what is not in it is not known.
    """
    word = str(end.kind)
    begun = Finding(branch.name, end.name, f"end: {word}", method="its own rows")
    try:
        if word == "bound":
            verdict, reason = _bound(branch, end, ranges)
        elif word in LIMITS:
            # Beside it a curve in two parameters may be at something else: GRNS.
            there = [point.label for point in branch.special_points if point.s == end.s]
            met = any(label.startswith(LIMITS[word]) for label in there)
            # Where another limit is, it is that one that the branch ends at.
            other = any(label.startswith(tuple(LIMITS.values())) for label in there)
            if not (met or other) and _names(system, branch, end, LIMITS[word]):
                raise CannotTell("the limit that it names is farther ahead than the branch goes")
            verdict, reason = _told(met, f"no {LIMITS[word]} is there")
        elif NOT_KEPT in (end.note or ""):
            verdict, reason = _comes_apart(system, branch, end)
        elif word == "closed":
            verdict, reason = _closed(system, branch)
        elif word == "unbounded":
            verdict, reason = _unbounded(system, branch, end, ranges)
        elif word == "homoclinic" and of_orbits(branch):
            verdict, reason = _homoclinic(system, branch, end)
        elif word == "shrunk" and of_orbits(branch):
            verdict, reason = _shrunk(system, branch, end)
        elif word in ("homoclinic", "heteroclinic", "shrunk"):
            verdict, reason = DISAGREES, "the branch is not one of orbits"
        else:
            raise CannotTell("its own rows do not tell")
    except CannotTell as why:
        verdict, reason = CANNOT_TELL, str(why)
    return replace(begun, verdict=verdict, reason=reason)


def _names(system: System, branch: Branch, end: SpecialPoint, label: str) -> bool:
    """Whether an end names a number of its orbit that is zero at a limit of a label."""
    if not of_orbits(branch):
        return False
    equations = equations_of(system, branch, end.index)
    assert isinstance(equations, OrbitEquations)
    return label in KINDS and bool(named(label, end, equations, equations.at(equations.z, ROUGH))[1])


def _told(right: bool, why: str) -> tuple[str, str]:
    return (AGREES, "") if right else (DISAGREES, why)


def _bound(branch: Branch, end: SpecialPoint, ranges: Ranges) -> tuple[str, str]:
    """A free parameter is at an end of its range."""
    free = dict(zip(branch.info.free, branch.points["free"][end.index], strict=True))
    known = {name: ranges[name] for name in free if name in ranges}
    if not known:
        raise CannotTell("the range of the run is not stored")
    there = any(value in known[name] for name, value in free.items() if name in known)
    if not there and len(known) < len(free):
        raise CannotTell("the range of the run is not stored")
    told = ", ".join(
        f"{name} = {free[name]:.6g} of {low:.6g} to {high:.6g}" for name, (low, high) in known.items()
    )
    return _told(there, f"it is inside of its range: {told}")


def _sizes_of_free(branch: Branch, row: int) -> np.ndarray:
    """Sizes of the free parameters in the metric of a row, shape (k,)."""
    weights = branch.points["weights"][row]
    return np.asarray(weights[np.isfinite(weights)][: -1 - len(branch.info.free) : -1])


def _closed(system: System, branch: Branch) -> tuple[str, str]:
    """The last row is a step from the start, no longer than others, and Newton's method goes there."""
    first = int(np.argmin(np.abs(branch["s"])))
    end = 0 if first else len(branch) - 1
    sizes = _sizes_of_free(branch, end)
    apart = np.linalg.norm((branch["free"] - branch["free"][first]) / sizes, axis=1)
    if (
        len(branch) < 3
        or apart.max() <= SLACK * np.nan_to_num(branch.points["error"]).max() + COARSER * TIGHT
    ):
        return DISAGREES, "all its rows are one point to their errors"
    # The row before may be the start itself, where a special point is located there.
    told, before = _in_ranges(branch), 2 if end == 0 else end - 2
    if (told[first] - told[before]) @ (told[end] - told[before]) <= 0.0:
        return DISAGREES, "its last step leads away from its start"
    steps = np.linalg.norm(np.diff(branch["free"], axis=0) / sizes, axis=1)
    if first not in (0, len(branch) - 1) or apart[end] > steps.max():
        return DISAGREES, "its last row is far from its start"
    if np.any(np.abs(told[first] - told[end]) > np.abs(np.diff(told, axis=0)).max(axis=0)):
        raise CannotTell(
            "its last state is far from its start: another solution, or the same begun elsewhere"
        )
    start, last = equations_of(system, branch, first), equations_of(system, branch, end)
    if start.z.shape != last.z.shape:
        raise CannotTell("orbits at its two ends are not cut alike")
    if unfolds(branch):
        start, last = Unfolded(start), Unfolded(last)
    curve, sheet = Sheet(start), Sheet(last)
    if branch.info.problem == LOCUS:
        along = along_curve(branch, first, start)
        at_start = Held(start.z, np.append(np.zeros(start.size), along))
    else:
        at_start = Held(start.z, np.linalg.pinv(curve.along)[0])
    spectra = branch.points["spectrum"]
    begin = solved(curve, [*of_curve(branch, spectra[first], start, curve), at_start])
    found = solved(sheet, [*of_curve(branch, spectra[end], last, sheet), at_start])
    differ, compared = np.abs(found.at.z - begin.at.z), np.ones(len(start.z), dtype=bool)
    if isinstance(start, OrbitEquations):  # the phase may be another one
        compared[: start.size - start.count - 1], compared[start.size - 1] = False, False
    same = differ <= SLACK * (found.error + begin.error) + TIGHT * start.sizes
    return _told(bool(same[compared].all()), "it comes back elsewhere than to its start")


def _in_ranges(branch: Branch) -> np.ndarray:
    """Parameters, state and period of all rows, (rows, m), each in its range over the branch."""
    points = branch.points
    told = np.column_stack([points["free"], points["state"], points["period"]])
    ranges = np.ptp(told, axis=0)
    moves = ranges > ROUGH * np.abs(told).max(axis=0)  # what is not a number is none of it
    return np.asarray(told[:, moves] / ranges[moves])


def _comes_apart(system: System, branch: Branch, end: SpecialPoint) -> tuple[str, str]:
    """Beside the end of a curve of branch points the branches that cross no longer do."""
    row, inside = end.index, 1 if end.index == 0 else len(branch) - 2
    equations = Unfolded(equations_of(system, branch, row))
    sheet, k = Sheet(equations), len(branch.info.free)
    own = of_curve(branch, branch.points["spectrum"][row], equations, sheet)
    along = along_curve(branch, row, equations)
    step = float(along @ (branch["free"][row] - branch["free"][inside]))
    ahead = solved(sheet, [*own, lambda at: float(along @ (at.z - equations.z)[-k:]) - step])
    unfolded = abs(float(ahead.at.z[equations.own]))
    if unfolded > SLACK * float(ahead.error[equations.own]):
        return AGREES, ""
    places = zip(branch.info.free, ahead.at.z[-k:], strict=True)
    there = ", ".join(f"{name} = {value:.10g}" for name, value in places)
    return DISAGREES, f"the branches that cross still do beyond it, at {there}"


def _unbounded(system: System, branch: Branch, end: SpecialPoint, ranges: Ranges) -> tuple[str, str]:
    """The solution, or its period, is at its largest there, and grows while the parameter stands still."""
    free = dict(zip(branch.info.free, branch.points["free"][end.index], strict=True))
    if any(value in ranges.get(name, ()) for name, value in free.items()):
        return DISAGREES, "it is at an end of its range"
    size = np.linalg.norm(
        np.column_stack([branch.points["state"], np.nan_to_num(branch.points["period"])]), axis=1
    )
    if size[end.index] < size.max():
        return DISAGREES, "its solution is larger elsewhere"
    if not _stands_still(branch, end, size):
        return DISAGREES, "its parameter does not come to a limit as it grows"
    if of_orbits(branch):
        with suppress(CannotTell):
            if _homoclinic(system, branch, end)[0] == AGREES:
                return DISAGREES, "its period runs off beside an equilibrium"
    return AGREES, ""


def _stands_still(branch: Branch, end: SpecialPoint, size: np.ndarray) -> bool:
    """Whether free parameters do, to a quarter of the digits of their sizes, as something grows, (rows,)."""
    inner = 1 if end.index == 0 else end.index - 1
    moved = (branch["free"][end.index] - branch["free"][inner]) / _sizes_of_free(branch, end.index)
    grown = np.log(size[end.index] / size[inner])
    return bool(np.linalg.norm(moved) <= EPSILON**0.25 * grown)


def _homoclinic(system: System, branch: Branch, end: SpecialPoint) -> tuple[str, str]:
    """The period is at its longest, and the orbit spends it beside an equilibrium."""
    period = branch["period"]
    if period[end.index] < period.max():
        return DISAGREES, "the period is longer elsewhere"
    equations = equations_of(system, branch, end.index)
    assert isinstance(equations, OrbitEquations)
    at = equations.at(equations.z, COARSER * TIGHT)
    leg = at.legs[0]
    p = equations.functions.parameters.at(equations.free)
    times = np.concatenate([piece.times for piece in leg.pieces])
    states = np.vstack([piece.states for piece in leg.pieces])
    speeds = np.array(
        [
            np.linalg.norm(equations.functions.field(leg.mode)(t, x, p)[0] / equations._scale(leg.mode))
            for t, x in zip(times, states, strict=True)
        ]
    )
    slow = states[int(np.argmin(speeds))]
    size = float(np.linalg.norm(np.ptp(states, axis=0) / equations._scale(leg.mode)))
    rest = _equilibrium(equations, leg.mode, slow, p)
    if rest is None or not _linear(equations, leg.mode, slow[None], rest, p):
        _comes_back(equations, at)
        return DISAGREES, "the orbit is beside no equilibrium"
    if not _stands_still(branch, end, period):
        return DISAGREES, "the period does not run off"
    if float(speeds.min()) * float(period[end.index]) < size:  # so slow it would not go round
        return AGREES, ""
    raise CannotTell("the orbit passes an equilibrium, beside which it is not slow yet")


def _linear(
    equations: Equations, mode: str, states: np.ndarray, rest: tuple[np.ndarray, np.ndarray], p: np.ndarray
) -> bool:
    """Whether an equilibrium's linearisation tells the field at states, (m, n), better than nothing does."""
    scale = equations._scale(mode)  # type: ignore[attr-defined]
    told = (states - rest[0]) @ rest[1].T / scale
    fields = np.array([equations.functions.field(mode)(0.0, x, p)[0] for x in states]) / scale
    return bool(np.max(np.linalg.norm(fields - told, axis=1)) < np.max(np.linalg.norm(told, axis=1)))


def _shrunk(system: System, branch: Branch, end: SpecialPoint) -> tuple[str, str]:
    """The orbit is small, and turns as fast as the equilibrium inside it swings."""
    equations = equations_of(system, branch, end.index)
    assert isinstance(equations, OrbitEquations)
    if equations.forced:
        return DISAGREES, "a force goes on: no orbit under it ends in a Hopf point"
    at = equations.at(equations.z, COARSER * TIGHT)
    states = np.vstack([piece.states for piece in at.legs[0].pieces])
    p, mode = equations.functions.parameters.at(equations.free), equations.legs[0][0]
    rest = _equilibrium(equations, mode, states.mean(axis=0), p)
    if rest is None:
        _comes_back(equations, at)
        return DISAGREES, "there is no equilibrium inside the orbit"
    size = float(np.max(np.ptp(states, axis=0) / equations._scale(mode)))
    turn = np.abs(np.linalg.eigvals(rest[1]) * branch["period"][end.index] - 2j * np.pi).min() / (2.0 * np.pi)
    # Its parameter is as far from the Hopf point as the square of its size; it turns otherwise by no more.
    small = size**2 <= EPSILON**0.25 and turn <= size
    return _told(bool(small), "the orbit is not small, or no eigenvalue swings with its period")


def _comes_back(equations: OrbitEquations, at: Evaluation) -> None:
    """Refuse to tell of a motion whose deviations have grown beyond it.

    Raises
    ------
    CannotTell
    """
    if not np.linalg.norm(at.residual) <= np.linalg.norm(equations.scale):
        raise CannotTell("the motion from its stored start does not come back: rounding has grown beyond it")


def _equilibrium(
    equations: Equations, mode: str, x: np.ndarray, p: np.ndarray
) -> tuple[np.ndarray, np.ndarray] | None:
    """The equilibrium near a state, and the Jacobian there, by Newton's method."""
    field = equations.functions.field(mode)
    for _ in range(20):
        f, moved = field(0.0, x, p)
        matrix = moved[:, 1 : 1 + len(x)]
        step = np.linalg.lstsq(matrix, -f, rcond=None)[0]
        x = x + step
        if not np.isfinite(x).all():
            return None
        if np.linalg.norm(step) <= TIGHT * max(float(np.linalg.norm(x)), 1.0):
            return x, matrix
    return None

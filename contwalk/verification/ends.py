"""How a branch ended, checked where its own rows can tell."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from contwalk.branch import Branch, SpecialPoint
from contwalk.labels import LOCUS
from contwalk.system import System
from contwalk.verification.equations import Equations
from contwalk.verification.finding import AGREES, CANNOT_TELL, DISAGREES, SLACK, CannotTell, Finding
from contwalk.verification.orbit import OrbitEquations
from contwalk.verification.passage import COARSER, TIGHT
from contwalk.verification.records import equations_of, of_orbits
from contwalk.verification.solving import Sheet, solved

# Ends at a limit that is a special point of its own.
LIMITS = {"grazing": "GR", "order_change": "OC", "inadmissible": "AZ", "boundary_equilibrium": "BE"}
Ranges = Mapping[str, tuple[float, float]]
# An end is a limit that is not reached: so much nearer to it than where the branch is at its middle.
NEARER = 0.1


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
            met = any(
                point.label.startswith(LIMITS[word]) and point.s == end.s for point in branch.special_points
            )
            verdict, reason = _told(met, f"no {LIMITS[word]} is there")
        elif word == "closed":
            verdict, reason = _closed(system, branch)
        elif word == "unbounded":
            verdict, reason = _unbounded(branch, end)
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


def _closed(system: System, branch: Branch) -> tuple[str, str]:
    """The last row is one step from the start, and Newton's method goes there, to the same solution."""
    if branch.info.problem == LOCUS:
        raise CannotTell("whether a curve in two parameters comes back is not recomputed")
    first, end = int(np.argmin(np.abs(branch["s"]))), len(branch) - 1
    ways = np.abs(np.diff(branch["s"]))
    apart = (branch["free"][end] - branch["free"][first]) / branch.points["weights"][end][-1]
    if len(ways) < 2 or not np.all(np.abs(apart) <= 2.0 * ways[-1]):
        return DISAGREES, "its last row is far from its start"
    start, last = equations_of(system, branch, first), equations_of(system, branch, end)
    if start.z.shape != last.z.shape:
        raise CannotTell("orbits at its two ends are not cut alike")
    curve, sheet = Sheet(start, COARSER * TIGHT), Sheet(last, COARSER * TIGHT)
    normal = np.linalg.pinv(curve.along)[0]
    begin = solved(curve, [lambda at: float(normal @ (at.z - start.z))])
    found = solved(sheet, [lambda at: float(normal @ (at.z - start.z))])
    differ, compared = np.abs(found.at.z - begin.at.z), np.ones(len(start.z), dtype=bool)
    if isinstance(start, OrbitEquations):  # the phase may be another one
        compared[: start.size - start.count - 1], compared[start.size - 1] = False, False
    level = SLACK * (found.error + begin.error) + TIGHT * start.sizes
    return _told(bool(np.all((differ <= level)[compared])), "it comes back elsewhere than to its start")


def _unbounded(branch: Branch, end: SpecialPoint) -> tuple[str, str]:
    """The solution, or its period, is at its largest there, and far beyond what it is halfway."""
    size = np.linalg.norm(
        np.column_stack([branch.points["state"], np.nan_to_num(branch.points["period"])]), axis=1
    )
    return _told(
        bool(size[end.index] >= size.max() and size[end.index] > np.median(size) / NEARER),
        "its solution is not large there",
    )


def _homoclinic(system: System, branch: Branch, end: SpecialPoint) -> tuple[str, str]:
    """The period is at its longest, and the orbit spends it beside an equilibrium."""
    period = branch["period"]
    if period[end.index] < period.max():
        return DISAGREES, "the period is longer elsewhere"
    equations = equations_of(system, branch, end.index)
    assert isinstance(equations, OrbitEquations)
    leg = equations.at(equations.z, COARSER * TIGHT).legs[0]
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
    size = float(np.linalg.norm(np.ptp(states, axis=0)))
    rest = _equilibrium(equations, leg.mode, slow, p)
    if rest is None or np.linalg.norm(rest[0] - slow) > NEARER * size:
        return DISAGREES, "the orbit is beside no equilibrium"
    return _told(float(speeds.min()) < NEARER * float(np.mean(speeds)), "the orbit does not slow down")


def _shrunk(system: System, branch: Branch, end: SpecialPoint) -> tuple[str, str]:
    """The orbit is small, and turns as fast as the equilibrium inside it swings."""
    equations = equations_of(system, branch, end.index)
    assert isinstance(equations, OrbitEquations)
    states = np.vstack([piece.states for piece in equations.at(equations.z, COARSER * TIGHT).legs[0].pieces])
    p, mode = equations.functions.parameters.at(equations.free), equations.legs[0][0]
    rest = _equilibrium(equations, mode, states.mean(axis=0), p)
    if rest is None:
        return DISAGREES, "there is no equilibrium inside the orbit"
    _, matrix = rest
    size = float(np.max(np.ptp(states, axis=0) / equations._scale(mode)))
    turn = np.abs(np.linalg.eigvals(matrix) * branch["period"][end.index] - 2j * np.pi).min() / (2.0 * np.pi)
    return _told(
        size < NEARER and turn < NEARER, "the orbit is not small, or no eigenvalue swings with its period"
    )


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

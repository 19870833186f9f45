"""Durations of legs by where their guards are met: what a guess far along a branch needs.

Where the period runs off, an orbit spends it beside an equilibrium, or where one has been, and its events
come within a moment of their own. The straight line of the unknowns misses this moment by a part of the
whole period: a neuron's spike is long over, or has run into its pole, and Newton's method on starts and
durations converges only from within it. The motion itself tells when the guard is met. With durations
fitted so after each of its steps, Newton's method is that of the starts and the parameter alone (nonlinear
elimination: X.-C. Cai, D. E. Keyes, "Nonlinearly preconditioned inexact Newton algorithms", SIAM J. Sci.
Comput. 24 (2002) 183).
"""

from __future__ import annotations

import numpy as np

from contwalk.flow.hybrid.machine import HybridMachine
from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import hybrid_machine, motion_segments
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.orbit.layout import Segment
from contwalk.problems.orbit.piece import Piece

# Durations are fitted on steps that are theirs at least by this part of the square of the length: where the
# parameter counts relative to itself, it falls by two parts while the period grows by one.
SHARE = 0.1
# A guard is looked for until the leg has lasted so many times what the guess says.
LONGEST = 4.0
# Corrections of a simulated duration on the steps of the equations; when they are rounding: so small, or
# small and no longer shrinking.
CORRECTIONS, ROUNDED, NEARLY, STALLS = 64, 1e-15, 1e-9, 0.25


def fitted(
    problem: LimitedOrbit, z: np.ndarray, normal: np.ndarray, weights: np.ndarray
) -> np.ndarray | None:
    """Unknowns whose legs last until their guards are zero, on the steps of the equations.

    None where that is not asked for, or not to be had: on steps across a hyperplane that are hardly of
    durations, of forced and of pinned orbits, and where a leg does not meet its event. Of a leg that is cut
    the last segment meets it, and lasts as long as each of the others.

    Parameters
    ----------
    z, normal, weights : ndarray, shape (N + 1,)
        The unknowns, the normal of the corrector's hyperplane, and the metric.
    """
    across = (normal * weights) ** 2
    if float(across[problem.layout.durations].sum()) < SHARE * float(across.sum()):
        return None
    if problem.forced or problem.pins or not problem.itinerary.eventful:
        return None
    machine, result = hybrid_machine(problem.system, problem.values_of(z)), z.copy()
    events = {i for i, _ in problem.events}
    for segment, piece in zip(problem.layout.segments, problem.segments, strict=True):
        if not segment.last or segment.leg not in events:
            continue
        lasting = _until_met(problem, machine, z, segment)
        lasting = None if lasting is None else _on_steps(problem, piece, z, segment, lasting)
        if lasting is None:
            return None
        result[problem.layout.durations.start + segment.leg] = lasting / (segment.end - segment.begin)
    return result


def _until_met(
    problem: LimitedOrbit, machine: HybridMachine, z: np.ndarray, segment: Segment
) -> float | None:
    """How long a simulation from the start of a leg's last segment lasts until the leg's event, if ever."""
    i, mesh, (x, scalars) = segment.leg, problem.mesh, problem.layout.inputs_of(segment, z)
    leg, longest = problem.itinerary.legs[i], LONGEST * float(scalars[0])
    if not longest > 0.0:
        return None
    last = (problem.itinerary.leading_in(problem.system, i) or None) if segment.begin == 0.0 else None
    start = problem.passages[i].full(x)
    control = Control(mesh.tolerance, mesh.variation, mesh.method, watched=False)
    arc = next(motion_segments(machine, 0.0, start, leg.mode, longest, control, last), None)
    if arc is None or arc.status != "ok" or arc.transition != leg.name or arc.collapsed:
        return None
    return float(arc.times[-1])


def _on_steps(
    problem: LimitedOrbit, piece: Piece, z: np.ndarray, segment: Segment, lasting: float
) -> float | None:
    """A duration corrected until the guard is zero on the steps of the equations; None if that fails.

    These steps see the event at another instant than the simulation's own, and where a pole follows it, its
    moment may be shorter than what lies between. Newton's method is held between durations that are too short
    and too long.
    """
    x, scalars = problem.layout.inputs_of(segment, z)
    short, long, previous = 0.0, LONGEST * lasting, np.inf
    for _ in range(CORRECTIONS):
        given = np.concatenate([[lasting], scalars[1:]])
        passed, change = _missed(piece, x, given)
        if abs(change) < ROUNDED or (abs(change) < NEARLY and abs(change) > STALLS * previous):
            return lasting
        short, long = (short, lasting) if passed else (lasting, long)
        proposed = lasting * (1.0 + change)
        lasting, previous = proposed if short < proposed < long else 0.5 * (short + long), abs(change)
    return None


def _missed(piece: Piece, x: np.ndarray, scalars: np.ndarray) -> tuple[bool, float]:
    """Whether the event has happened before the end, and by which part of the duration this is to change."""
    leg = piece.passage.leg
    transition = leg.transition
    assert transition is not None
    values, steps = piece.values(scalars), piece.steps
    guard = piece.passage.watched(transition.name, transition.guard)
    nodes = piece.nodes(x, scalars)
    with np.errstate(over="ignore", invalid="ignore"):
        seen, rates = guard.along(steps, nodes, values).T
    before = 1.0 if leg.falls else -1.0
    on_the_way = np.isfinite(seen) & (before * seen > 0.0)
    last = int(np.flatnonzero(on_the_way)[-1]) if np.any(on_the_way) else 0
    if last < len(steps) - 2:
        return True, float(steps[last + 1]) - 1.0
    change = -float(seen[-1] / rates[-1]) if np.isfinite(seen[-1]) and rates[-1] else np.nan
    passed = not on_the_way[-1]
    return passed, change if np.isfinite(change) else float(steps[-2]) - 1.0

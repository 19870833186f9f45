"""Whether a simulation from an orbit's first state goes round in the orbit's itinerary."""

from __future__ import annotations

import numpy as np

from contwalk.flow.hybrid.machine import HybridMachine
from contwalk.flow.hybrid.motion_segment import Control, MotionSegment
from contwalk.flow.hybrid.motions import hybrid_machine, motion_segments
from contwalk.problems import neutral as neutrals
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.orbit.closure import imaged
from contwalk.problems.orbit.layout import Segment
from contwalk.system.declarations import ParameterValues

TOLERANCE = 1e-12
# A simulated event is the orbit's if it happens within this part of the period, and finds this state.
SAME_TIME, SAME_STATE = 1e-3, 1e-2


def follows(problem: LimitedOrbit, z: np.ndarray) -> str | None:
    """None if a simulation over one closure meets the events of the itinerary, in their order; else what
    it meets.

    Where deviations grow by so much that no simulation goes round, each segment is simulated by itself.

    z has the shape (N + 1,).
    """
    machine = hybrid_machine(problem.system, problem.values_of(z))
    told = _round(problem, machine, z)
    if told is None or float(np.prod(problem.mesh.grown)) * problem.mesh.tolerance < SAME_STATE:
        return told
    each = (_along(problem, machine, z, segment) for segment in problem.layout.segments)
    return next((told for told in each if told is not None), None)


def _round(problem: LimitedOrbit, machine: HybridMachine, z: np.ndarray) -> str | None:
    """As `follows`, of one simulation."""
    times, legs = problem.starting_times(z), problem.itinerary.legs
    x = problem.passages[0].full(problem.layout.inputs(0, z)[0])
    last = problem.itinerary.leading_in(problem.system, 0) or None
    end = float(times[-1]) + _room(problem, z) if problem.itinerary.eventful else float(times[-1])
    control = Control(TOLERANCE, problem.mesh.variation)
    run = motion_segments(machine, float(times[0]), x, legs[0].mode, end, control, last)
    for i, leg in enumerate(legs):
        arc = next(run, None)
        if arc is None:
            return f"it ends before '{leg.name}'"
        told = _ends_alike(problem, z, i, arc)
        if told is not None:
            return told
    return None


def _along(problem: LimitedOrbit, machine: HybridMachine, z: np.ndarray, segment: Segment) -> str | None:
    """As `follows`, of a segment."""
    i, layout = segment.leg, problem.layout
    passage, begins, whole = problem.passages[i], problem.starting_times(z)[i], z[layout.durations][i]
    leg, start, end = passage.leg, float(begins + segment.begin * whole), float(begins + segment.end * whole)
    ends_here = segment.last and leg.transition is not None
    last = (problem.itinerary.leading_in(problem.system, i) or None) if segment.begin == 0.0 else None
    until = end + _room(problem, z) if ends_here else end
    x, control = passage.full(z[segment.states]), Control(TOLERANCE, problem.mesh.variation)
    arc = next(motion_segments(machine, start, x, leg.mode, until, control, last), None)
    if arc is None:
        return f"it ends before '{leg.name}'"
    if ends_here:
        return _ends_alike(problem, z, i, arc)
    if arc.status != "ok" or arc.transition:
        return arc.reason or f"it meets '{arc.transition}' before '{leg.name}'"
    return None


def _room(problem: LimitedOrbit, z: np.ndarray) -> float:
    return SAME_TIME * abs(problem.duration(z))


def _ends_alike(problem: LimitedOrbit, z: np.ndarray, i: int, arc: MotionSegment) -> str | None:
    """None if an arc ends as leg i does; else how it does."""
    times, legs = problem.starting_times(z), problem.itinerary.legs
    leg = legs[i]
    if arc.status != "ok":
        return arc.reason or arc.status
    met = arc.transition or ""
    if arc.mode != leg.mode or met != leg.name:
        return f"it meets {repr(met) if met else 'nothing'} where '{leg.name or 'no event'}' is expected"
    if abs(float(arc.times[-1]) - float(times[i + 1])) > _room(problem, z):
        return f"'{met}' happens at another time"
    following = (i + 1) % len(legs)
    after = arc.after if arc.after is not None else arc.states[-1]
    expected = problem.passages[following].full(problem.layout.inputs(following, z)[0])
    if following == 0:
        symmetry = problem.system.symmetry(problem.itinerary.image) if problem.itinerary.image else None
        expected = expected + problem.turns
        after = imaged(symmetry, after, ParameterValues(**problem.values_of(z)))
    along = neutrals.directions(problem.system, problem.pins, expected, problem.values_of(z))
    apart = neutrals.across(after - expected, along, problem.mesh.variation)
    if float(np.linalg.norm(apart / problem.mesh.variation)) > SAME_STATE:
        return f"the state after '{met}' is another one"
    return None

"""Whether a simulation from an orbit's first state goes round in the orbit's word."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contwalk.flow.hybrid.motions import arcs, hybrid_machine
from contwalk.problems.hybrid import families
from contwalk.problems.orbit.closure import imaged
from contwalk.system.declarations import ParameterValues

if TYPE_CHECKING:
    from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit

TOLERANCE = 1e-12
# A simulated event is the orbit's if it happens within this part of the period, and finds this state.
SAME_TIME, SAME_STATE = 1e-3, 1e-2


def follows(problem: HybridOrbit, z: np.ndarray) -> str | None:
    """None if a simulation over one closure meets the events of the word, in their order; else what
    it meets.
    """
    machine = hybrid_machine(problem.system, problem.values_of(z))
    times, legs = problem.starting_times(z), problem.word.legs
    x = problem.passages[0].full(problem.layout.inputs(0, z)[0])
    symmetry = problem.system.symmetry(problem.word.image) if problem.word.image else None
    last = problem.word.leading_in(problem.system, 0) or None
    room = SAME_TIME * abs(problem.duration(z))
    end = float(times[-1]) + room if problem.word.eventful else float(times[-1])
    run = arcs(
        machine, float(times[0]), x, legs[0].mode, end, TOLERANCE, problem.mesh.variation, just_after=last
    )
    for i, leg in enumerate(legs):
        arc = next(run, None)
        if arc is None:
            return f"it ends before '{leg.name}'"
        if arc.status != "ok":
            return arc.reason or arc.status
        met = arc.transition or ""
        if arc.mode != leg.mode or met != leg.name:
            return f"it meets {repr(met) if met else 'nothing'} where '{leg.name or 'no event'}' is expected"
        if abs(float(arc.times[-1]) - float(times[i + 1])) > room:
            return f"'{met}' happens at another time"
        following = (i + 1) % len(legs)
        after = arc.after if arc.after is not None else arc.states[-1]
        expected = problem.passages[following].full(problem.layout.inputs(following, z)[0])
        if following == 0:
            expected = expected + problem.turns
            after = imaged(symmetry, after, ParameterValues(**problem.values_of(z)))
        along = families.directions(problem.system, problem.pins, expected, problem.values_of(z))
        apart = families.across(after - expected, along, problem.mesh.variation)
        if float(np.linalg.norm(apart / problem.mesh.variation)) > SAME_STATE:
            return f"the state after '{met}' is another one"
    return None

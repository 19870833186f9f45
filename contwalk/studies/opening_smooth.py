"""The first orbit of a branch of a smooth system: corrected, closed up to a symmetry where it has one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.branch import Outcome
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState, begin
from contwalk.diagram import not_begun
from contwalk.diagram.opening import Opening
from contwalk.errors import StartError
from contwalk.problems.initial.orbit_from_state import orbit_at, symmetric
from contwalk.problems.initial.recurrence import AtRest, recurrent
from contwalk.problems.kink import refuse
from contwalk.problems.orbit.asymmetry import repetitions
from contwalk.problems.orbit.conservation import off_its_value
from contwalk.problems.orbit.kinks_met import kinks_along
from contwalk.problems.orbit.periodic_orbit import PeriodicOrbit
from contwalk.studies.families import is_one_of_a_family
from contwalk.studies.orbit_start import OrbitStart
from contwalk.studies.orbits_not_alone import (
    not_alone,
    not_conserved,
    one_of_many,
    outcome_of_family,
)
from contwalk.studies.solved_finely import solved_finely
from contwalk.studies.turning import without_angles

# A motion this small against its place may be the last of one that comes to rest.
FAINT = 1e-6


def smooth(start: OrbitStart) -> Opening | Outcome:
    """The branch of smooth orbits through a state, or through what a simulation from it settles on."""
    state, period, settings = start.state, start.period, start.settings
    faint = False
    if start.until is not None:
        try:
            found = recurrent(start.system, start.values, state, start.until)
        except AtRest:
            raise
        except StartError as error:
            raise without_angles(start, error) from error
        faint = bool(np.all(found.variation <= FAINT * np.abs(found.state).max()))
        state, period = found.state, found.period
    begins = start.system, start.line, start.at
    given = start.discretization, start.subharmonic, start.pins
    problem, z = orbit_at(*begins, state, period, *given)
    begun = begin(problem, z, settings)
    if isinstance(begun, ContinuationState) and problem.moves(begun.sample.z):
        there, sample = solved_finely(problem, begun.sample, settings)
        times = repetitions(there, sample.z)
        if times > 1:  # it was begun with a multiple of its period
            first, part = sample.z[: problem.states], problem.duration(sample.z) / times
            problem, z = orbit_at(*begins, first, part, *given)
            begun = begin(problem, z, settings)
    if not isinstance(begun, ContinuationState):
        refuse(kinks_along(problem, z))
        near = start.until == "settled" and begun.reason == "no_convergence"
        sentence = f"{begun.sentence} {not_begun.PERHAPS_NOT_PERIODIC if near else ''}".strip()
        return not_alone(problem, z, begun) or not_begun.no_start(begun.reason, sentence, "a periodic orbit")
    if not problem.moves(begun.sample.z):
        if faint:  # the last of a motion that dies away
            raise AtRest(state)
        return outcome_of_family(problem, z) or not_begun.no_start(
            "no_convergence",
            "The correction ends at an equilibrium, which is no orbit.",
            "a periodic orbit",
        )
    if is_one_of_a_family(problem, begun.sample.z):
        return outcome_of_family(problem, z) or one_of_many()
    if name := off_its_value(problem, begun.sample.z):
        return not_conserved(name)
    return _closed(problem, begun, settings)


def _closed(problem: PeriodicOrbit, state: ContinuationState, settings: Settings) -> Opening:
    """The orbit closed up to a symmetry that it has, on steps made for it."""
    fine, sample = solved_finely(problem, state.sample, settings)
    part = symmetric(fine, sample.z, sample.weights)
    message = ""
    if part is not None:
        there = begin(*part, settings)
        if isinstance(there, ContinuationState):
            problem, state = part[0], there
            name, order = problem.whole
            message = (
                f"The orbit is its own image under '{name}' 1/{order} of a period later: "
                "only that part is integrated."
            )
    adapted, sample = problem.adapted(state.sample)
    if np.array_equal(sample.z, state.sample.z):  # what was solved, not what the next steps see of it
        sample = replace(sample, excess=state.sample.excess)
    return Opening(adapted, ContinuationState(sample, state.s, state.step), message)

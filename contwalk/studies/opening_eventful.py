"""The first orbit of a branch through events, from a simulation that comes back, or a stored one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from contwalk.branch import Outcome
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState, begin
from contwalk.diagram import not_begun
from contwalk.diagram.opening import Opening
from contwalk.errors import NotFinite, PluginError, StartError
from contwalk.flow.hybrid.going_through import going_through
from contwalk.flow.hybrid.machine import HybridMachine, hybrid_machine
from contwalk.problems.hybrid.closed_up import broken_at
from contwalk.problems.hybrid.families import broken_by_events
from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.hybrid.hybrid_recurrence import HybridRecurrence
from contwalk.problems.hybrid.jumps_on_the_way import hops
from contwalk.problems.hybrid.least_part import least, unused_symmetries
from contwalk.problems.hybrid.legs_without_length import collapsed as collapsed_event
from contwalk.problems.hybrid.past_all_along import past_all_along
from contwalk.problems.hybrid.soft_orbit import SoftOrbit, applies, softened
from contwalk.problems.initial.event_recurrence import recurrence_from
from contwalk.problems.initial.orbit_from_recurrence import orbit_of
from contwalk.problems.kink import refuse
from contwalk.problems.orbit.conservation import off_its_value
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.orbit.fine_steps import discretized
from contwalk.problems.orbit.itinerary import named_itinerary
from contwalk.problems.orbit.kinks_met import kinks_along
from contwalk.problems.orbit.switching import whole
from contwalk.problems.parameter_line import Ends
from contwalk.problems.problem import equations_at
from contwalk.problems.sample import NO_MARGIN, Sample
from contwalk.problems.stored_itinerary import StoredItinerary
from contwalk.python_functions import line_aside
from contwalk.signatures import folded
from contwalk.studies.at_one_instant import joined, sentence_on
from contwalk.studies.families import is_one_of_a_family
from contwalk.studies.orbit_start import OrbitStart
from contwalk.studies.orbits_not_alone import (
    not_alone,
    not_conserved,
    one_of_a_family_near,
    one_of_many,
    outcome_of_family,
)
from contwalk.studies.solved_finely import solved_finely
from contwalk.system import System

UNSTABLE = (
    "The first orbit is unstable, though the simulation was to settle on it: a motion beside it goes "
    "elsewhere, if slowly."
)


def eventful(start: OrbitStart) -> Opening | Outcome:
    """The branch of orbits through events that a simulation from a state comes back on."""
    values = start.values
    place = start.line.elsewhere(start.system, start.line.place(start.at))
    recurrence = recurrence_from(
        start.system,
        values,
        start.state,
        start.mode,
        start.event,
        start.until,
        elsewhere=start.line.at(place),
    )
    explicit = orbit_of(HybridOrbit, start.system, start.line, start.at, recurrence, start.discretization)
    opening = _hybrid(*softened(*explicit), start.settings, start.until == "settled")
    machine = hybrid_machine(start.system, values)
    return _with_broken(_with_pushes(opening, machine, recurrence), machine, recurrence)


def _with_pushes(
    opening: Opening | Outcome, machine: HybridMachine, recurrence: HybridRecurrence
) -> Opening | Outcome:
    """The opening, with a word on events after which the machine goes on as a stop would not."""
    if isinstance(opening, Outcome):
        return opening
    legs = [
        (stretch.leg.transition, stretch) for stretch in recurrence.stretches if not stretch.leg.collapsed
    ]
    ends = [
        (each, stretch.start + stretch.duration, stretch.end) for each, stretch in legs if each is not None
    ]
    return replace(opening, message=f"{opening.message} {going_through(machine, ends)}".strip())


def _with_broken(
    opening: Opening | Outcome, machine: HybridMachine, recurrence: HybridRecurrence
) -> Opening | Outcome:
    """The opening, with a word on declared directions that are neutral but for an event of the recurrence."""
    if isinstance(opening, Outcome):
        return opening
    sentences = [opening.message]
    for name, transition in broken_by_events(machine, recurrence).items():
        sentences.append(
            f"The direction '{name}' is not neutral on this branch: '{transition.name}' breaks it"
            f"{line_aside(transition.reset or transition.guard)}, by its guard or its reset. It is not held, "
            "and its multiplier is one among the others."
        )
    return replace(opening, message=" ".join(filter(None, sentences)))


def opened_itinerary(
    system: System,
    parameters: Mapping[str, float],
    free: str,
    settings: Settings,
    path: Ends | None,
    at: float | None,
    discretization: Discretization | None,
    stored: StoredItinerary,
) -> Opening | Outcome:
    """The branch of hybrid orbits through a stored one, or why there is none; arguments as for
    `opened_orbit`.
    """
    itinerary = named_itinerary(system, stored.legs, stored.image)
    own, reference = list(system.states_of(itinerary.legs[0].mode)), np.zeros(len(system.states))
    reference[own] = stored.unknowns[: len(own)]
    kind = SoftOrbit if applies(system, itinerary) else HybridOrbit
    problem = kind(
        system,
        itinerary,
        parameters,
        free,
        path,
        pins=[pin for pin in system.neutral if pin.name in stored.pins],
        reference=reference,
        subharmonic=stored.subharmonic,
        discretization=discretization,
    )
    z = np.append(stored.unknowns[:-1], parameters[free] if at is None else at)
    try:
        orbit = discretized(problem, z)
        line = orbit.line
        if broken_at(orbit, z, line.at(line.elsewhere(system, float(z[-1])))):
            orbit, z = whole(orbit, z)
        return _hybrid(orbit, z, settings)
    except (PluginError, NotFinite) as error:
        return not_begun.no_start(error.reason, error.sentence)


def _hybrid(
    problem: HybridOrbit, z: np.ndarray, settings: Settings, settled: bool = False
) -> Opening | Outcome:
    """The orbit of a simulated recurrence, corrected; `settled`: the motion has settled on it."""
    itinerary = folded(problem.itinerary.signature(problem.system)) or "no events"
    try:
        with problem.effort.of_start(problem.cost, settled):
            state = begin(problem, z, settings)
    except StartError as error:
        found = one_of_a_family_near(problem, z)
        sentence = _with_hops(problem, z, f"{error.sentence} (itinerary: {itinerary})")
        return found or not_begun.refused(sentence, error.remedy)
    if not isinstance(state, ContinuationState):
        refuse(kinks_along(problem, z))
        sentence = f"{state.sentence} (itinerary: {itinerary})"
        if state.reason == "no_convergence":
            sentence = _with_hops(problem, z, sentence)
            sentence = f"{sentence} {not_begun.PERHAPS_NOT_PERIODIC if settled else ''}".strip()
        return not_alone(problem, z, state) or not_begun.no_start(state.reason, sentence, "a periodic orbit")
    problem, _ = equations_at(problem, state.sample.z)
    one_instant = joined(problem, state.sample)
    if one_instant is not None:
        return one_instant if isinstance(one_instant, Outcome) else _hybrid(*one_instant, settings, settled)
    collapsed = collapsed_event(problem, state.sample.z)
    if collapsed:
        return outcome_of_family(problem, z) or _collapsed(
            problem, state.sample.z, collapsed, itinerary, hops(problem, z)
        )
    if is_one_of_a_family(problem, state.sample.z):
        return outcome_of_family(problem, z) or one_of_many()
    if name := off_its_value(problem, state.sample.z):
        return not_conserved(name)
    shorter, z = _least(problem, state.sample, settings)
    if shorter is not problem:  # it was looked at for longer than its period, or than half of it
        return _hybrid(shorter, z, settings, settled)
    try:
        adapted, sample = problem.adapted(state.sample)
    except np.linalg.LinAlgError:
        return not_begun.no_start(
            "no_convergence",
            "The equations are singular at the first orbit: others lie beside it at the same parameters, as "
            f"where nothing changes a state. (itinerary: {itinerary})",
            "a periodic orbit",
        )
    # On the steps of the branch everything is told anew: those of the start were made for a guess.
    sample = adapted.examine(
        sample.z, sample.tangent, sample.weights, adapted.linearize(sample.z), sample.unstable
    )
    lost = [problem.limits[k].name for k in np.flatnonzero(sample.margins < -NO_MARGIN)]
    message = f"{unused_symmetries(problem, state.sample.z)} {sentence_on(problem)}".strip()
    if settled and sample.unstable:
        message = f"{message} {UNSTABLE}".strip()
    if lost:
        names = ", ".join(f"'{name}'" for name in dict.fromkeys(lost))
        message = f"{message} The first orbit is not admissible: {names}.".strip()
    message = f"{message} {past_all_along(adapted, sample.z)}".strip()
    return Opening(adapted, ContinuationState(sample, state.s, state.step), message)


def _least(problem: HybridOrbit, sample: Sample, settings: Settings) -> tuple[HybridOrbit, np.ndarray]:
    """The least part of an orbit that tells all of it; `problem` itself where it does."""
    there, again = solved_finely(problem, sample, settings)
    shorter, z = least(there, again.z)
    return (problem, sample.z) if shorter is there else (shorter, z)


def _with_hops(problem: HybridOrbit, z: np.ndarray, sentence: str) -> str:
    """Why a start does not converge, with the plugin's line of what jumps on the way."""
    return f"{sentence} {hops(problem, z)}".strip()


def _collapsed(problem: HybridOrbit, z: np.ndarray, event: str, itinerary: str, hopped: str) -> Outcome:
    """Two events follow each other in no time: two that coincide, or one and a spurious zero after it.

    `hopped`: what jumps on Newton's way there, in a sentence.
    """
    legs = [i for i, leg in enumerate(problem.itinerary.legs) if leg.name == event and not leg.collapsed]
    shortest = min(legs, key=lambda i: float(z[problem.layout.durations][i]))
    before = problem.itinerary.leading_in(problem.system, shortest)
    if before == event:
        return not_begun.no_start(
            "no_convergence",
            f"The correction lets the segment before '{event}' shrink to nothing (itinerary: {itinerary}). "
            f"{hopped}".strip(),
            "a periodic orbit",
        )
    return not_begun.refused(
        f"'{before}' and '{event}' happen at once (itinerary: {itinerary}): which one comes first changes "
        f"along a branch there, and its equations hold on one side only. {hopped}".strip(),
        "Begin at another value of a parameter, at which one comes before the other.",
    )

"""The first orbit of a branch: corrected, closed up to a symmetry where it has one, cut into segments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from contwalk.branch import Outcome
from contwalk.continuation import outcomes
from contwalk.continuation.newton import Correction
from contwalk.continuation.opening import Opening
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState, begin
from contwalk.errors import NotFinite, PluginError, StartError
from contwalk.flow.hybrid.going_through import going_through
from contwalk.flow.hybrid.machine import HybridMachine, hybrid_machine
from contwalk.problems.conserving import with_own_values
from contwalk.problems.hybrid.families import broken_by_events
from contwalk.problems.hybrid.hopping import hops
from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.hybrid.lap import Lap
from contwalk.problems.hybrid.least import least, unused_symmetries
from contwalk.problems.hybrid.obstacles import collapsed as collapsed_event
from contwalk.problems.hybrid.soft_orbit import SoftOrbit, applies, softened
from contwalk.problems.hybrid.switching import discretized
from contwalk.problems.initial.event_recurrence import lap_from
from contwalk.problems.initial.orbit_from_recurrence import orbit_of
from contwalk.problems.initial.orbit_from_state import orbit_at, repetitions, symmetric
from contwalk.problems.initial.recurrence import AtRest, recurrent
from contwalk.problems.kinks import refuse
from contwalk.problems.orbit.conservation import off_its_value
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.orbit.kinks_met import kinks_along
from contwalk.problems.orbit.periodic_orbit import PeriodicOrbit
from contwalk.problems.orbit.word import named_word
from contwalk.problems.parameter_line import Ends, ParameterLine
from contwalk.problems.problem import equations_at
from contwalk.problems.sample import NO_MARGIN
from contwalk.problems.stored_word import StoredWord
from contwalk.python_functions import line_of
from contwalk.signatures import folded
from contwalk.studies.families import ONE_OF_A_FAMILY, Places, family_at, is_one_of_a_family, member_near
from contwalk.studies.opening import opened
from contwalk.system import Neutral, System

# Values of a conserved quantity that differ by more than this part are two.
OTHER = 1e-6
# A motion this small against its place may be the last of one that comes to rest.
FAINT = 1e-6
UNSTABLE = (
    "The first orbit is unstable, though the simulation was to settle on it: a motion beside it goes "
    "elsewhere, if slowly."
)


def opened_orbit(
    system: System,
    parameters: Mapping[str, float],
    free: str,
    state: np.ndarray,
    settings: Settings,
    path: Ends | None = None,
    at: float | None = None,
    discretization: Discretization | None = None,
    period: float | None = None,
    until: float | str | None = None,
    mode: str | None = None,
    event: str | None = None,
    subharmonic: int = 1,
    pins: Sequence[Neutral] | None = None,
) -> Opening | Outcome:
    """The branch of orbits through the one near a state, or why there is none.

    Parameters
    ----------
    system, parameters, free, path, at
        As for `opening.opened`.
    period : float, optional
        Seconds, of an autonomous system's orbit or for a subharmonic one.
    until : float or "settled", optional
        Simulate from the state so long first, and take the orbit that the motion settles on.
    mode, event : str, optional
        Of a hybrid system, the mode that the state is in, or the transition that it is right before.
    subharmonic, pins
        Of smooth orbits, as for `initial.orbit_from_state.orbit_at`.
    """
    line = ParameterLine.of(system, parameters, free, path)
    given = system, line, at, state, settings, discretization
    try:
        if system.acting:
            found = _eventful(*given, until, mode, event)
        else:
            found = _smooth(*given, period, until, subharmonic, pins)
    except AtRest as rest:
        ends = line.ends
        found = _resting(opened(system, parameters, free, rest.state, settings, ends, at, discretization))
    except PluginError as error:
        found = outcomes.no_start("plugin_error", error.sentence)
    except NotFinite as error:
        found = outcomes.no_start("not_finite", error.sentence)
    except StartError as error:
        found = outcomes.refused(error.sentence, error.remedy)
    if not isinstance(found, Outcome) or found.reason != "no_convergence":
        return found
    asked = _other_values(system, line.at(line.place(at)), state, mode or system.modes[0].name)
    return replace(found, message=f"{found.message} {asked}".strip())


def _other_values(system: System, values: Mapping[str, float], state: np.ndarray, mode: str) -> str:
    """What a start has of conserved quantities of which something else is asked for, in words."""
    given = [name for name in system.conserved_names if not np.isnan(values[name])]
    if not given:
        return ""
    own = with_own_values(system, {**values, **dict.fromkeys(given, np.nan)}, state, mode)
    told = [
        f"The start has {name} = {own[name]:.6g}, and {values[name]:.6g} is asked for."
        for name in given
        if abs(own[name] - values[name]) > OTHER * max(abs(own[name]), abs(values[name]))
    ]
    return " ".join(told)


def _eventful(
    system: System,
    line: ParameterLine,
    at: float | None,
    state: np.ndarray,
    settings: Settings,
    discretization: Discretization | None,
    until: float | str | None,
    mode: str | None,
    event: str | None,
) -> Opening | Outcome:
    """The branch of orbits through events that a simulation from a state comes back on."""
    values = line.at(line.place(at))
    lap = lap_from(system, values, state, mode, event, until)
    explicit = orbit_of(HybridOrbit, system, line, at, lap, discretization)
    opening = _hybrid(*softened(*explicit), settings, until == "settled")
    machine = hybrid_machine(system, values)
    return _with_broken(_with_pushes(opening, machine, lap), machine, lap)


def _smooth(
    system: System,
    line: ParameterLine,
    at: float | None,
    state: np.ndarray,
    settings: Settings,
    discretization: Discretization | None,
    period: float | None,
    until: float | str | None,
    subharmonic: int,
    pins: Sequence[Neutral] | None,
) -> Opening | Outcome:
    """The branch of smooth orbits through a state, or through what a simulation from it settles on."""
    faint = False
    if until is not None:
        found = recurrent(system, line.at(line.place(at)), state, until)
        faint = bool(np.all(found.variation <= FAINT * np.abs(found.state).max()))
        state, period = found.state, found.period
    given = discretization, subharmonic, pins
    problem, z = orbit_at(system, line, at, state, period, *given)
    begun = begin(problem, z, settings)
    if isinstance(begun, ContinuationState) and problem.moves(begun.sample.z):
        times = repetitions(problem, begun.sample.z)
        if times > 1:  # it was begun with a multiple of its period
            first = begun.sample.z[: problem.states]
            part = problem.duration(begun.sample.z) / times
            problem, z = orbit_at(system, line, at, first, part, *given)
            begun = begin(problem, z, settings)
    if not isinstance(begun, ContinuationState):
        refuse(kinks_along(problem, z))
        return _not_alone(problem, z, begun) or outcomes.no_start(
            begun.reason, begun.sentence, "a periodic orbit"
        )
    if not problem.moves(begun.sample.z):
        if faint:  # the last of a motion that dies away
            raise AtRest(state)
        return _family(problem, z) or outcomes.no_start(
            "no_convergence",
            "The correction ends at an equilibrium, which is no orbit.",
            "a periodic orbit",
        )
    if is_one_of_a_family(problem, begun.sample.z):
        return _family(problem, z) or _one_of_many()
    if name := off_its_value(problem, begun.sample):
        return _not_conserved(name)
    return _closed(problem, begun, settings)


def _with_pushes(opening: Opening | Outcome, machine: HybridMachine, lap: Lap) -> Opening | Outcome:
    """The opening, with a word on events of the lap after which the machine goes on as a stop would not."""
    if isinstance(opening, Outcome):
        return opening
    legs = [(stretch.leg.transition, stretch) for stretch in lap.stretches if not stretch.leg.collapsed]
    ends = [
        (each, stretch.start + stretch.duration, stretch.end) for each, stretch in legs if each is not None
    ]
    return replace(opening, message=f"{opening.message} {going_through(machine, ends)}".strip())


def _with_broken(opening: Opening | Outcome, machine: HybridMachine, lap: Lap) -> Opening | Outcome:
    """The opening, with a word on declared directions that are neutral but for an event of the lap."""
    if isinstance(opening, Outcome):
        return opening
    told = [opening.message]
    for name, transition in broken_by_events(machine, lap).items():
        line = line_of(transition.reset or transition.guard).removesuffix(": ")
        told.append(
            f"The direction '{name}' is not neutral on this branch: '{transition.name}' breaks it"
            f"{f' ({line})' if line else ''}, by its guard or its reset. It is not held, and its multiplier "
            "is one among the others."
        )
    return replace(opening, message=" ".join(filter(None, told)))


def _resting(opening: Opening | Outcome) -> Opening | Outcome:
    """The branch of equilibria that begins where a simulation has come to rest."""
    if isinstance(opening, Outcome):
        return opening
    said = "The simulation came to rest at an equilibrium: the equilibria are followed."
    return replace(opening, message=f"{said} {opening.message}".strip())


def opened_word(
    system: System,
    parameters: Mapping[str, float],
    free: str,
    state: np.ndarray,
    settings: Settings,
    path: Ends | None,
    at: float | None,
    discretization: Discretization | None,
    stored: StoredWord,
) -> Opening | Outcome:
    """The branch of hybrid orbits through a stored one, or why there is none; arguments as for
    `opened_orbit`.
    """
    word = named_word(system, stored.legs, stored.image)
    own, reference = list(system.states_of(word.legs[0].mode)), np.zeros(len(system.states))
    reference[own] = stored.unknowns[: len(own)]
    kind = SoftOrbit if applies(system, word) else HybridOrbit
    problem = kind(
        system,
        word,
        parameters,
        free,
        path,
        [pin for pin in system.neutral if pin.name in stored.pins],
        reference,
        stored.subharmonic,
        discretization,
    )
    z = np.append(stored.unknowns[:-1], parameters[free] if at is None else at)
    try:
        return _hybrid(discretized(problem, z), z, settings)
    except PluginError as error:
        return outcomes.no_start("plugin_error", error.sentence)
    except NotFinite as error:
        return outcomes.no_start("not_finite", error.sentence)


def _hybrid(
    problem: HybridOrbit, z: np.ndarray, settings: Settings, settled: bool = False
) -> Opening | Outcome:
    """The orbit of a simulated lap, corrected; `settled`: the motion has settled on it."""
    word = folded(problem.signature) or "no events"
    try:
        with problem.effort.of_start(problem.cost, settled):
            state = begin(problem, z, settings)
    except StartError as error:
        found = _one_of_a_family_near(problem, z)
        sentence = _with_hops(problem, z, f"{error.sentence} (word: {word})")
        return found or outcomes.refused(sentence, error.remedy)
    if not isinstance(state, ContinuationState):
        refuse(kinks_along(problem, z))
        sentence = f"{state.sentence} (word: {word})"
        if state.reason == "no_convergence":
            sentence = _with_hops(problem, z, sentence)
        return _not_alone(problem, z, state) or outcomes.no_start(state.reason, sentence, "a periodic orbit")
    problem, _ = equations_at(problem, state.sample.z)
    collapsed = collapsed_event(problem, state.sample.z)
    if collapsed:
        return _family(problem, z) or _collapsed(problem, state.sample.z, collapsed, word, hops(problem, z))
    if is_one_of_a_family(problem, state.sample.z):
        return _family(problem, z) or _one_of_many()
    if name := off_its_value(problem, state.sample):
        return _not_conserved(name)
    shorter, z = least(problem, state.sample.z)
    if shorter is not problem:  # it was looked at for longer than its period, or than half of it
        return _hybrid(shorter, z, settings, settled)
    try:
        adapted, sample = problem.adapted(state.sample)
    except np.linalg.LinAlgError:
        return outcomes.no_start(
            "no_convergence",
            "The equations are singular at the first orbit: others lie beside it at the same parameters, as "
            f"where nothing changes a state. (word: {word})",
            "a periodic orbit",
        )
    # On the steps of the branch everything is told anew: those of the start were made for a guess.
    sample = adapted.examine(
        sample.z, sample.tangent, sample.weights, adapted.linearize(sample.z), sample.unstable
    )
    lost = [problem.limits[k].name for k in np.flatnonzero(sample.margins < -NO_MARGIN)]
    message = unused_symmetries(problem, state.sample.z)
    if settled and sample.unstable:
        message = f"{message} {UNSTABLE}".strip()
    if lost:
        names = ", ".join(f"'{name}'" for name in dict.fromkeys(lost))
        message = f"{message} The first orbit is not admissible: {names}.".strip()
    return Opening(adapted, ContinuationState(sample, state.s, state.step), message)


def _with_hops(problem: HybridOrbit, z: np.ndarray, sentence: str) -> str:
    """Why a start does not converge, with the plugin's line of what jumps on the way."""
    return f"{sentence} {hops(problem, z)}".strip()


def _not_alone(problem: HybridOrbit | PeriodicOrbit, z: np.ndarray, failure: Correction) -> Outcome | None:
    """The outcome where orbits near a start come in a family; None where something else keeps it."""
    if failure.reason != "no_convergence":
        return None
    found = _family(problem, z)
    return found or (_one_of_a_family_near(problem, z) if isinstance(problem, HybridOrbit) else None)


def _one_of_a_family_near(problem: HybridOrbit, z: np.ndarray) -> Outcome | None:
    """The outcome of a start that comes back on none of its laps, where orbits near it come in a family."""
    try:
        with problem.effort.of_start(problem.cost):
            member = member_near(problem, z)
    except (StartError, PluginError, NotFinite, np.linalg.LinAlgError):
        return None
    if member is None or collapsed_event(problem, member) or not is_one_of_a_family(problem, member):
        return None
    return _family(problem, member)


def _family(problem: HybridOrbit | PeriodicOrbit, z: np.ndarray) -> Outcome | None:
    """The outcome of a start whose neighbours are orbits at the same parameters; None where they are not."""
    if isinstance(problem, HybridOrbit):
        places, word = _hybrid_places(problem), f" (word: {folded(problem.signature) or 'no events'})"
    else:
        places, word = _smooth_places(problem), ""
    found = family_at(problem, z, places)
    if found is None:
        return None
    return outcomes.refused(found.sentence + word, found.remedy)


def _not_conserved(name: str) -> Outcome:
    """The outcome of an orbit along which something that is declared to be conserved is not."""
    return outcomes.refused(
        f"'{name}' is not conserved along the first orbit, at these parameters.",
        "Correct its function in the plugin, or the equations, change the parameters that make it lose or "
        "gain, or remove it from conserved=(...).",
    )


def _one_of_many() -> Outcome:
    """The outcome of an orbit beside which there are others, where nothing tells why."""
    return outcomes.refused("Other orbits lie beside the first one, at the same parameters.", ONE_OF_A_FAMILY)


def _smooth_places(problem: PeriodicOrbit) -> Places:
    """States at the starts of segments, and the equations of the last segment's end."""
    n, m, names = problem.states, problem.segments, problem.system.state_names
    unknowns = {i: names[i % n] for i in range(m * n)}
    return Places(unknowns, {(m - 1) * n + i: name for i, name in enumerate(names)})


def _hybrid_places(problem: HybridOrbit) -> Places:
    """States at the starts of legs, and the equations of the last leg's end."""
    names, layout = problem.system.state_names, problem.layout
    unknowns = {
        place: names[state]
        for own, passage in zip(layout.states, problem.passages, strict=True)
        for place, state in zip(range(own.start, own.stop), passage.states, strict=True)
    }
    last, first = layout.matches[-1], problem.passages[0].states
    return Places(unknowns, {last.start + k: names[state] for k, state in enumerate(first)})


def _collapsed(problem: HybridOrbit, z: np.ndarray, event: str, word: str, hopped: str) -> Outcome:
    """Two events follow each other in no time: two that coincide, or one and a spurious zero after it.

    `hopped`: what jumps on Newton's way there, in a sentence.
    """
    legs = [i for i, leg in enumerate(problem.word.legs) if leg.name == event and not leg.collapsed]
    shortest = min(legs, key=lambda i: float(z[problem.layout.durations][i]))
    before = problem.word.leading_in(problem.system, shortest)
    if before == event:
        return outcomes.no_start(
            "no_convergence",
            f"The correction lets the leg before '{event}' shrink to nothing (word: {word}). "
            f"{hopped}".strip(),
            "a periodic orbit",
        )
    return outcomes.refused(
        f"'{before}' and '{event}' happen at once (word: {word}): which one comes first changes along a "
        f"branch there, and its equations hold on one side only. {hopped}".strip(),
        "Begin at another value of a parameter, at which one comes before the other.",
    )


def _closed(problem: PeriodicOrbit, state: ContinuationState, settings: Settings) -> Opening:
    """The orbit closed up to a symmetry that it has, on steps made for it."""
    sample = state.sample
    part = symmetric(problem, sample.z, sample.weights)
    message = ""
    if part is not None:
        there = begin(*part, settings)
        if isinstance(there, ContinuationState):
            problem, state = part[0], there
            closure = problem.closure
            message = (
                f"The orbit is its own image under '{closure.name}' 1/{closure.fold} of a period later: "
                "only that part is integrated."
            )
    adapted, sample = problem.adapted(state.sample)
    if np.array_equal(sample.z, state.sample.z):  # what was solved, not what the next steps see of it
        sample = replace(sample, excess=state.sample.excess)
    return Opening(adapted, ContinuationState(sample, state.s, state.step), message)

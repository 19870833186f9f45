"""Transitions: guards, resets, and whether a guard is left behind by its own reset."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from contwalk.errors import ContwalkError, PluginError
from contwalk.fields.derivative import jacobian
from contwalk.plugin_check.angles import check_angles_at_event
from contwalk.plugin_check.declarations import check_repeats
from contwalk.plugin_check.findings import Report, place_of
from contwalk.plugin_check.functions import EPSILON, check_guard, check_map
from contwalk.plugin_check.guards import check_timeless
from contwalk.plugin_check.samples import Samples
from contwalk.plugin_check.states_at_event import FACTOR, rate_of, states_at_event
from contwalk.plugin_check.traced import Form, Traced, traced, vector_form
from contwalk.system import System, Transition

# How many tries are made where a plugin is loaded, and how many states are enough there.
FEW_TRIES = 16
FEW = 3
# How far beyond an event a guard is asked for its sign, as a part of the states' scales.
BEYOND = 1e-3
# How the guard of an event stands after it: left behind; past zero, where it is no event, or gone on through
# it faster than it came; happening again.
LEFT, PAST, PUSHED, AGAIN = "left", "past", "pushed", "again"


@dataclass(frozen=True, eq=False)
class Happening:
    """A transition that can be used, with its guard, and times and full states right before it."""

    transition: Transition
    guard: Traced
    before: list[tuple[float, np.ndarray]]


def check_transition(
    report: Report,
    transition: Transition,
    system: System,
    fields: Mapping[str, Traced],
    samples: Samples,
    period: float | None = None,
) -> Happening | None:
    """Check the guard and the reset of a transition, and both together; None where they cannot be used."""
    guard = check_guard(report, f"guard of transition '{transition.name}'", transition, system, samples)
    sound = _check_reset(report, transition, system, samples) and check_states(report, transition, system)
    if guard is None or not sound or not {transition.source, transition.target} <= set(fields):
        return None
    reset = traced_reset(report, transition, system)
    for what, function in (("guard", guard), ("reset", reset)):
        named = f"{what} of transition '{transition.name}'"
        if function is not None and period is not None:
            turned = what == "guard" and transition.direction == "both"
            check_repeats(report, named, function, samples, period, turned)
        if function is not None and system.period is None:
            check_timeless(report, named, function)
    check_angles_at_event(report, transition.name, guard, reset, samples)
    before = states_at_event(transition, guard, fields[transition.source], samples)
    happening = Happening(transition, guard, before)
    if transition.role == "soft" and reset is not None:
        _check_kept(report, happening, reset, samples)
    if transition.role == "soft":
        _check_continuous(report, happening, fields, samples)
    if transition.role != "watched" and reset is not None and reset.is_identity():
        what = f"reset of transition '{transition.name}'"
        report.ok(what, "keeps the state, and says so.", place_of(transition.reset))
    elif transition.role != "watched" and transition.reset is not None:
        _check_leaving(report, happening, system, fields[transition.source], samples)
    if transition.role == "watched" and transition.reset is not None:
        report.warning(
            f"reset of transition '{transition.name}'",
            "A watched transition does not act: its reset is never used. Leave it out, or declare "
            "role='hard'.",
            place_of(transition.reset),
        )
    return happening


def check_passing(
    report: Report,
    happening: Happening,
    field: Traced,
    samples: Samples,
    happenings: Sequence[Happening],
    passed: Collection[str] = (),
) -> None:
    """The guard must have another sign beyond its zeros, and zeros at all.

    One that is passed against its direction only is no mistake where others lead out of its mode. Transitions
    that sample motions have passed can happen, wherever the states are that were tried for their zeros.
    """
    transition, guard = happening.transition, happening.guard
    what = f"guard of transition '{transition.name}'"
    place = place_of(transition.guard)
    beyond = [_just_beyond(transition, guard, t, x, samples) for t, x in happening.before]
    if beyond and not any(value > 0.0 for value in beyond):
        how = "has no value" if np.isnan(beyond).all() else "stays zero, or turns back"
        report.error(
            what,
            f"It comes to zero and does not pass it: beyond, it {how}. Return a number that has the other "
            "sign there, such as a distance that becomes negative.",
            place,
        )
    elif not beyond and transition.name in passed:
        return
    elif not beyond and (others := _passing_back(happening, field, samples)):
        sources = [h.transition.source for h in happenings if h.before and h.transition.role != "watched"]
        report.add(
            "ok" if transition.source in sources else "warning",
            what,
            f"It passes zero the other way at all {len(others)} of its zeros that were tried, and its "
            f"transition happens where it is {transition.direction}. If it is meant to happen there, turn "
            "the direction round, or the sign of the guard.",
            place,
        )
    elif not beyond and guard.depends() - {0}:
        values = [samples.evaluate(guard, row)[0] for row in range(len(samples.states))]
        sign = "positive" if min(values) > 0.0 else "negative" if max(values) < 0.0 else "finite"
        report.warning(
            what,
            f"No state was found at which it passes zero ({transition.direction}): it is {sign} at all "
            f"{len(values)} states that were tried, and no way leads to a zero from them. A number that only "
            "touches zero, such as a square or an absolute value, is no guard.",
            place,
        )


def _passing_back(happening: Happening, field: Traced, samples: Samples) -> list[tuple[float, np.ndarray]]:
    """Times and states on the guard at which it passes zero against the transition's direction."""
    other = {"falling": "rising", "rising": "falling"}.get(happening.transition.direction)
    if other is None:
        return []
    return states_at_event(replace(happening.transition, direction=other), happening.guard, field, samples)


def _just_beyond(transition: Transition, guard: Traced, t: float, x: np.ndarray, samples: Samples) -> float:
    """The guard a little beyond its zero, positive where it has the sign that it passes to."""
    scaled = guard.slopes(t, x, samples.values)[0, 1:] * samples.scales
    size = math.hypot(*scaled)  # squares of what is large in units of the guard overflow
    if not size > 0.0:  # a guard of time alone
        return 1.0
    way = 1.0 if transition.direction == "rising" else -1.0
    steps = (way,) if transition.direction != "both" else (1.0, -1.0)
    values = []
    for step in steps:
        there = x + step * BEYOND * samples.scales * scaled / size
        values.append(step * guard.values(t, there, samples.values)[0])
    return float(min(values))


def _check_reset(report: Report, transition: Transition, system: System, samples: Samples) -> bool:
    """Check the reset, if there is one; what is wrong with the relabelling is found with the symmetry."""
    form = reset_form(transition, system)
    if form is None or transition.reset is None:
        return form is not None
    what, source = f"reset of transition '{transition.name}'", transition.source
    return check_map(report, what, transition.reset, system, samples, form, source) is not None


def traced_reset(report: Report, transition: Transition, system: System) -> Traced | None:
    """A transition's reset; None where there is none, or, with a finding, where it cannot be used."""
    form = reset_form(transition, system)
    if form is None or transition.reset is None:
        return None
    what = f"reset of transition '{transition.name}'"
    return traced(report, what, transition.reset, system, form, mode=transition.source)


def reset_form(transition: Transition, system: System) -> Form | None:
    """What a transition's reset must write; None where its relabelling cannot be used."""
    needed: Collection[int] = system.states_of(transition.target)
    if transition.relabel is not None:
        own = system.symmetry(transition.relabel)
        try:
            relabel = Traced(own.map, system, vector_form(system, "map", "x_image"))
        except ContwalkError:
            return None
        if relabel.unwritten or not relabel.outputs():
            return None
        needed = _read(relabel, system.states_of(transition.target))
    every = len(needed) == len(system.states)
    return vector_form(system, "reset", "x_plus", None if every else needed)


def check_states(report: Report, transition: Transition, system: System) -> bool:
    """Whether the modes of a transition have the states that its role and its lack of a reset ask for."""
    source, target = (set(system.states_of(mode)) for mode in (transition.source, transition.target))
    what, place = f"transition '{transition.name}'", place_of(transition.guard)
    between = f"mode '{transition.source}' and mode '{transition.target}'"
    if _changes_nothing(transition):
        report.error(
            what,
            "It changes nothing: without a reset and without another mode the motion goes on through its "
            "guard. Give it a reset, or role='watched' if it is only to be told; a reset that keeps the "
            "state (x_plus[:] = x) says that nothing is meant to change.",
            place,
        )
        return False
    if transition.role == "soft" and source != target:
        names = ", ".join(system.state_names[i] for i in sorted(source ^ target))
        report.error(
            what,
            f"It is soft, but {between} do not have the same states ({names}). Declare role='hard': "
            "multipliers would be wrong.",
            place,
        )
        return False
    if transition.role == "hard" and transition.reset is None and target and not source & target:
        report.warning(
            what,
            f"It has no reset, and {between} have no state in common: what is after it begins with zeros. "
            "Write a reset.",
            place,
        )
    return True


def _changes_nothing(transition: Transition) -> bool:
    """Whether it acts, and what is after it is what was before."""
    same = transition.source == transition.target and transition.relabel is None
    return transition.role != "watched" and same and transition.reset is None


def check_soft(
    report: Report,
    transition: Transition,
    guard: Traced,
    reset: Traced | None,
    system: System,
    fields: Mapping[str, Traced],
    samples: Samples,
) -> None:
    """What would make multipliers wrong without a word, at a few states: a jump of the state or the field.

    Of modes that share a field by their constants only the state is looked at: each would be traced for it.
    """
    if not {transition.source, transition.target} <= set(fields):
        return
    shared = any(system.mode(mode).constants for mode in (transition.source, transition.target))
    if shared and reset is None:
        return
    met = happening(transition, guard, fields[transition.source], samples)
    if reset is not None:
        _check_kept(report, met, reset, samples)
    if not shared:
        _check_continuous(report, met, fields, samples)


def happening(transition: Transition, guard: Traced, field: Traced, samples: Samples) -> Happening:
    """A transition at a few states, for what is looked at when a plugin is loaded."""
    return Happening(transition, guard, states_at_event(transition, guard, field, samples, FEW_TRIES, FEW))


def _check_kept(report: Report, happening: Happening, reset: Traced, samples: Samples) -> None:
    """A soft transition must leave the state as it is: orbits are continued as if nothing happened there."""
    transition = happening.transition
    kept = [i for i in reset.system.states_of(transition.target) if i in reset.existing]
    for t, x in happening.before:
        jump = np.abs(reset.values(t, x, samples.values) - x)[kept]
        bound = FACTOR * EPSILON * (reset.roundings(t, x, samples.values) + np.abs(x))[kept]
        if (jump > np.maximum(bound, np.finfo(float).tiny)).any():
            i = kept[int(np.argmax(jump - bound))]
            now = reset.values(t, x, samples.values)[i]
            report.error(
                f"reset of transition '{transition.name}'",
                f"The transition is soft, but its reset changes {reset.system.state_names[i]} from "
                f"{x[i]:.6g} to {now:.6g}. Declare role='hard', or leave the reset out.",
                place_of(transition.reset),
            )
            return


def _check_continuous(
    report: Report, happening: Happening, fields: Mapping[str, Traced], samples: Samples
) -> None:
    """At a soft transition the field must be the same on both sides, in the states that exist on both."""
    transition = happening.transition
    before, after = fields[transition.source], fields[transition.target]
    both = [i for i in before.existing if i in after.existing]
    for t, x in happening.before:
        rates, bounds = [], []
        for field in (before, after):
            given = field.given(x)
            rates.append(field.values(t, given, samples.values))
            inherited = np.abs(field.slopes(t, given, samples.values)) @ np.abs([t, *given])
            bounds.append(field.roundings(t, given, samples.values) + inherited)
        jump = np.abs(rates[1] - rates[0])[both]
        # A damper's force is its constant times a speed that is zero but for the rounding of the guard.
        allowed = FACTOR * EPSILON * (bounds[0] + bounds[1])[both]
        if (jump > np.maximum(allowed, np.finfo(float).tiny)).any():
            i = both[int(np.argmax(jump - allowed))]
            report.error(
                f"transition '{transition.name}'",
                f"It is soft, but the field jumps there: {before.form.entry(i)} is {rates[0][i]:.6g} in mode "
                f"'{transition.source}' and {rates[1][i]:.6g} in mode '{transition.target}'. "
                "Declare role='hard': multipliers would be wrong.",
                place_of(transition.guard),
            )
            return


def _read(relabel: Traced, into: Sequence[int]) -> set[int]:
    """The states that a map takes the states `into` from."""
    graph = relabel.program.graph
    inputs = [graph.input("x", i) for i in relabel.existing]
    rows = [jacobian(graph, [leaf.nodes[i] for i in into], inputs) for leaf in relabel.outputs()]
    return {k for leaf in rows for row in leaf for k in row}


def _check_leaving(
    report: Report, happening: Happening, system: System, field: Traced, samples: Samples
) -> None:
    """After its own reset a guard that is armed again must be off zero on the right side, or leaving it."""
    transition = happening.transition
    what, place = f"reset of transition '{transition.name}'", place_of(transition.reset)
    if not any(t.source == transition.target and t.guard is transition.guard for t in system.transitions):
        report.ok(what, "leads to a mode that does not have its guard.", place)
        return
    known = _left_behind(happening, system, field, samples)
    leaving, past = sum(kind != AGAIN for kind in known), known.count(PAST)
    if not known:
        report.ok(
            what, "not checked whether its guard is left behind: no state at the event was found.", place
        )
    elif past and leaving == len(known):
        share = "at every state" if past == len(known) else f"at {past} of {len(known)} states"
        sentence = (
            f"After its own reset the guard is past zero, or goes on through it, {share} at the event that "
            "was tried: it happens again only where it has been back. That is right for a kick, as a clock's "
            "push; correct the reset, if the guard should turn back there, as at a stop."
        )
        report.warning(what, sentence, place)
    elif PUSHED in known and leaving == len(known):
        sentence = (
            f"goes on through its guard faster than it came, at {known.count(PUSHED)} of {len(known)} states "
            "at the event, as after a clock's push: it happens again only where it has been back."
        )
        report.ok(what, sentence, place)
    elif leaving == len(known):
        report.ok(what, f"leaves its guard behind, at {leaving} states at the event.", place)
    else:
        share = "at every state" if leaving == 0 else f"at {len(known) - leaving} of {len(known)} states"
        sentence = (
            f"After its own reset the guard is not left behind {share} at the event that was tried: it is "
            "zero and does not move away, or has passed zero already: the event would happen again at once."
        )
        if leaving == 0:
            report.error(what, f"{sentence} Correct the reset, or lead to a mode without this guard.", place)
        else:
            report.warning(what, f"{sentence} A motion that gets there ends.", place)


def _left_behind(happening: Happening, system: System, field: Traced, samples: Samples) -> list[str]:
    """For each state at the event how its guard stands after it, where that can be said."""
    from contwalk.flow.hybrid import guard_status  # compiled flows
    from contwalk.flow.hybrid.machine import hybrid_machine, landed

    transition, machine = happening.transition, hybrid_machine(system, samples.parameters)
    flow, found = machine.mode(transition.target), []
    numbers = [i for i, t in enumerate(flow.transitions) if t.guard is transition.guard]
    for t, x in happening.before:
        after, noise = landed(machine, transition, t, x)
        if not np.isfinite(after).all():
            continue
        own = [flow.transitions[i].name for i in numbers]
        given = after[flow.states], noise[flow.states], samples.scales[flow.states]
        try:
            standing = guard_status.guard_statuses(flow, t, *given, own, flow.passed(transition.name))
        except PluginError:  # the field raises there, which is told of it
            continue
        kinds = {standing[i].kind for i in numbers}
        goes_on = guard_status.BEYOND in kinds or guard_status.PASSED in kinds
        if guard_status.UNDEFINED not in kinds:
            again = any(guard_status.happens_at_once(flow, i, standing[i]) for i in numbers)
            stuck = again or guard_status.RESTING in kinds
            arriving = abs(rate_of(happening.guard, field, t, x, samples))
            passed = [standing[i] for i in numbers if flow.transitions[i].name == transition.name]
            pushed = guard_status.BEYOND not in kinds and any(
                each.kind == guard_status.PASSED and abs(each.rate) > arriving for each in passed
            )
            found.append(AGAIN if stuck else PUSHED if pushed else PAST if goes_on else LEFT)
    return found

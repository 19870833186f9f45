"""Sample motions of a hybrid plugin: do guards pass zero, and can the machine go on after its transitions?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from contwalk.errors import PluginError, StartError
from contwalk.flow.events.guard import EPSILON
from contwalk.flow.hybrid.guard_status import ROUNDINGS
from contwalk.flow.hybrid.machine import ModeFlow
from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import (
    HybridMachine,
    MotionSegment,
    applied,
    hybrid_machine,
    motion_segments,
)
from contwalk.flow.hybrid.past_zero import past_zero
from contwalk.plugin_check.events import Happening
from contwalk.plugin_check.findings import Report, place_of
from contwalk.plugin_check.samples import Samples
from contwalk.system import System, Transition

TOLERANCE = 1e-8
MOST_SEGMENTS, MOST_STEPS, MOST_STARTS = 8, 300, 6
# Of a machine with many modes motions are shorter, but not than this: so many segments are followed together,
# and each mode is begun in anyway.
FEWEST_SEGMENTS, MOST_TOGETHER = 4, 10_000

# A guard that passes zero with less than this part of the largest rate on its way there only touches it.
TRANSVERSAL = 1e-7
# One that is more than this part of its largest value on the way there has jumped.
JUMPED = 1e-3
# Motions of which this part ends somehow are told with a warning.
OFTEN = 0.5
# How a motion ends that comes to a circle of transitions without any time.
CHAIN = "chain"
# Segments of so many motions are kept for each mode.
MOST_KEPT = 40


@dataclass
class Seen:
    """What sample motions have met.

    Parameters
    ----------
    longest : int
        Segments that a motion is followed for.
    motions : int
    eventful : int
        Those of them that meet a transition.
    rates, values : dict
        For each transition the guard's rate at each event, and its value, as a part of the largest one on the
        way there.
    events : dict
        For each transition times and states right before it.
    ends : dict
        For each status other than `ok` the sentences of the motions that ended so, each with the transition
        and the mode.
    carried : dict
        For each transition that leads back to its mode, and each other one out of it that acts, at how many
        events the reset carries that one's guard through zero, and how many events there were.
    entered : dict
        For each transition into another mode, and each one out of that which acts, at how many events it
        leads there with that one's guard past zero and going on, and how many events there were.
    lost : dict
        For each transition what is said of motions after which no guard can be met; empty of others.
    gone_on : set
        Transitions after which a motion has met another one.
    segments : dict
        For each mode times and states of some motions.
    """

    longest: int = MOST_SEGMENTS
    motions: int = 0
    eventful: int = 0
    rates: dict[str, list[float]] = field(default_factory=dict)
    values: dict[str, list[float]] = field(default_factory=dict)
    events: dict[str, list[tuple[float, np.ndarray]]] = field(default_factory=dict)
    ends: dict[str, list[tuple[str, str | None, str]]] = field(default_factory=dict)
    carried: dict[tuple[str, str], list[int]] = field(default_factory=dict)
    entered: dict[tuple[str, str], list[int]] = field(default_factory=dict)
    lost: dict[str, list[str]] = field(default_factory=dict)
    gone_on: set[str] = field(default_factory=set)
    segments: dict[str, list[tuple[np.ndarray, np.ndarray]]] = field(default_factory=dict)

    def end(self, status: str, reason: str, transition: str | None, mode: str) -> None:
        """Note how a motion ends."""
        self.ends.setdefault(status, []).append((reason, transition, mode))

    def add(self, machine: HybridMachine, segment: MotionSegment) -> None:
        """Take a segment in."""
        kept = self.segments.setdefault(segment.mode, [])
        if len(kept) < MOST_KEPT and len(segment.times) > 1:
            kept.append((segment.times, segment.states))
        if (
            segment.transition is None or len(segment.times) == 1
        ):  # none, or at once: a sampled state made it so
            return
        self.events.setdefault(segment.transition, []).append((float(segment.times[-1]), segment.states[-1]))
        flow = machine.mode(segment.mode)
        number = [t.name for t in flow.transitions].index(segment.transition)
        measured = flow.guards[number].along(segment.times, segment.states[:, flow.states], flow.p)
        fast = np.abs(measured[[0, -1], 1]).min()  # at a pole the last one is anything
        rounded = ROUNDINGS * (measured[-1, 2] + fast * EPSILON * abs(segment.times[-1]))
        if abs(measured[-1, 0]) <= rounded:  # as where impacts accumulate, and heights are rounding alone
            measured[-1, 0] = 0.0
        for found, column in ((self.values, 0), (self.rates, 1)):
            sizes = np.abs(measured[:, column])
            part = sizes[-1] / max(np.nanmax(sizes, initial=0.0), 1e-300)
            found.setdefault(segment.transition, []).append(float(part))
        self._note_carried(flow, segment)
        self._note_entered(machine, flow, segment)

    def _note_carried(self, flow: ModeFlow, segment: MotionSegment) -> None:
        """Note guards of other transitions that an event's reset carries through zero in their direction."""
        happening = next(t for t in flow.transitions if t.name == segment.transition)
        if happening.target != flow.name or happening.relabel is not None or segment.after is None:
            return
        t = float(segment.times[-1])
        states = np.stack([segment.states[-1], segment.after])[:, flow.states]
        if not np.isfinite(states).all():
            return
        for number, other in enumerate(flow.transitions):
            guard = flow.guards[number]
            if other is happening or not flow.acting(number) or other.at_entry:
                continue
            (before, _, noise), (after, _, later) = guard.along(np.array([t, t]), states, flow.p).tolist()
            met = self.carried.setdefault((happening.name, other.name), [0, 0])
            met[1] += 1
            way = guard.direction or -np.sign(before)
            met[0] += way * before < -ROUNDINGS * noise and way * after > ROUNDINGS * later

    def _note_entered(self, machine: HybridMachine, flow: ModeFlow, segment: MotionSegment) -> None:
        """Note guards that are past zero, and go on, where an event leads into another mode: none happens."""
        happening = next(t for t in flow.transitions if t.name == segment.transition)
        if happening.target == flow.name or segment.after is None or not np.isfinite(segment.after).all():
            return
        target, t = machine.mode(happening.target), segment.times[-1:]
        for number, other in enumerate(target.transitions):
            guard = target.guards[number]
            if not (target.acting(number) and guard.direction) or other.at_entry:
                continue
            value, rate, noise = guard.along(t, segment.after[None, target.states], target.p)[0].tolist()
            met = self.entered.setdefault((happening.name, other.name), [0, 0])
            met[1] += 1
            met[0] += guard.direction * value > ROUNDINGS * noise and guard.direction * rate > 0.0


def check_motions(
    report: Report, system: System, modes: Sequence[str], happenings: Sequence[Happening], samples: Samples
) -> Seen:
    """Follow motions from sampled states in some modes, and from states right before each transition."""
    seen = Seen(_longest(len(samples.times) * len(modes) + MOST_STARTS * len(happenings)))
    machine = hybrid_machine(system, samples.parameters)
    for mode in modes:
        for t, x in zip(samples.times, samples.states, strict=True):
            _follow(seen, machine, float(t), x, mode, None, samples)
    for happening in happenings:
        if happening.transition.role != "watched":
            target = happening.transition.target
            for t, x in happening.before[:MOST_STARTS]:
                after = applied(machine, happening.transition, t, x)
                _look_ahead(seen, machine, happening, t, after, samples)
                _follow(seen, machine, t, after, target, happening.transition.name, samples)
    _tell(report, system, seen)
    return seen


def _longest(motions: int) -> int:
    """For how many segments each of so many motions is followed."""
    return max(FEWEST_SEGMENTS, min(MOST_SEGMENTS, MOST_TOGETHER // max(motions, 1)))


def _follow(
    seen: Seen, machine: HybridMachine, t: float, x: np.ndarray, mode: str, last: str | None, samples: Samples
) -> None:
    if not np.isfinite(x).all():
        return
    try:
        if last is None:
            past_zero(machine, t, x, mode, samples.scales)
    except (StartError, PluginError):  # a sampled state on the wrong side of a guard
        return
    control = Control(TOLERANCE, samples.scales)
    motion = motion_segments(machine, t, x, mode, np.inf, control, last, MOST_STEPS)
    met, before = False, last
    try:
        for count, segment in enumerate(motion, start=1):
            seen.add(machine, segment)
            if before is not None and segment.transition is not None:
                seen.gone_on.add(before)
            before = segment.transition
            if segment.status not in ("ok", "too_many_steps"):
                status = CHAIN if segment.status == "sticking" and count > MOST_SEGMENTS else segment.status
                seen.end(status, segment.reason, segment.transition, segment.mode)
            met = met or segment.transition is not None
            if (
                count >= seen.longest and len(segment.times) > 1
            ):  # those that take no time are followed to their end
                break
    except PluginError as error:
        seen.end("plugin_error", str(error), None, mode)
    seen.motions += 1
    seen.eventful += met or last is not None


def _look_ahead(
    seen: Seen, machine: HybridMachine, happening: Happening, t: float, x: np.ndarray, samples: Samples
) -> None:
    """Note whether guards can be met after a transition: none can, where all are past zero, and stay so."""
    name, mode = happening.transition.name, happening.transition.target
    said = ""
    if np.isfinite(x).all():
        try:
            past_zero(machine, t, x, mode, samples.scales)
        except StartError as error:
            said = error.sentence
        except PluginError:
            pass
    seen.lost.setdefault(name, []).append(said)


def _tell(report: Report, system: System, seen: Seen) -> None:
    what, before = "sample motions", len(report.findings)
    for transition in {t.name: t for t in system.acting}.values():
        _tell_of_guard(report, transition, seen)
        _tell_of_what_follows(report, system, transition, seen)
    for (name, other), (count, events) in seen.carried.items():
        if count:
            _tell_of_carried(report, system, name, other, f"{count} of {events}")
    for (name, other), (count, events) in seen.entered.items():
        if count > max(OFTEN * events, 1):  # a few sampled motions may be none of the machine's
            _tell_of_entered(report, system, name, other, f"{count} of {events}")
    _tell_of_ends(report, system, seen)
    met = {name: len(events) for name, events in seen.events.items()}
    if len(report.findings) > before:
        return
    if not met:
        report.ok(what, f"{seen.motions} motions from sampled states meet no transition.")
        return
    counted = ", ".join(f"{count} of '{name}'" for name, count in met.items())
    accumulate = " Transitions of some accumulate." if "chatter" in seen.ends else ""
    report.ok(what, f"{seen.motions} motions pass {counted}, each with a rate.{accumulate}")


def _tell_of_guard(report: Report, transition: Transition, seen: Seen) -> None:
    """A guard must pass zero, with a rate, and not jump through it."""
    what, place = f"guard of transition '{transition.name}'", place_of(transition.guard)
    values, rates = seen.values.get(transition.name, []), seen.rates.get(transition.name, [])
    if not rates:
        return
    jumped = float(np.median(np.nan_to_num(values, nan=np.inf)))
    if jumped > JUMPED:
        size = f"{jumped:.2g} of its largest value on the way there" if jumped < np.inf else "not finite"
        report.error(
            what,
            f"It jumps through zero, or passes it at a pole: where it does so it is {size}, at the "
            f"{len(values)} events of sample motions. Orbits are equations, which it has no zero for. Return "
            "a number that passes zero evenly, as a distance does.",
            place,
        )
    elif np.median(rates) < TRANSVERSAL:
        report.error(
            what,
            f"It reaches zero with a rate of {np.median(rates):.1g} of the largest on the way there, at the "
            f"{len(rates)} events of sample motions: it does not pass zero, it only comes to it. "
            "Return a number that passes zero evenly, as a distance does and its cube does not.",
            place,
        )


def _tell_of_what_follows(report: Report, system: System, transition: Transition, seen: Seen) -> None:
    """After a transition a motion must be able to meet another one, if any leads out of its mode."""
    said = seen.lost.get(transition.name, [])
    if not said or not all(said) or transition.name in seen.gone_on:
        return  # states that were tried may be none that the machine comes to
    report.warning(
        f"transition '{transition.name}'",
        f"After it no transition out of mode '{transition.target}' can happen any more, at the {len(said)} "
        f"states at the event that were tried. {said[0].replace(' at the start', ' there')} Correct the sign "
        "or the direction of that guard, or the reset, or declare level=True where it should happen at once.",
        place_of(transition.reset or transition.guard),
    )


def _tell_of_carried(report: Report, system: System, name: str, other: str, share: str) -> None:
    """A reset that takes another guard past zero makes no event of it."""
    transition = system.transition(name, system.sources(name)[0])
    report.warning(
        f"reset of transition '{name}'",
        f"At {share} of its events in sample motions it carries the guard of '{other}' past zero: that has "
        "not passed zero, and its event happens only where it has come back. Declare level=True for "
        f"'{other}' where it should follow at once, as a neuron that a pulse brings beyond its threshold.",
        place_of(transition.reset or transition.guard),
    )


def _tell_of_entered(report: Report, system: System, name: str, other: str, share: str) -> None:
    """A mode that is entered with a guard past zero stays until that has come back."""
    transition = system.transition(name, system.sources(name)[0])
    report.warning(
        f"transition '{name}'",
        f"At {share} of its events in sample motions mode '{transition.target}' is entered with the guard of "
        f"'{other}' past zero and going on: that does not pass zero, and '{other}' does not happen. Declare "
        f"level=True for '{other}' where it should follow at once, as a mass that does not stick where the "
        "load is larger than friction holds.",
        place_of(transition.reset or transition.guard),
    )


def _tell_of_ends(report: Report, system: System, seen: Seen) -> None:
    """Motions that cannot go on."""
    for status, ended in seen.ends.items():
        if status == "chatter":
            continue
        reason, name, mode = ended[0]
        at_event = status in ("sticking", CHAIN)
        place = _place(system, name) if at_event else place_of(system.mode(mode).field)
        of = "One of them ends." if len(ended) == 1 else f"{len(ended)} of {seen.motions} end."
        share = len(ended) / max(seen.eventful if at_event else seen.motions, 1)
        level = "error" if at_event and share == 1.0 else "warning"
        if status != "sticking" and share < OFTEN:  # a few sampled states may be none of the machine's
            level = "ok"
        report.add(level, "sample motions", f"{of} {reason}", place)


def _place(system: System, name: str | None) -> tuple[str | None, int | None]:
    """Where the reset of a transition is, else its guard."""
    found: Sequence = [t for t in system.transitions if t.name == name]
    return place_of(found[0].reset or found[0].guard) if found else (None, None)

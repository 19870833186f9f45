"""Sample motions of a hybrid plugin: do guards pass zero, and can the machine go on after its transitions?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import islice

import numpy as np

from contwalk.errors import StartError
from contwalk.flow.hybrid.motions import Arc, HybridMachine, applied, arcs, hybrid_machine
from contwalk.flow.hybrid.past_zero import past_zero
from contwalk.plugin_check.events import Happening
from contwalk.plugin_check.findings import Report, place_of
from contwalk.plugin_check.samples import Samples
from contwalk.system import System

TOLERANCE = 1e-8
MOST_ARCS, MOST_STEPS, MOST_STARTS = 8, 300, 6

# A guard that passes zero with less than this part of the largest rate on its way there only touches it.
TRANSVERSAL = 1e-7


@dataclass
class Seen:
    """What sample motions have met.

    Parameters
    ----------
    motions : int
    rates : dict
        For each transition the guard's rate at each event, as a part of the largest one on the way there.
    events : dict
        For each transition times and states right before it.
    ends : dict
        For each status other than `ok` the sentence of the first motion that ended so, and the transition.
    """

    motions: int = 0
    rates: dict[str, list[float]] = field(default_factory=dict)
    events: dict[str, list[tuple[float, np.ndarray]]] = field(default_factory=dict)
    ends: dict[str, tuple[str, str | None]] = field(default_factory=dict)

    def add(self, machine: HybridMachine, arc: Arc) -> None:
        """Take an arc in."""
        if arc.status in ("sticking", "chatter"):
            self.ends.setdefault(arc.status, (arc.reason, arc.transition))
        if arc.transition is None or len(arc.times) == 1:  # none, or at once: a sampled state made it so
            return
        self.events.setdefault(arc.transition, []).append((float(arc.times[-1]), arc.states[-1]))
        flow = machine.mode(arc.mode)
        number = [t.name for t in flow.transitions].index(arc.transition)
        measured = flow.guards[number].along(arc.times, arc.states[:, flow.states], flow.p)
        rates = np.abs(measured[:, 1])
        self.rates.setdefault(arc.transition, []).append(float(rates[-1] / max(rates.max(), 1e-300)))


def check_motions(
    report: Report, system: System, modes: Sequence[str], happenings: Sequence[Happening], samples: Samples
) -> Seen:
    """Follow motions from sampled states in some modes, and from states right before each transition."""
    seen, machine = Seen(), hybrid_machine(system, samples.parameters)
    for mode in modes:
        for t, x in zip(samples.times, samples.states, strict=True):
            _follow(seen, machine, float(t), x, mode, None, samples)
    for happening in happenings:
        if happening.transition.role != "watched":
            target = happening.transition.target
            for t, x in happening.before[:MOST_STARTS]:
                after = applied(machine, happening.transition, t, x)
                _follow(seen, machine, t, after, target, happening.transition.name, samples)
    _tell(report, system, seen)
    return seen


def _follow(
    seen: Seen, machine: HybridMachine, t: float, x: np.ndarray, mode: str, last: str | None, samples: Samples
) -> None:
    if not np.isfinite(x).all():
        return
    try:
        if last is None:
            past_zero(machine, t, x, mode, samples.scales)
    except StartError:  # a sampled state on the wrong side of a guard
        return
    motion = arcs(
        machine, t, x, mode, np.inf, TOLERANCE, samples.scales, just_after=last, most_steps=MOST_STEPS
    )
    for arc in islice(motion, MOST_ARCS):
        seen.add(machine, arc)
    seen.motions += 1


def _tell(report: Report, system: System, seen: Seen) -> None:
    what, before = "sample motions", len(report.findings)
    for transition in {t.name: t for t in system.acting}.values():
        rates = seen.rates.get(transition.name, [])
        typical = float(np.median(rates)) if rates else 1.0
        if typical < TRANSVERSAL:
            report.error(
                f"guard of transition '{transition.name}'",
                f"It reaches zero with a rate of {typical:.1g} of the largest on the way there, at the "
                f"{len(rates)} events of sample motions: it does not pass zero, it only comes to it. "
                "Return a number that passes zero evenly, as a distance does and its cube does not.",
                place_of(transition.guard),
            )
    if "sticking" in seen.ends:
        reason, name = seen.ends["sticking"]
        report.warning(what, f"One of them ends. {reason}", _place(system, name))
    met = {name: len(events) for name, events in seen.events.items()}
    if len(report.findings) > before:
        return
    if not met:
        report.ok(what, f"{seen.motions} motions from sampled states meet no transition.")
        return
    counted = ", ".join(f"{count} of '{name}'" for name, count in met.items())
    accumulate = " Transitions of some accumulate." if "chatter" in seen.ends else ""
    report.ok(what, f"{seen.motions} motions pass {counted}, each with a rate.{accumulate}")


def _place(system: System, name: str | None) -> tuple[str | None, int | None]:
    """Where the reset of a transition is, else its guard."""
    found: Sequence = [t for t in system.transitions if t.name == name]
    return place_of(found[0].reset or found[0].guard) if found else (None, None)

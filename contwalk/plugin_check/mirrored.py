"""Do declared symmetries take transitions to transitions: guards to guards, resets to resets?"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.flow.hybrid.machine import HybridMachine, hybrid_machine
from contwalk.plugin_check.findings import Report, place_of
from contwalk.plugin_check.modes import distinct_transitions
from contwalk.plugin_check.samples import Samples
from contwalk.problems.hybrid.mirrors import Span, beside, transition_carried
from contwalk.problems.orbit.itinerary import Leg
from contwalk.system import Symmetry, System, Transition


def check_mirrored(
    report: Report, symmetry: Symmetry, system: System, samples: Samples, period: float | None
) -> None:
    """Compare each transition at sampled states with the one that the symmetry takes it to.

    Where one is not taken to another, orbits are not closed up to the symmetry. Of a forced system all may be
    taken there half a period later.
    """
    acting = [each for each in distinct_transitions(system) if each.role != "watched"]
    shifts = [0.0] if period is None else [0.0, 0.5 * period]
    lost = [[each for each in acting if not _taken(symmetry, each, system, samples, s)] for s in shifts]
    best = min(lost, key=len)
    if not best:
        if acting:
            what = f"symmetry '{symmetry.name}'"
            report.ok(what, f"takes all {len(acting)} transitions to transitions.", place_of(symmetry.map))
        return
    later = shifts[lost.index(best)]
    for transition in best:
        _tell(report, symmetry, transition, system, samples, later)


def _tell(
    report: Report,
    symmetry: Symmetry,
    transition: Transition,
    system: System,
    samples: Samples,
    later: float,
) -> None:
    """What is wrong with the image of a transition, and which other one it would be."""
    source, name = transition.source, transition.name
    mode, event = symmetry.modes.get(source, source), symmetry.events.get(name, name)
    others = [each.name for each in system.leaving(mode) if each.role != "watched"]
    if event not in others:
        wrong = f"It takes transition '{name}' to '{event}', which does not lead out of mode '{mode}'"
    else:
        image = "itself" if event == name else f"'{event}'"
        wrong = f"It does not take transition '{name}' to {image}: guard or reset at the image differ"
    fitting = [
        each for each in others if _taken(_renamed(symmetry, name, each), transition, system, samples, later)
    ]
    remedy = "Correct the map, its `modes` and `events`, or remove the symmetry."
    if fitting:
        remedy = f"The image is '{fitting[0]}': declare events={{'{name}': '{fitting[0]}', ...}}."
    said = f"{wrong}. Orbits that meet it are not closed up to this symmetry. {remedy}"
    report.warning(f"symmetry '{symmetry.name}'", said, place_of(symmetry.map))


def _renamed(symmetry: Symmetry, name: str, image: str) -> Symmetry:
    return replace(symmetry, events={**symmetry.events, name: image})


def _taken(
    symmetry: Symmetry, transition: Transition, system: System, samples: Samples, later: float
) -> bool:
    """Whether guard and reset are taken to those of the image at all samples where they are finite."""
    machine = hybrid_machine(system, samples.parameters)
    leg = Leg(transition.source, transition)
    return all(
        transition_carried(machine, symmetry, Span(leg, t, x, 0.0, x), later, samples.scales)
        for t, x in zip(samples.times.tolist(), samples.states, strict=True)
        if _finite(machine, transition, t, x, samples.scales)
    )


def _finite(
    machine: HybridMachine, transition: Transition, t: float, x: np.ndarray, scale: np.ndarray
) -> bool:
    jump, c = machine.jump(transition)
    tried = beside(x, scale)[machine.mode(transition.source).states]
    return bool(np.isfinite(jump(0.0, np.concatenate([[t], tried]), c)).all())

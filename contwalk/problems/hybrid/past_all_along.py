"""Transitions that an orbit never makes although their guards are past zero all along it."""

from __future__ import annotations

import numpy as np

from contwalk.flow.hybrid.machine import hybrid_machine
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.margin_values import BELOW
from contwalk.problems.orbit.itinerary import imaged_leg
from contwalk.python_functions import line_aside
from contwalk.system import Transition


def past_all_along(problem: LimitedOrbit, z: np.ndarray) -> str:
    """A sentence on such transitions; empty if there are none. z has the shape (N + 1,)."""
    found = _never_armed(problem, z)
    return " ".join(_sentence(transition) for transition in found)


def _sentence(transition: Transition) -> str:
    return (
        f"'{transition.name}' never happens here though its guard is past zero all along the first orbit"
        f"{line_aside(transition.guard)}: the start lies beyond it, or a reset leads there. An edge "
        "happens where its guard passes zero. Declare level=True if it should happen at once where the guard "
        "is past zero; else start on the other side, or mend the reset."
    )


def _never_armed(problem: LimitedOrbit, z: np.ndarray) -> list[Transition]:
    """Edges that act and are past zero wherever the orbit is in their modes."""
    there, own = problem.explicit(z)
    system, machine = there.system, hybrid_machine(there.system, there.values_of(own))
    legs = there.itinerary.legs
    if there.itinerary.image:
        legs = (*legs, *(imaged_leg(system, there.itinerary.image, leg) for leg in legs))
    happens = {leg.name for leg in legs}
    past: dict[str, list[tuple[Transition, bool]]] = {}
    for leg, stretch in zip(legs, problem.stretches(z), strict=True):
        if leg.collapsed:
            continue
        flow = machine.mode(leg.mode)
        for transition, guard in zip(flow.transitions, flow.guards, strict=True):
            edge = transition.role == "hard" and transition.direction != "both" and not transition.level
            if not edge or transition.name in happens or guard.code.of_time_alone:
                continue
            times, states = stretch.motion
            values = guard.along(times, states[:, flow.states], flow.p)[:, 0]
            beyond = values if transition.direction == "rising" else -values
            is_past = bool(beyond.min() > BELOW * np.abs(values).max())
            past.setdefault(transition.name, []).append((transition, is_past))
    return [each[0][0] for each in past.values() if all(is_past for _, is_past in each)]

"""Declared neutral directions of a hybrid machine: along which of them do motions come in families?

A generator v is neutral if the field carries it along, Df v = Dv f, and each transition takes it to itself
(or, with a mirror, to its opposite) and leaves the event where it is. All derivatives are exact.
"""

from __future__ import annotations

import numpy as np

from contwalk.flow.compiled.traced import generator_field
from contwalk.flow.hybrid.machine import HybridMachine
from contwalk.problems.hybrid.hybrid_recurrence import HybridRecurrence
from contwalk.problems.neutral import directions
from contwalk.system import Neutral, Transition

# Both sides agree to this part of the size of their terms; a direction that vanishes but for this has none.
NEUTRAL, VANISHES = 1e-10, 1e-9
# Directions that differ by less are one.
DEPENDENT = 1e-6


def active(machine: HybridMachine, recurrence: HybridRecurrence) -> list[Neutral]:
    """The generators that are neutral along a recurrence, without those that depend on earlier ones."""
    found: list[Neutral] = []
    scale = recurrence.magnitudes
    for neutral in machine.system.neutral:
        given = machine, neutral, recurrence
        if not all(_carried(*given, k) and _passed(*given, k) for k in range(len(recurrence.stretches))):
            continue
        together = directions(
            machine.system, [*found, neutral], recurrence.stretches[0].state, machine.parameters
        )
        sizes = np.linalg.svd(together / scale[:, None], compute_uv=False)
        if sizes[-1] > DEPENDENT * sizes[0]:
            found.append(neutral)
    return found


def commutes(
    machine: HybridMachine, neutral: Neutral, mode: str, t: float, x: np.ndarray, scale: np.ndarray
) -> bool:
    """Whether the field of a mode carries a generator along, at a state and at one beside it.

    x and scale have the shape (n,).
    """
    flow = machine.mode(mode)
    generator, states = generator_field(machine.system, neutral, mode), flow.states
    c = generator.constants(machine.p)
    own = scale[states]
    for share in (0.0, 0.1):
        y = x[states] + share * own * np.cos(np.arange(1.0, len(states) + 1.0))
        v, f = generator(t, y, c), flow.field(t, y, flow.c)
        size = float(np.max(np.abs(v) / own, initial=0.0))
        if not (np.isfinite(size) and size > VANISHES):
            return False
        by = flow.field.jacobian(t, y, flow.c)[:, : len(y)]
        apart = by @ v - generator.jacobian(t, y, c)[:, : len(y)] @ f
        terms = np.abs(by) @ own * size + np.abs(f)
        if not np.all(np.abs(apart) <= NEUTRAL * terms):
            return False
    return True


def broken_by_events(machine: HybridMachine, recurrence: HybridRecurrence) -> dict[str, Transition]:
    """Generators that all fields of a recurrence carry along, by name, with the first event that breaks each
    one.
    """
    found: dict[str, Transition] = {}
    for neutral in machine.system.neutral:
        if not all(_carried(machine, neutral, recurrence, k) for k in range(len(recurrence.stretches))):
            continue
        legs = [stretch.leg for stretch in recurrence.stretches]
        broken = (
            leg.transition for k, leg in enumerate(legs) if not _passed(machine, neutral, recurrence, k)
        )
        first = next(broken, None)
        if first is not None:
            found[neutral.name] = first
    return found


def _carried(machine: HybridMachine, neutral: Neutral, recurrence: HybridRecurrence, k: int) -> bool:
    """Whether the field of a stretch carries a generator along."""
    stretch = recurrence.stretches[k]
    return commutes(machine, neutral, stretch.leg.mode, stretch.start, stretch.state, recurrence.magnitudes)


def _passed(machine: HybridMachine, neutral: Neutral, recurrence: HybridRecurrence, k: int) -> bool:
    """Whether the transition that ends a stretch, if one does, takes a generator to itself."""
    stretch, scale = recurrence.stretches[k], recurrence.magnitudes
    mode, transition = stretch.leg.mode, stretch.leg.transition
    if transition is None:
        return True
    before, after = machine.mode(mode), machine.mode(transition.target)
    t, x = stretch.start + stretch.duration, stretch.end[before.states]
    jump, constants = machine.jump(transition)
    given = np.concatenate([[t], x])
    slopes = jump.jacobian(0.0, given, constants)[:, 1 : 1 + len(x)]
    landed = jump(0.0, given, constants)[:-1]
    v = directions(machine.system, [neutral], machine.full(mode, x), machine.parameters)[:, 0]
    there = machine.full(transition.target, landed)
    w = directions(machine.system, [neutral], there, machine.parameters)
    moved, expected = slopes @ v[before.states], w[after.states, 0]
    size = float(np.max(np.abs(v) / scale))
    terms = np.abs(slopes) @ scale[before.states] * size
    kept = min(
        float(np.max(np.abs(moved[:-1] - sign * expected) - NEUTRAL * (terms[:-1] + np.abs(expected))))
        for sign in (1.0, -1.0)
    )
    return kept <= 0.0 and abs(moved[-1]) <= NEUTRAL * terms[-1]

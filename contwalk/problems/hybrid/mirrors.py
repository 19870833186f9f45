"""Whether a declared symmetry takes motions to motions, some time later, tried where an orbit passes.

Of a forced machine the image may be a motion only half a period later: the forcing is reversed then. So an
orbit that meets its own image may be continued as half of a cycle only where the machine is, after that time,
its own image too.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from contwalk.flow.hybrid.machine import HybridMachine, hybrid_machine
from contwalk.problems.forcing import period_at
from contwalk.problems.orbit.closure import imaged
from contwalk.problems.orbit.itinerary import Leg, has_image, image_of
from contwalk.system import Symmetry, System
from contwalk.system.declarations import ParameterValues

# Both sides agree to this part of their size: the map's derivative is made of differences over such a step
# and twice as much, and known to its fourth power and to what rounding makes of it.
SAME, STEP = 1e-8, 1e-3
# How far from the orbit, in units of its variation, and how far into each leg it is tried.
OFF, INTO = 0.1, 0.3


@dataclass(frozen=True, eq=False)
class Span:
    """A leg as it was passed: when and where it starts, how long it lasts, and where its event finds it.

    `state` is the one at its start, `end` the one before the event.

    Both have the shape (n,).
    """

    leg: Leg
    start: float
    state: np.ndarray
    duration: float
    end: np.ndarray


def carries(
    system: System,
    values: Sequence[Mapping[str, float]],
    symmetry: Symmetry,
    spans: Sequence[Span],
    periods: float,
    scale: np.ndarray,
) -> bool:
    """Whether fields, guards and resets along some legs are their own images so many forcing periods on.

    Asked of several values of the parameters, the orbit's own first: where a force has no amplitude they are
    whatever the symmetry says of it. `scale` has the shape (n,).
    """
    for given in values:
        machine = hybrid_machine(system, given)
        later = periods * period_at(system, given) if periods else 0.0
        if any(why_not_carried(machine, symmetry, span, later, scale) for span in spans):
            return False
    return True


def why_not_carried(
    machine: HybridMachine, symmetry: Symmetry, span: Span, later: float, scale: np.ndarray
) -> str:
    """What of a leg is not its own image `later` seconds on; empty where all is.

    `scale` has the shape (n,).
    """
    if not field_carried(machine, symmetry, span, later, scale):
        return f"the field of mode '{span.leg.mode}'"
    if not transition_carried(machine, symmetry, span, later, scale):
        return f"transition '{span.leg.name}'"
    return ""


def beside(x: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """A state off a given one in all directions: where a leg begins or ends something may be zero.

    All have the shape (n,).
    """
    return x + OFF * scale * np.cos(np.arange(1.0, len(x) + 1.0))


def _close(a: np.ndarray, b: np.ndarray, rounding: float = 0.0) -> bool:
    """Whether two vectors agree, but for a rounding; what is not finite agrees with nothing."""
    size = max(float(np.linalg.norm(a)), float(np.linalg.norm(b)))
    return bool(np.linalg.norm(a - b) <= SAME * size + rounding) if np.isfinite(size) else False


def field_carried(
    machine: HybridMachine, symmetry: Symmetry, span: Span, later: float, scale: np.ndarray
) -> bool:
    """Whether the field is carried, tried near the start of a leg. `scale` has the shape (n,)."""
    mode = span.leg.mode
    here, there = machine.mode(mode), machine.mode(symmetry.modes.get(mode, mode))
    p, t = ParameterValues(**machine.parameters), span.start + INTO * span.duration
    x = machine.existing(mode, beside(span.state, scale))
    rate = machine.full(mode, here.field(t, x[here.states], here.c))
    size = float(np.linalg.norm(rate / scale)) or 1.0
    if not np.isfinite(size):
        return False
    step, moved = STEP / size, np.zeros(len(x))
    for share, weight in ((1.0, 8.0), (2.0, -1.0)):
        ahead, behind = (imaged(symmetry, x + way * share * step * rate, p) for way in (1.0, -1.0))
        moved += weight * (ahead - behind) / (12.0 * step)
    image, own = imaged(symmetry, x, p)[there.states], scale[there.states]
    # A machine far from where its states are zero: differences of its places are rounded as these are.
    rounding = 4.0 * np.finfo(float).eps * float(np.linalg.norm(image / own)) / step
    rate_there = there.field(t + later, image, there.c)
    return _close(moved[there.states] / own, rate_there / own, rounding)


def transition_carried(
    machine: HybridMachine, symmetry: Symmetry, span: Span, later: float, scale: np.ndarray
) -> bool:
    """Whether reset and guard are carried: a guard may be the other's negative, if it is passed that way.

    `scale` has the shape (n,).
    """
    if span.leg.transition is None:
        return True
    if not has_image(machine.system, symmetry, span.leg):
        return False
    one, other = span.leg.transition, image_of(machine.system, symmetry, span.leg).transition
    assert other is not None
    p, t = ParameterValues(**machine.parameters), span.start + span.duration
    before, after = machine.mode(one.source).states, machine.mode(one.target).states
    x = machine.existing(one.source, beside(span.end, scale))
    jump, c = machine.jump(one)
    landed = jump(0.0, np.concatenate([[t], x[before]]), c)
    source, target = machine.mode(other.source).states, machine.mode(other.target).states
    jump, c = machine.jump(other)
    image = jump(0.0, np.concatenate([[t + later], imaged(symmetry, x, p)[source]]), c)
    full = np.zeros(len(scale))
    full[after] = landed[:-1]
    expected = imaged(symmetry, full, p)[target]
    alike = abs(abs(landed[-1]) - abs(image[-1])) <= SAME * abs(landed[-1])
    return bool(alike) and _close(expected / scale[target], image[:-1] / scale[target])

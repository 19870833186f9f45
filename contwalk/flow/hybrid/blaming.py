"""The line of a plugin at which a motion ceases to exist."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from contwalk.errors import NO_LINE
from contwalk.fields.blame import first_nearly_singular, first_switched
from contwalk.flow.hybrid.event_integrator import METHOD
from contwalk.flow.hybrid.functions_without_value import functions_of, line_without_value
from contwalk.flow.hybrid.machine import HybridMachine, ModeFlow
from contwalk.flow.hybrid.motion_segment import MotionSegment
from contwalk.flow.integrate import along
from contwalk.system import Transition

# Steps that look what has no value beyond the end of a motion, each ten times as long as the one before.
SHARES = tuple(10.0**k for k in range(-12, -2))
# Newton's steps onto a guard.
TRIALS = 20
# The last steps of a motion, and how much longer the next one is made, to see what keeps them short.
LATELY, FURTHER = 40, (1e2, 1e4, 1e6)


def why_not_finite(
    machine: HybridMachine,
    mode: str,
    t: float,
    x: np.ndarray,
    landing: tuple[Transition, np.ndarray] | None = None,
) -> str:
    """As `line_without_value`, of what moves the machine at a state: its field, and guards that act.

    The state has shape (n,), of full length. Where a transition has just led there, from the
    state that comes with it, its reset is asked first.
    """
    system = machine.system
    if landing is not None and landing[0].reset is not None:
        transition, before = landing
        reset: Mapping[str, Any] = {f"reset of transition '{transition.name}'": transition.reset}
        found = line_without_value(system, transition.source, reset, t, before, machine.parameters)
        if found:
            return found
    if not np.isfinite(x).all():
        return ""
    return line_without_value(system, mode, functions_of(system, mode), t, x, machine.parameters)


def why_not_reached(machine: HybridMachine, transition: Transition, segment: MotionSegment) -> str:
    """As `line_without_value`, of a field that is finite up to an event, and not where its guard is zero.

    A quotient may be 0/0 just there: the last finite state is moved along the field onto the guard.
    """
    finite = np.flatnonzero(np.isfinite(segment.states).all(axis=1))
    if not len(finite) or finite[-1] == len(segment.states) - 1:
        return ""
    flow, system = machine.mode(segment.mode), machine.system
    guard = flow.guards[flow.transitions.index(transition)]
    t, y = float(segment.times[finite[-1]]), segment.states[finite[-1]][flow.states]
    field = {f"field of mode '{segment.mode}'": system.mode(segment.mode).field}
    for _ in range(TRIALS):
        value, rate, _ = guard(t, y, flow.p).tolist()
        step = -value / rate if rate else 0.0
        t, y = t + step, y + step * flow.field(t, y, flow.c)
        found = line_without_value(
            system, segment.mode, field, t, machine.full(segment.mode, y), machine.parameters
        )
        if found or not np.isfinite(y).all():
            return found
    return ""


def nearly_singular(machine: HybridMachine, mode: str, t: float, x: np.ndarray) -> str:
    """As `line_without_value`, of a matrix of the field that becomes singular at x, shape (n,)."""
    known = {**machine.parameters, **machine.system.mode(mode).constants}
    function = machine.system.mode(mode).field
    found = first_nearly_singular(function, t, np.asarray(x, dtype=float).tolist(), known)
    return "" if found is None else f" The field of mode '{mode}': {found}."


def what_jumps(machine: HybridMachine, segment: MotionSegment) -> str:
    """` The NAME chooses otherwise there: file, line n (what).` of what keeps the last steps short.

    The field of the segment's mode, or a guard out of it; empty if all are on one smooth piece.
    """
    if not machine.mode(segment.mode).code.chooses:
        return ""
    functions = functions_of(machine.system, segment.mode)
    known = {**machine.parameters, **machine.system.mode(segment.mode).constants}
    places = list(zip(segment.times[-LATELY:].tolist(), segment.states[-LATELY:].tolist(), strict=True))
    places += _ahead(machine, segment)
    for name, function in functions.items():
        for before, after in pairwise(places):
            where = first_switched(function, before, after, known)
            if where != NO_LINE:
                return f" The {name} is smooth by pieces only, and chooses another one there: {where}."
    return ""


def _ahead(machine: HybridMachine, segment: MotionSegment) -> Iterator[tuple[float, list[float]]]:
    """Where the last step leads if it is far longer: short steps may not come to what keeps them short."""
    flow = machine.mode(segment.mode)
    t, y = float(segment.times[-1]), segment.states[-1][flow.states]
    rate, last = flow.field(t, y, flow.c), t - float(segment.times[-2])
    for further in FURTHER:
        yield t + further * last, machine.full(segment.mode, y + further * last * rate).tolist()


@dataclass(frozen=True, eq=False)
class Beyond:
    """Where a motion has ceased to exist.

    Parameters
    ----------
    at : tuple
        Time, and state of full length.
    guard : str, optional
        The transition whose guard has no value there; None where the field has none.
    """

    at: tuple[float, np.ndarray]
    guard: str | None


def just_beyond(
    machine: HybridMachine, flow: ModeFlow, t: float, x: np.ndarray, span: float
) -> Beyond | None:
    """What has no value right after an instant at which a motion ends; None if all have.

    The field alone goes on from x, shape (n,), by small shares of `span`, the time in which states change by
    their magnitudes.
    """
    for share in SHARES:
        times = np.array([t, t + share * span])
        y = along(flow.field, flow.c, times, x[flow.states], METHOD)[-1]
        if not np.isfinite(y).all():  # the field has no value within the step: look where it leads
            y = x[flow.states] + share * span * flow.field(t, x[flow.states], flow.c)
        if not np.isfinite(y).all():
            return None
        at = float(times[-1]), machine.full(flow.name, y[None])[0]
        if not np.isfinite(flow.field(at[0], y, flow.c)).all():
            return Beyond(at, None)
        for number, guard in enumerate(flow.guards):
            if not np.isfinite(guard(at[0], y, flow.p)[0]):
                return Beyond(at, flow.transitions[number].name)
    return None


def guard_without_rate(flow: ModeFlow, t: float, x: np.ndarray) -> Transition | None:
    """The transition whose guard has a value at x, shape (n,), but no derivative; None if all have."""
    for transition, guard in zip(flow.transitions, flow.guards, strict=True):
        value, rate, _ = guard(t, x[flow.states], flow.p).tolist()
        if np.isfinite(value) and not np.isfinite(rate):
            return transition
    return None

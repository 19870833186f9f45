"""A segment by any method, with everything watched: a path, then the crossings on it.

The guards are integrated beside the states, so that control of their errors resolves them too: the field
alone may allow steps through many of their turns.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from contwalk.flow.events.crossings import Crossing, Event, crossings
from contwalk.flow.events.guard import EPSILON
from contwalk.flow.hybrid.guard_status import GuardStatus, leaving_zero
from contwalk.flow.hybrid.machine import HybridMachine, ModeFlow
from contwalk.flow.hybrid.motion_segment import (
    FAR,
    Control,
    MotionSegment,
    at_once_too_fast,
    far,
    part_of,
    why,
)
from contwalk.flow.integrate import along, controlled
from contwalk.flow.path import ErrorControl

FIRST_STEPS, STEPS_AT_ONCE = 12, 50

# Events whose instants differ by less than so many roundings coincide.
COINCIDE = 8.0

# Errors of guards are at most this part of what typical changes of the states make of them: with larger ones
# their turns would not be resolved.
RESOLVED = 1e-4


def by_paths(
    machine: HybridMachine,
    flow: ModeFlow,
    t: float,
    x: np.ndarray,
    t1: float,
    control: Control,
    standing: Sequence[GuardStatus],
) -> Iterator[MotionSegment]:
    """Parts of a segment from a full-length state (n,) on; the last one has its transition, or a status."""
    y, weights, method = x[flow.states], control.weights[flow.states], control.method
    leaving = leaving_zero(standing)
    resolving = flow.code.resolving
    c, n = flow.constants(resolving), len(y)
    span = far(flow, t, y, weights) / FAR
    scales = flow.scales(t, y, weights, span) * min(1.0, RESOLVED / control.tolerance)
    sizes, most = np.concatenate([weights, scales]), FIRST_STEPS
    while t < t1:
        end = t1 if np.isfinite(t1) else t + far(flow, t, y, weights)
        if not end > t:
            yield at_once_too_fast(flow, t, machine.full(flow.name, y))
            return
        instant, still = (np.array([t]), y[None], flow.p), np.zeros((1, n))
        values = [guard.along(*instant, still)[0, 0] for guard in flow.guards]
        start = np.concatenate([y, values])
        path = controlled(resolving, c, t, start, end, ErrorControl(control.tolerance, sizes, most), method)
        times = path.times
        states = along(flow.field, flow.c, times, y, method)
        assert states.shape[1] == n
        found = crossings(flow.field, flow.c, flow.p, times, states, flow.guards, method, leaving)
        acting = [crossing for crossing in found if flow.acting(crossing.guard)]
        first = _first(acting)
        if first is not None:
            times = np.append(times[: first.step + 1], first.time)
            states = np.append(states[: first.step + 1], first.state[None], axis=0)
            if times[-1] == times[-2]:
                times, states = np.delete(times, -2), np.delete(states, -2, axis=0)
        seen = [event_of(machine, flow, at) for at in _seen(flow, found, first)] if control.watched else []
        part = part_of(machine, flow, times, states, seen, path.evaluations)
        if first is not None:
            yield replace(part, transition=flow.transitions[first.guard].name, rising=first.rising)
            return
        if path.status not in ("ok", "too_many_steps"):
            yield replace(part, status=path.status, reason=why(flow, path.status, float(times[-1])))
            return
        yield part
        t, y, leaving, most = float(times[-1]), states[-1], {}, STEPS_AT_ONCE


def _first(acting: Sequence[Crossing]) -> Crossing | None:
    """The earliest; of those that coincide with it the one declared first."""
    if not acting:
        return None
    earliest = acting[0].time
    room = COINCIDE * EPSILON * abs(earliest)
    return min((each for each in acting if each.time <= earliest + room), key=lambda each: each.guard)


def _seen(flow: ModeFlow, found: Sequence[Crossing], first: Crossing | None) -> list[Crossing]:
    """Crossings of watched transitions, up to the one that ends the segment."""
    end = np.inf if first is None else first.time
    return [at for at in found if not flow.acting(at.guard) and at.time <= end]


def event_of(machine: HybridMachine, flow: ModeFlow, at: Crossing) -> Event:
    """A crossing of a watched transition as an event."""
    state = machine.full(flow.name, at.state)
    return Event(flow.transitions[at.guard].name, at.time, at.rising, state, state, flow.name)

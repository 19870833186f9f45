"""Guards that jump at instants of time: what happens there, and how a motion comes to them and goes on.

A jump through zero in the direction of a transition is its event, at the first instant after it. What follows
at the same instant follows at once, as it does for guards that pass zero evenly.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from contwalk.flow.events.crossings import Event
from contwalk.flow.events.jump_instants import JumpInstant, room
from contwalk.flow.hybrid.clocks import Clocks
from contwalk.flow.hybrid.guard_status import ROUNDINGS
from contwalk.flow.hybrid.machine import HybridMachine, ModeFlow
from contwalk.flow.hybrid.motion_segment import MotionSegment, part_of
from contwalk.flow.integrate import along
from contwalk.system import Transition


def next_jump(flow: ModeFlow, t: float, *, goes_on: bool) -> JumpInstant | None:
    """The next instant at which guards of a mode jump: not the one at t itself, unless a motion goes on from
    there.
    """
    if flow.jump_instants is None:
        return None
    return flow.jump_instants.after(t, t if goes_on else t + room(t))


def jumping(
    flow: ModeFlow, t: float, x: np.ndarray, clocks: Clocks, *, goes_on: bool
) -> tuple[int, bool] | None:
    """The transition that acts and whose guard jumps through zero at t, with a state of shape (n,), and
    whether it rises.

    None if there is none, or it has happened there. Where a motion goes on from before, it may be one whose
    guard passes zero evenly just there: right after an event such a guard has been looked at.
    """
    jump = None if flow.jump_instants is None else flow.jump_instants.at(t)
    if jump is None:
        return None
    happening = (each for each in _through_zero(flow, jump, x, evenly=goes_on) if flow.acting(each[0]))
    return next((each for each in happening if not clocks.has_passed(t, flow.guards[each[0]])), None)


def jumps_there(flow: ModeFlow, transition: Transition, t: float, x: np.ndarray) -> bool:
    """Whether the event of a transition out of a mode, at t and a state of shape (n,), is a jump."""
    jump = None if flow.jump_instants is None else flow.jump_instants.at(t)
    return jump is not None and any(
        flow.transitions[i] is transition for i, _ in _through_zero(flow, jump, x)
    )


def over(
    machine: HybridMachine, flow: ModeFlow, jump: JumpInstant, before: MotionSegment, method: str
) -> MotionSegment:
    """The step over a jump from where a segment has come to; what is watched is told."""
    times = np.array([before.times[-1], jump.high])
    states = along(flow.field, flow.c, times, before.states[-1][flow.states], method)
    full = machine.full(flow.name, states[-1])
    seen = [
        Event(flow.transitions[i].name, jump.high, rises, full, full, flow.name)
        for i, rises in _through_zero(flow, jump, full, evenly=True)
        if not flow.acting(i)
    ]
    return part_of(machine, flow, times, states, seen, 0)


def _through_zero(
    flow: ModeFlow, jump: JumpInstant, x: np.ndarray, *, evenly: bool = False
) -> Iterator[tuple[int, bool]]:
    """The guards that jump through zero in their direction, or pass it there, and whether they rise."""
    times, y = np.array([jump.low, jump.high]), x[flow.states]
    velocities = flow.field.along(times, np.stack([y, y]), flow.c)
    beside = 0.5 * room(jump.high) * np.array([-1.0, 1.0])
    around = times + beside, y + beside[:, None] * velocities
    for i, guard in enumerate(flow.guards):
        values, rates, noise = guard.along(times, np.stack([y, y]), flow.p, velocities).T
        least = ROUNDINGS * float(noise.max()) + 2.0 * float(np.abs(rates).max()) * (jump.high - jump.low)
        if not abs(values[1] - values[0]) > least:
            if not evenly:
                continue
            values = guard.along(*around, flow.p, velocities)[:, 0]
        before, after = values.tolist()
        rises = after > before
        if before * after < 0.0 and guard.direction in (0, 1 if rises else -1):
            yield i, rises

"""Which events have happened at an instant, where others follow at the same one.

A guard of time alone is the same after any reset, and in any mode: what it does at an instant it does once,
whatever follows at the same instant. So is the jump of a guard at an instant. Any other guard that has been
passed, and goes on through zero, has been passed until what follows turns it back.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contwalk.fields.llvm import Code
from contwalk.flow.events.guard import EPSILON, JUST_AFTER, Guard
from contwalk.flow.events.jump_instants import room
from contwalk.flow.hybrid.guard_status import PASSED, GuardStatus
from contwalk.flow.hybrid.machine import ModeFlow

# Roundings of a period within which the event of a clock that a motion begins right after may lie ahead.
AHEAD = 64.0


class Clocks:
    """Told of each transition; knows the guards that have passed zero at this instant.

    Parameters
    ----------
    t : float
        Where the motion begins.
    """

    def __init__(self, t: float) -> None:
        self._instant = t
        self._passed: list[Code] = []
        self._through: list[Code] = []

    def record(self, t: float, flow: ModeFlow, name: str) -> None:
        """A transition out of a mode happens."""
        if abs(t - self._instant) > room(t):
            self._through = []
        if t != self._instant:
            self._instant, self._passed = t, []
        self._passed += [
            guard.code.guard
            for transition, guard in zip(flow.transitions, flow.guards, strict=True)
            if transition.name == name
        ]

    def happened(self, t: float, flow: ModeFlow) -> frozenset[str]:
        """Transitions out of a mode whose guards are among them."""
        if t != self._instant or not self._passed:
            return frozenset()
        return frozenset(
            transition.name
            for transition, guard in zip(flow.transitions, flow.guards, strict=True)
            if guard.code.of_time_alone and self.has_passed(t, guard)
        )

    def has_passed(self, t: float, guard: Guard) -> bool:
        """Whether a guard has passed zero at an instant."""
        return t == self._instant and any(guard.code.guard is code for code in self._passed)

    def gone_through(self, flow: ModeFlow) -> frozenset[str]:
        """Transitions out of a mode whose guards have been passed at this instant, and not turned back."""
        each = zip(flow.transitions, flow.guards, strict=True)
        return frozenset(t.name for t, guard in each if guard.code.guard in self._through)

    def stand(self, flow: ModeFlow, standing: Sequence[GuardStatus]) -> None:
        """The guards of a mode stand like this right after what has happened."""
        each = zip(flow.guards, standing, strict=True)
        self._through = [guard.code.guard for guard, now in each if now.kind == PASSED]


def right_after(flow: ModeFlow, t: float, last: str) -> float:
    """The instant at which a motion begins right after a transition into a mode: a clock's not before it.

    Instants of an orbit are known to roundings of its period, those of the machine to roundings of the time:
    near t = 0 the event that a motion begins after may seem to be still ahead.
    """
    for transition, guard in zip(flow.transitions, flow.guards, strict=True):
        period = flow.period if transition.name == last and guard.code.of_time_alone else None
        if period is None:
            continue
        value, rate, _ = guard(t, np.zeros(len(flow.states)), flow.p).tolist()
        ahead = -value / rate if rate else 0.0
        if 0.0 < ahead <= AHEAD * EPSILON * period:
            return t + ahead + JUST_AFTER * EPSILON * period
    return t

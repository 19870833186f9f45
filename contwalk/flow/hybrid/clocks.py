"""Events at given times: which of them have happened at an instant.

A guard of time alone is the same after any reset, and in any mode: what it does at an instant it does once,
whatever follows at the same instant. So is the jump of a guard at an instant.
"""

from __future__ import annotations

from contwalk.fields.llvm import Code
from contwalk.flow.events.guard import Guard
from contwalk.flow.hybrid.machine import ModeFlow


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

    def record(self, t: float, flow: ModeFlow, name: str) -> None:
        """A transition out of a mode happens."""
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

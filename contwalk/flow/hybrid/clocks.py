"""Events at given times: which of them have happened at an instant.

A guard of time alone is the same after any reset, and in any mode: what it does at an instant it does once,
whatever follows at the same instant.
"""

from __future__ import annotations

from contwalk.fields.llvm import Code
from contwalk.flow.hybrid.machine import ModeFlow


class Clocks:
    """Told of each transition; knows the guards of time alone that have passed zero at this instant.

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
            if transition.name == name and guard.code.of_time_alone
        ]

    def happened(self, t: float, flow: ModeFlow) -> frozenset[str]:
        """Transitions out of a mode whose guards are among them."""
        if t != self._instant or not self._passed:
            return frozenset()
        return frozenset(
            transition.name
            for transition, guard in zip(flow.transitions, flow.guards, strict=True)
            if guard.code.of_time_alone and any(guard.code.guard is code for code in self._passed)
        )

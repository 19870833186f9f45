"""Maps: a mode of kind `map` writes the next state.

An iterate is an event that a clock brings at each unit of time, with nothing moving in between: fixed points
and cycles, their special points, curves and normal forms are those of orbits through such events.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from contwalk.errors import SystemDefinitionError
from contwalk.signatures import ITERATE
from contwalk.system.modes import ITERATED, Transition

if TYPE_CHECKING:
    from contwalk.system.declared import Declared


def rests(t: Any, x: Any, p: Any, dx: Any) -> None:
    """Nothing moves between two iterates."""
    for i in range(len(dx)):
        dx[i] = 0.0


def clock(t: Any, x: Any, p: Any) -> Any:
    """Rises through zero at each whole number of iterates."""
    return np.sin(2.0 * math.pi * t)


def one_iterate(p: Any) -> float:
    """What an orbit's period is told in."""
    return 1.0


def iterated(system: Declared) -> None:
    """Make the machine of a system whose only mode is a map; others are left as they are.

    Raises
    ------
    SystemDefinitionError
        For a map that has what belongs to flows, and a flow that has an event of the name of an iterate.
    """
    kinds = [mode.kind for mode in system.modes]
    if not any(kind in ("map", ITERATED) for kind in kinds):
        if any(transition.name == ITERATE for transition in system.transitions):
            raise SystemDefinitionError(
                f"System '{system.name}' calls a transition '{ITERATE}', as contwalk calls a step of a map.",
                "Rename it.",
            )
        return
    if kinds == [ITERATED]:
        return
    if len(kinds) > 1:
        raise SystemDefinitionError(
            f"System '{system.name}' has a map among {len(kinds)} modes.",
            "A map is the only mode of a system.",
        )
    taken = ("transitions", "period", "conserved", "neutral")
    for what in taken:
        if getattr(system, what):
            raise SystemDefinitionError(
                f"System '{system.name}' is a map and has {what}.", f"Maps have none: leave {what} out."
            )
    (mode,) = system.modes
    if mode.states is not None:
        raise SystemDefinitionError(
            f"Map '{mode.name}' has states of its own.", "It has all of the system: leave states out."
        )
    step = Transition(ITERATE, mode.name, mode.name, clock, "rising", reset=mode.field, about=mode.about)
    object.__setattr__(system, "modes", (replace(mode, field=rests, kind=ITERATED),))
    object.__setattr__(system, "transitions", (step,))
    object.__setattr__(system, "period", one_iterate)

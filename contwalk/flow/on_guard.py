"""Whether a state that is said to be the one right before a transition is on its guard."""

from __future__ import annotations

import numpy as np

from contwalk.errors import StartError
from contwalk.flow.departure import AFTER_RESET
from contwalk.flow.hybrid_machine import HybridMachine
from contwalk.system import Transition

# How far a guard may be from zero, as a part of what typical changes of the states move it by: states are
# given with a few digits.
OFF = 0.02


def check_on_guard(
    machine: HybridMachine, happening: Transition, t: float, x: np.ndarray, weights: np.ndarray
) -> None:
    """Whether a transition may happen at a state.

    Parameters
    ----------
    x, weights : ndarray
        The state and typical magnitudes, of full length.

    Raises
    ------
    StartError
        If its guard is not zero there, as far as the state is known.
    """
    flow = machine.mode(happening.source)
    guard = flow.guards[[each.name for each in flow.transitions].index(happening.name)]
    own = np.asarray(x, dtype=float)[flow.states]
    slopes = guard.slopes(t, own, flow.p, flow.field(t, own, flow.c))
    typical = float(np.abs(slopes.gradient[1:]) @ weights[flow.states])
    # What is not finite is refused where the motion begins, with the plugin's line.
    if not abs(slopes.value) > max(AFTER_RESET * slopes.rounding, OFF * typical):
        return
    raise StartError(
        f"The state is not one right before '{happening.name}' (at: {happening.name}): the guard of that "
        f"transition is {slopes.value:.6g} there, and not zero.",
        f"Give a state on the guard, or leave out at: {happening.name} to begin in mode '{happening.source}' "
        "and let it happen where the motion meets its guard.",
    )

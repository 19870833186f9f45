"""Whether a state that is said to be the one right before a transition is on its guard, and passes it."""

from __future__ import annotations

import numpy as np

from contwalk.errors import StartError
from contwalk.flow.events.guard import EPSILON
from contwalk.flow.hybrid.guard_status import AFTER_RESET
from contwalk.flow.hybrid.machine import HybridMachine
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
        If its guard is not zero there, as far as the state is known, or passes zero the other way.
    """
    flow = machine.mode(happening.source)
    guard = flow.guards[[each.name for each in flow.transitions].index(happening.name)]
    own = np.asarray(x, dtype=float)[flow.states]
    velocity = flow.field(t, own, flow.c)
    slopes = guard.slopes(t, own, flow.p, velocity)
    typical = float(np.abs(slopes.gradient[1:]) @ weights[flow.states])
    # What is not finite is refused where the motion begins, with the plugin's line.
    if not abs(slopes.value) > max(AFTER_RESET * slopes.rounding, OFF * typical):
        _check_direction(happening, guard.direction, slopes.gradient * np.append(1.0, velocity))
        return
    raise StartError(
        f"The state is not one right before '{happening.name}' (at: {happening.name}): the guard of that "
        f"transition is {slopes.value:.6g} there, and not zero.",
        f"Give a state on the guard, or leave out at: {happening.name} to begin in mode '{happening.source}' "
        "and let it happen where the motion meets its guard.",
    )


def _check_direction(happening: Transition, direction: int, shares: np.ndarray) -> None:
    """Refuse a state at which the guard's rate, the sum of these shares, is that of the way back."""
    rate = float(shares.sum())
    if rate * direction < 0.0 and abs(rate) > AFTER_RESET * EPSILON * float(np.abs(shares).sum()):
        raise StartError(
            f"The state is not one right before '{happening.name}' (at: {happening.name}): the guard of that "
            f"transition is zero there with a rate of {rate:.6g}, and the transition happens where it is "
            f"{happening.direction}.",
            "Give the state before the transition; of one after it, say the mode that it has led to in place "
            f"of at: {happening.name}.",
        )

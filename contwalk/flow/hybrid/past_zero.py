"""Guards that are past zero where a motion begins: no events, but often a mistake in the start."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from contwalk.errors import StartError
from contwalk.flow.events.guard import EPSILON
from contwalk.flow.hybrid.guard_status import BEYOND, GuardStatus, guard_statuses
from contwalk.flow.hybrid.machine import HybridMachine, ModeFlow
from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import parts

# So many steps are looked ahead for a guard to come back.
LOOK_AHEAD, TOLERANCE = 1000, 1e-6


def past_zero(
    machine: HybridMachine,
    t: float,
    x: np.ndarray,
    mode: str,
    weights: np.ndarray,
    ends: Collection[str] = (),
) -> str:
    """A sentence on guards that are past zero at a start, and so no events yet; empty if none is.

    Parameters
    ----------
    machine : HybridMachine
    t, x, mode
        Time, full-length state and mode of the start.
    weights : ndarray, shape (n,)
        Typical magnitudes of the states, of full length.
    ends : collection of str
        Transitions that are no events of the machine: they end its motions.

    Raises
    ------
    StartError
        If all transitions out of the mode that act are so, and none comes back soon: the motion meets none.
    """
    flow = machine.mode(mode)
    past = _past(flow, t, x, weights)
    acting = [i for i, each in enumerate(flow.transitions) if flow.acting(i) and each.name not in ends]
    if past and len(past) == len(acting) and not _come_back(machine, t, x, flow, weights, ends):
        number, guard = next(iter(past.items()))
        name = flow.transitions[number].name
        side = "positive" if guard.value < 0.0 else "negative"
        raise StartError(
            _sentence(name, guard).rstrip(".") + ", and it does not come back.",
            f"Start where it is {side}, or in another mode than '{mode}'. If the state is the one right "
            f"before the transition, say so: at: {name}.",
        )
    return " ".join(_sentence(flow.transitions[i].name, guard) for i, guard in past.items())


def _sentence(name: str, guard: GuardStatus) -> str:
    passes = "falls" if guard.value < 0.0 else "rises"
    return (
        f"The guard of transition '{name}' is {guard.value:.6g} at the start, past zero already: the "
        f"transition happens where it {passes} through zero."
    )


def _past(flow: ModeFlow, t: float, x: np.ndarray, weights: np.ndarray) -> dict[int, GuardStatus]:
    """The transitions that act and whose guards are past zero, but for those that happen at once there."""
    y = np.asarray(x, dtype=float)[flow.states]
    if not np.isfinite(y).all() or not np.isfinite(flow.field(t, y, flow.c)).all():
        return {}
    standing = guard_statuses(flow, t, y, EPSILON * np.abs(y), weights[flow.states])
    return {
        i: guard
        for i, guard in enumerate(standing)
        if guard.kind == BEYOND and flow.acting(i) and not flow.transitions[i].at_entry
        if not flow.guards[i].code.of_time_alone  # what happens at a given time has happened
    }


def _come_back(
    machine: HybridMachine,
    t: float,
    x: np.ndarray,
    flow: ModeFlow,
    weights: np.ndarray,
    ends: Collection[str],
) -> bool:
    """Whether one of the guards that are past zero is not so any more a little later."""
    steps, count = 0, len(_past(flow, t, x, weights))
    for part in parts(machine, t, x, flow.name, np.inf, Control(TOLERANCE, weights)):
        steps += len(part.times) - 1
        reached = float(part.times[-1]), part.states[-1]
        if part.transition in ends:
            return False
        if part.transition is not None or len(_past(flow, *reached, weights)) < count:
            return True
        if steps >= LOOK_AHEAD or part.status != "ok":
            return False
    return False

"""A pushed state brought into a mode in which the machine can be there.

What a push does to guards is not an event of the motion. Where a transition acts at entry (`level=True`), it
happens: a foot that a push has put below the ground stands on it. Modes that soft transitions join are one
mode of the machine, whose field has several pieces: of them the one is taken on whose side of the soft guards
the state is, and what acts at entry in any of them does. Where a guard that acts otherwise has been pushed
past zero, from the side on which it is on the motion, the machine cannot be there: a mass is behind its wall.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Iterator
from dataclasses import dataclass

import numpy as np

from contwalk.flow.hybrid.machine import HybridMachine, ModeFlow, applied
from contwalk.system import System, Transition

MOST_CHANGES = 64  # of the mode, after which the machine is said to have no mode there


@dataclass(frozen=True, eq=False)
class Place:
    """Mode and state, of full length, in which a motion sets out; `beyond` names a guard that forbids it."""

    mode: str
    state: np.ndarray
    beyond: str = ""


def placed(
    machine: HybridMachine,
    t: float,
    mode: str,
    unpushed: np.ndarray,
    pushed: np.ndarray,
    ends: Collection[str] = (),
) -> Place:
    """Where a motion sets out from a pushed state.

    Parameters
    ----------
    machine : HybridMachine
    t : float
    mode : str
        The one of the motion.
    unpushed, pushed : ndarray, shape (n,)
        The state on the motion, and what the push makes of it.
    ends : collection of str
        Transitions that end a motion and lead nowhere: they are left to it.
    """
    name, state = mode, machine.existing(mode, pushed)
    for _ in range(MOST_CHANGES):
        there = unpushed if name == mode else None
        following = next(_forced(machine, t, name, state, there, ends), None)
        if following is None:
            break
        name, state = following
    else:
        return Place(mode, pushed, "no mode is left to be in")
    beyond = _forbidden(machine, t, name, unpushed, state, ends) if name == mode else ""
    return Place(name, state, beyond)


def _forced(
    machine: HybridMachine,
    t: float,
    mode: str,
    state: np.ndarray,
    unpushed: np.ndarray | None,
    ends: Collection[str],
) -> Iterator[tuple[str, np.ndarray]]:
    """What happens at once to a state: first what acts at entry in the mode or one joined to it, then what is
    soft. `unpushed` is given in the mode in which the motion is."""
    for joined in _joined(machine.system, mode):
        flow = machine.mode(joined)
        for number, transition in enumerate(flow.transitions):
            acts = transition.level and transition.role == "hard" and transition.name not in ends
            if acts and _past(flow, number, t, state, unpushed):
                yield transition.target, applied(machine, transition, t, state)
    flow = machine.mode(mode)
    for number, transition in enumerate(flow.transitions):
        if transition.role == "soft" and _past(flow, number, t, state, unpushed):
            yield transition.target, applied(machine, transition, t, state)


def _joined(system: System, mode: str) -> Iterator[str]:
    """The mode and those that soft transitions lead to from it, the nearest first."""
    seen, queue = {mode}, deque([mode])
    while queue:
        name = queue.popleft()
        yield name
        for transition in system.leaving(name):
            if transition.role == "soft" and transition.target not in seen:
                seen.add(transition.target)
                queue.append(transition.target)


def _past(flow: ModeFlow, number: int, t: float, state: np.ndarray, unpushed: np.ndarray | None) -> bool:
    """Whether a guard is past zero, beyond rounding, and further than on the motion.

    On the motion it is not past zero; right after its own event it may seem to be, by the error of the state.
    """
    guard, direction = flow.guards[number], flow.guards[number].direction
    value, _, noise = guard(t, state[flow.states], flow.p).tolist()
    if not direction * value > noise:
        return False
    if unpushed is None:
        return True
    before, _, around = guard(t, unpushed[flow.states], flow.p).tolist()
    return bool(direction * (value - before) > noise + around)


def _forbidden(
    machine: HybridMachine,
    t: float,
    mode: str,
    unpushed: np.ndarray,
    pushed: np.ndarray,
    ends: Collection[str],
) -> str:
    """Name of a transition whose guard the push has carried past zero; empty where there is none."""
    flow = machine.mode(mode)
    for number, transition in enumerate(flow.transitions):
        acts = transition.role == "hard" and transition.name not in ends
        acts = acts and not flow.guards[number].code.of_time_alone
        if acts and _carried_past(flow, number, transition, t, unpushed, pushed):
            return transition.name
    return ""


def _carried_past(
    flow: ModeFlow, number: int, transition: Transition, t: float, unpushed: np.ndarray, pushed: np.ndarray
) -> bool:
    before, _, noise = flow.guards[number](t, unpushed[flow.states], flow.p).tolist()
    after = float(flow.guards[number](t, pushed[flow.states], flow.p)[0])
    direction = flow.guards[number].direction
    if direction == 0:
        return before * after < 0.0 and abs(before) > noise
    return direction * before <= noise and direction * after > noise

"""A pushed state brought into a mode in which the machine can be there.

What a push does to guards is not an event of the motion. Where a transition acts at entry (`level=True`), it
happens: a foot that a push has put below the ground stands on it. Modes that soft transitions join are one
mode of the machine, whose field has several pieces: of them the one is taken on whose side of the soft guards
the state is, and what acts at entry in any of them does. A guard that the last event has left at zero, and
that a push of the velocity turns back, acts at once: a ball on the floor that is pushed down bounces. Where a
guard that acts otherwise has been pushed past zero, from the side on which it is on the motion, the machine
cannot be there: a mass is behind its wall. It can be there where what its event does lets it go on past zero.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Iterator
from dataclasses import dataclass

import numpy as np

from contwalk.flow.hybrid.machine import HybridMachine, ModeFlow, applied
from contwalk.numerics.linear import SMALLEST
from contwalk.system import System, Transition

HALVINGS = 60  # of a push, until it puts a guard to zero
STEP = 1e-5  # of differences, in parts of a state or of the push
MOST_CHANGES = 64  # of the mode, after which the machine is said to have no mode there


@dataclass(frozen=True, eq=False)
class Place:
    """Mode and state, of full length, in which a motion sets out; `beyond` names a guard that forbids it, and
    `last` the transition that has led there."""

    mode: str
    state: np.ndarray
    beyond: str = ""
    last: str | None = None


def placed(
    machine: HybridMachine,
    t: float,
    mode: str,
    unpushed: np.ndarray,
    pushed: np.ndarray,
    ends: Collection[str] = (),
    last: str | None = None,
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
    last : str, optional
        The one that has led to the state on the motion.
    """
    name, state = mode, machine.existing(mode, pushed)
    back = _turned_back(machine, t, mode, unpushed, state, last)
    if back is not None:
        return Place(back.target, applied(machine, back, t, state), last=back.name)
    for _ in range(MOST_CHANGES):
        there = unpushed if name == mode else None
        following = next(_forced(machine, t, name, state, there, ends), None)
        if following is None:
            break
        name, state = following
    else:
        return Place(mode, pushed, "no mode is left to be in")
    beyond = _forbidden(machine, t, name, unpushed, state, ends, last) if name == mode else ""
    return Place(name, state, beyond, last if name == mode else None)


def _turned_back(
    machine: HybridMachine,
    t: float,
    mode: str,
    unpushed: np.ndarray,
    pushed: np.ndarray,
    last: str | None,
) -> Transition | None:
    """The last event where it happens once more: its guard is zero still, and leaves it no longer."""
    flow = machine.mode(mode)
    for transition, guard in zip(flow.transitions, flow.guards, strict=True):
        if transition.name == last and transition.role == "hard" and not guard.code.of_time_alone:
            before, leaving, around = guard(t, unpushed[flow.states], flow.p).tolist()
            value, rate, noise = guard(t, pushed[flow.states], flow.p).tolist()
            enters = -1 if leaving > 0.0 else 1
            known = guard.direction in (0, enters)
            if known and rate * enters > 0.0 > leaving * enters and abs(value - before) <= noise + around:
                return transition
    return None


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
    last: str | None,
) -> str:
    """Name of a transition whose guard the push has carried past zero; empty where there is none.

    Right after its own event a guard is zero, whatever the error of the state makes of it.
    """
    flow = machine.mode(mode)
    for number, transition in enumerate(flow.transitions):
        acts = transition.role == "hard" and transition.name not in ends
        acts = acts and not flow.guards[number].code.of_time_alone
        if not (acts and _carried_past(flow, number, transition.name == last, t, unpushed, pushed)):
            continue
        if not _goes_on(machine, flow, number, transition, t, unpushed, pushed):
            return transition.name
    return ""


def _carried_past(
    flow: ModeFlow, number: int, own: bool, t: float, unpushed: np.ndarray, pushed: np.ndarray
) -> bool:
    before, _, noise = flow.guards[number](t, unpushed[flow.states], flow.p).tolist()
    after = float(flow.guards[number](t, pushed[flow.states], flow.p)[0])
    direction = flow.guards[number].direction
    if own:
        before, after = 0.0, after - before
    if direction == 0:
        return before * after < 0.0 and abs(before) > noise
    return direction * before <= noise and direction * after > noise


def _goes_on(
    machine: HybridMachine,
    flow: ModeFlow,
    number: int,
    transition: Transition,
    t: float,
    unpushed: np.ndarray,
    pushed: np.ndarray,
) -> bool:
    """Whether a motion that meets a guard on the way of a push is past it, in the same mode, after the event.

    What is pushed past a wall is nowhere. What is pushed past a place at which the machine is kicked, and
    goes on, is where it often is.
    """
    if transition.target != transition.source:
        return False
    guard, ahead = flow.guards[number], pushed - unpushed
    side = 1.0 if guard(t, pushed[flow.states], flow.p)[0] > 0.0 else -1.0
    inner, outer = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (inner + outer)
        past = side * guard(t, (unpushed + middle * ahead)[flow.states], flow.p)[0] > 0.0
        inner, outer = (inner, middle) if past else (middle, outer)
    met = _arriving(
        flow, number, t, (unpushed + outer * ahead)[flow.states], side, float(np.linalg.norm(ahead))
    )
    if met is None:
        return False
    value, _, noise = guard(t, met, flow.p).tolist()
    after = applied(machine, transition, t, machine.full(transition.source, met))
    then, rate, around = guard(t, after[flow.states], flow.p).tolist()
    return bool(side * then > around or (abs(then - value) <= noise + around and side * rate > 0.0))


def _arriving(
    flow: ModeFlow, number: int, t: float, zero: np.ndarray, side: float, size: float
) -> np.ndarray | None:
    """A state at which a guard is zero and goes to a side, off `zero`, shape (m,), by about `size` in what
    changes its rate alone; None where nothing does."""
    guard = flow.guards[number]
    rate = float(guard(t, zero, flow.p)[1])
    if side * rate > 0.0:
        return zero
    steps = STEP * np.maximum(np.abs(zero), size)
    apart = [guard(t, zero + step, flow.p) - guard(t, zero - step, flow.p) for step in np.diag(steps)]
    across, along = (np.array(apart)[:, :2] / (2.0 * steps[:, None])).T
    along -= across * (along @ across) / max(float(across @ across), SMALLEST)
    steepness = float(np.linalg.norm(along))
    if not steepness > STEP * abs(rate) / size:
        return None
    return np.asarray(zero + side * (abs(rate) / steepness + size) / steepness * along)

"""What transitions lead to that have one instant, in each order."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from contwalk.flow.hybrid.chatter import MOST_AT_ONCE
from contwalk.flow.hybrid.guard_status import PASSED, guard_statuses, happens_at_once
from contwalk.flow.hybrid.machine import HybridMachine, displaced, landed
from contwalk.flow.hybrid.saltation import saltation
from contwalk.numerics.linear import EPSILON, SMALLEST
from contwalk.problems.hybrid.adjacent.orbit import CHANGES
from contwalk.signatures import folded
from contwalk.system import System


@dataclass(frozen=True, eq=False)
class Result:
    """What an order of transitions leads to.

    Parameters
    ----------
    order : tuple of str
        The transitions as they act.
    mode, state
        Where they lead; the state has the shape (n,).
    noise : ndarray, shape (n,)
        Uncertainties of the state.
    matrix : ndarray, shape (n, n)
        How deviations go through them, in this order.
    shifts : tuple of ndarray, shape (n,) each
        Derivatives of the instants of the transitions by what they begin with.
    passed : frozenset
        The guards that have been passed and go on.
    """

    order: tuple[str, ...]
    mode: str
    state: np.ndarray
    noise: np.ndarray
    matrix: np.ndarray
    shifts: tuple[np.ndarray, ...] = ()
    passed: frozenset[object] = frozenset()

    def same(self, other: Result, scale: np.ndarray) -> bool:
        """Whether another one has its mode, state and guards that have been passed; units of shape (n,)."""
        away = np.abs(self.state - other.state)
        alike = self.mode == other.mode and self.passed == other.passed
        return alike and bool(np.all(away <= CHANGES * scale + self.noise + other.noise))

    def stays_together(self, scale: np.ndarray) -> bool:
        """Whether its transitions have one instant on all motions beside, as of one guard.

        `scale` has the shape (n,).
        """
        shifts = np.array(self.shifts) * scale
        return bool(np.all(np.abs(shifts - shifts[0]) <= CHANGES * np.abs(shifts).max()))

    def goes_on_as(self, other: Result, scale: np.ndarray) -> bool:
        """Whether deviations, in units of shape (n,), go through as in another order."""
        away = np.abs(self.matrix - other.matrix) * scale / scale[:, None]
        largest = np.abs(self.matrix * scale / scale[:, None]).max()
        return bool(np.all(away <= CHANGES * largest))


def results(
    machine: HybridMachine, t: float, x: np.ndarray, mode: str, scale: np.ndarray, room: float, declared: bool
) -> list[Result]:
    """What orders lead to, each once, of transitions that have one instant.

    Parameters
    ----------
    machine : HybridMachine
    t, x, mode
        The instant, and the state of shape (n,) before the first transition.
    scale : ndarray, shape (n,)
        Magnitudes of the states.
    room : float
        Seconds within which events are at one instant.
    declared : bool
        Whether orders that a declaration excludes are left out.

    Returns
    -------
    list of Result
        Of orders that lead to one state, and through which deviations go alike, one.
    """
    speed = displaced(machine.mode(mode), t, x) / (EPSILON * max(abs(t), SMALLEST))
    begun = Result((), mode, np.asarray(x, dtype=float), EPSILON * np.abs(x) + room * speed, np.eye(len(x)))
    found: list[Result] = []
    level = [begun]
    for _ in range(MOST_AT_ONCE):
        following: list[Result] = []
        for result in level:
            further = list(_further(machine, t, result, scale, declared))
            if not further:
                found = _with(found, replace(result, passed=frozenset()), scale)
            for each in further:
                following = _with(following, each, scale)
        if not following:
            break
        level = following
    return found


def _with(known: list[Result], result: Result, scale: np.ndarray) -> list[Result]:
    """Results, each once: of those after as many transitions what is the same goes on as one."""
    one = any(result.same(each, scale) and result.goes_on_as(each, scale) for each in known)
    return known if one else [*known, result]


def _further(
    machine: HybridMachine, t: float, at: Result, scale: np.ndarray, declared: bool
) -> Iterator[Result]:
    """What happens next at the instant, in each order."""
    flow = machine.mode(at.mode)
    last, own = (at.order[-1] if at.order else None), flow.states
    names = [transition.name for transition in flow.transitions]
    codes = [guard.code.guard for guard in flow.guards]
    through = flow.passed(last) | {name for name, code in zip(names, codes, strict=True) if code in at.passed}
    zero = flow.left_at_zero(last) | through
    standing = guard_statuses(flow, t, at.state[own], at.noise[own], scale[own], zero, through)
    passed = frozenset(code for code, now in zip(codes, standing, strict=True) if now.kind == PASSED)
    ready = {names[i]: i for i, now in enumerate(standing) if happens_at_once(flow, i, now)}
    for name, i in ready.items():
        if declared and machine.system.earlier_at_once.get(name, frozenset()) & ready.keys():
            continue
        transition = flow.transitions[i]
        after, noise = landed(machine, transition, t, at.state)
        carried = np.where(after == at.state, np.maximum(noise, at.noise), noise)
        through_it = np.zeros((len(at.state), len(at.state)))
        target = machine.mode(transition.target).states
        through_it[np.ix_(target, own)], shift = saltation(machine, transition, t, at.state)
        yield Result(
            (*at.order, name),
            transition.target,
            after,
            carried,
            through_it @ at.matrix,
            (*at.shifts, shift @ at.matrix[own]),
            passed | {codes[i]},
        )


def conflict(found: list[Result], scale: np.ndarray) -> tuple[Result, Result] | None:
    """The first of some results, and one that differs from it; `scale` has the shape (n,).

    None where all are the same, and where there is none: transitions follow each other without end.
    """
    return next(((found[0], each) for each in found[1:] if not each.same(found[0], scale)), None)


def orders_told(system: System, t: float, one: Result, other: Result, scale: np.ndarray) -> str:
    """Two orders with what each leads to; `scale` has the shape (n,)."""
    apart = np.flatnonzero(np.abs(one.state - other.state) > CHANGES * scale)

    def leads(result: Result) -> str:
        values = [f"{system.state_names[k]} = {result.state[k]:.6g}" for k in apart]
        if one.mode != other.mode:
            values = [f"mode '{result.mode}'", *values]
        return f"[{folded(result.order)}] leads to {', '.join(values) or 'the same state'}"

    return (
        f"'{one.order[0]}' and '{other.order[0]}' happen at one instant, t = {system.lasting(t)}, and their "
        f"orders differ in their results: {leads(one)}, {leads(other)}."
    )


def remedy(one: Result, other: Result) -> str:
    """How a plugin says which of two orders is meant."""
    first, second = one.order[0], other.order[0]
    return (
        f'Say in the plugin which acts first, as with Transition("{first}", ..., together=("{first}", '
        f'"{second}")).'
    )

"""Motions and their derivatives by SciPy's integrators: no step, method or error of the engine."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from contwalk.numerics.linear import EPSILON
from contwalk.verification import budget
from contwalk.verification.finding import SLACK, CannotTell
from contwalk.verification.functions import Function, Functions

# The tightest relative tolerance that SciPy takes is 100 roundings. Each result is computed with that, and
# with ten times as much, to see what the tolerance makes of it.
TIGHT = 100.0 * EPSILON
COARSER = 10.0
# Right-hand sides of one motion at most, a minute of them.
MOST_CALLS = 2_000_000
# The explicit method, and the one that is followed where that takes many times as much: where it is stiff.
EXPLICIT, STIFF = "DOP853", "LSODA"


class CannotIntegrate(CannotTell):
    """A motion that SciPy does not follow to its end."""


class TooManySteps(CannotIntegrate):
    """One that takes more than a motion should."""


@dataclass(frozen=True)
class Passage:
    """A piece of a motion that was followed.

    Parameters
    ----------
    times, states, tangents : ndarray, shapes (s,), (s, n) and (s, n, 1 + n + k)
        At the integrator's own steps; the last ones are derivatives, as `derivative` is that of the end.
    end : ndarray, shape (n,)
    derivative : ndarray, shape (n, 1 + n + k)
        Of the end, by the time of the start (with the duration as it is), its states, and free parameters.
    rate : ndarray, shape (n,)
        At the end.
    mode : str
        The mode at the end: soft transitions change it on the way.
    modes : tuple of str
        That of each step, s - 1 of them.
    """

    times: np.ndarray
    states: np.ndarray
    tangents: np.ndarray
    end: np.ndarray
    derivative: np.ndarray
    rate: np.ndarray
    mode: str
    modes: tuple[str, ...]


def passed(
    functions: Functions,
    mode: str,
    start: float,
    x: np.ndarray,
    duration: float,
    p: np.ndarray,
    scale: np.ndarray,
    relative: float,
) -> Passage:
    """A motion from x, shape (n,), with its variational equations, for a duration.

    Parameters
    ----------
    scale : ndarray, shape (n,)
        Sizes of the states: what is below `relative` of them is no error.
    relative : float
        SciPy's tolerance.

    Raises
    ------
    CannotIntegrate
    """
    n, width = len(x), 1 + len(x) + functions.parameters.slopes.shape[1]
    y = np.concatenate([x, np.hstack([np.zeros((n, 1)), np.eye(n), np.zeros((n, width - 1 - n))]).ravel()])
    sizes = np.concatenate(
        [scale, np.outer(scale, np.concatenate([[1.0], 1.0 / scale, np.ones(width - 1 - n)])).ravel()]
    )
    times, whole, t, end, modes = [np.array([start])], [y[None]], start, start + duration, list[str]()
    motion = _Motion(functions, p, relative, sizes, width)
    mode = _settled(functions, mode, start, x, p)
    while True:
        found = motion.followed(mode, t, y, end)
        times.append(found.t[1:])
        whole.append(found.y[:, 1:].T)
        modes += [mode] * (len(found.t) - 1)
        t, y = float(found.t[-1]), found.y[:, -1]
        if found.status == 0:
            break
        mode = _switched(functions, mode, found).target
    field = functions.field(mode)
    rate, _ = field(t, y[:n], p)
    along = np.vstack(whole)
    tangents = along[:, n:].reshape(-1, n, width)
    passed_ = np.concatenate(times), along[:, :n], tangents, y[:n], tangents[-1], rate, mode
    return Passage(*passed_, tuple(modes))


def grown(pieces: list[Passage], scale: np.ndarray, most: int) -> Iterator[float]:
    """By how much deviations grow over each of some pieces, and over several up to so many in a row, in units
    of the states, shape (n,).
    """
    for i in range(len(pieces)):
        product = np.eye(len(pieces[i].end))
        for piece in pieces[i : i + most]:
            product = piece.derivative[:, 1 : 1 + len(product)] @ product
            yield float(np.linalg.norm(product / scale[:, None] * scale, 2))


def reached(
    functions: Functions,
    mode: str,
    start: float,
    x: np.ndarray,
    duration: float,
    p: np.ndarray,
    scale: np.ndarray,
    relative: float,
) -> tuple[np.ndarray, str]:
    """As `passed`, without derivatives: the end of a motion, shape (n,), and the mode there."""
    motion = _Motion(functions, p, relative, scale, 0)
    t, end, mode = start, start + duration, _settled(functions, mode, start, x, p)
    while True:
        found = motion.followed(mode, t, x, end)
        t, x = float(found.t[-1]), found.y[:, -1]
        if found.status == 0:
            return x, mode
        mode = _switched(functions, mode, found).target


def _switched(functions: Functions, mode: str, found: Any) -> Any:
    """The soft transition at which a motion came to its end."""
    ended = zip(soft(functions, mode), found.t_events, strict=True)
    return next(each for each, at in ended if len(at))


@dataclass(frozen=True)
class _Motion:
    """What motions of all modes have in common: parameters, tolerances, and the width of the derivatives."""

    functions: Functions
    p: np.ndarray
    relative: float
    sizes: np.ndarray
    width: int

    def followed(self, mode: str, t: float, y: np.ndarray, end: float) -> Any:
        """A motion in one mode, up to a soft transition, as SciPy has it; y has the shape (n + n width,).

        It is stiff where the explicit method takes many times the right-hand sides that the other one did for
        the first motion of the record.
        """
        functions = self.functions
        if end == t:
            return self._by(EXPLICIT, mode, t, y, end, MOST_CALLS)
        if functions.taken is None:
            with suppress(CannotIntegrate):
                self._by(STIFF, mode, t, y, end, MOST_CALLS)
            functions.taken = functions.taken or (MOST_CALLS, abs(end - t), self.relative)
        try:
            return self._by(EXPLICIT, mode, t, y, end, self._most(end - t))
        except TooManySteps:
            return self._by(STIFF, mode, t, y, end, MOST_CALLS)

    def _most(self, lasts: float, order: int = 8) -> int:
        """How many right-hand sides the explicit method may take by what another motion took.

        They grow as the root of its order of how much smaller the tolerance is.
        """
        assert self.functions.taken is not None
        calls, known, relative = self.functions.taken
        longer = max(abs(lasts) / known, 1.0)
        finer = max(relative / self.relative, 1.0) ** (1.0 / order)
        return int(min(SLACK * calls * longer * finer, MOST_CALLS))

    def _by(self, method: str, mode: str, t: float, y: np.ndarray, end: float, most: int) -> Any:
        """A motion by one method, of so many right-hand sides at most."""
        from scipy.integrate import solve_ivp

        functions, width, calls = self.functions, self.width, 0
        field, n = functions.field(mode), len(y) // (1 + width)
        field.at(self.p)
        whole = np.eye(width)  # the time, the states and the free parameters, by themselves

        def right(t: float, y: np.ndarray) -> np.ndarray:
            nonlocal calls
            calls += 1
            budget.ask()
            if calls > most:
                raise TooManySteps(
                    f"SciPy's {method} takes too many steps: the field is stiff there, or rounded."
                )
            f, moved = field.linear(t, y[:n])
            if not width:
                return f.copy()
            whole[1 : 1 + n] = y[n:].reshape(n, width)
            rates = np.empty(len(y))
            rates[:n] = f
            np.dot(moved, whole, out=rates[n:].reshape(n, width))
            return rates

        softs = [
            _crossing(functions.guard(each), each.direction, self.p, n) for each in soft(functions, mode)
        ]
        given = {"rtol": self.relative, "atol": self.relative * self.sizes, "events": softs or None}
        with np.errstate(all="ignore"):  # what is not finite shows in what comes out
            found = solve_ivp(right, (t, end), y, method=method, **given)
        if end != t and (functions.taken is None or calls > functions.taken[0]):
            functions.taken = calls, abs(end - t), self.relative
        functions.switches += len(softs) > 0 and found.status == 1
        if functions.switches > MOST_CALLS // 200:  # a motion that only changes its mode ends as well
            raise CannotIntegrate("The motion changes its mode again and again.")
        if found.status < 0 or not np.isfinite(found.y[:, -1]).all():
            raise CannotIntegrate(f"SciPy's {method} does not follow the motion: {found.message}")
        return found


def zero_between(function: Callable[[float], float], begin: float, end: float) -> float:
    """Where a function passes zero between two instants.

    Where rounding leaves it one sign at both, it is at the one where the function is nearer to zero.
    """
    from scipy.optimize import brentq

    first, last = function(begin), function(end)
    if first * last >= 0.0:
        return begin if abs(first) <= abs(last) else end
    return float(brentq(function, begin, end, xtol=1e-9 * abs(end - begin), rtol=4.0 * EPSILON))


def soft(functions: Functions, mode: str) -> list[Any]:
    """The soft transitions that leave a mode."""
    return [each for each in functions.system.leaving(mode) if each.role == "soft"]


def _crossing(guard: Function, direction: str, p: np.ndarray, n: int) -> Any:
    """A guard as SciPy's events are."""

    def event(t: float, y: np.ndarray) -> float:
        return float(guard(t, y[:n], p)[0][0])

    event.terminal = True  # type: ignore[attr-defined]
    event.direction = {"falling": -1.0, "rising": 1.0, "both": 0.0}[direction]  # type: ignore[attr-defined]
    return event


def _settled(functions: Functions, mode: str, t: float, x: np.ndarray, p: np.ndarray) -> str:
    """The mode of a motion at a state: soft transitions happen at once where their guards are past."""
    for _ in functions.system.modes:
        for each in soft(functions, mode):
            value, moved = functions.guard(each)(t, x, p)
            rate = float(moved[0, 0] + moved[0, 1 : 1 + len(x)] @ functions.field(mode)(t, x, p)[0])
            sign = 1.0 if each.direction == "rising" else -1.0
            level = np.spacing(float(np.abs(moved[0, 1 : 1 + len(x)]) @ np.abs(x)))
            past = sign * (float(value[0]) if abs(value[0]) > level else rate)
            if past > 0.0:
                mode = each.target
                break
        else:
            break
    return mode

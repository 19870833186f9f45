"""Periodic orbits of machines with events by SciPy's DOP853: durations are unknowns, no event is searched.

The plugin's own functions are called by NumPy as they stand, with complex arrays: derivatives are complex
steps of the integration, exact to its own error. Nothing of contwalk is used but the declaration.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import combinations
from math import prod
from types import SimpleNamespace
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from contwalk.system import System, Transition

TINY = 1e-40
# Zero at a special point of this label, of the multipliers.
TESTS: dict[str, Callable[[np.ndarray], complex]] = {
    "LP": lambda values: prod(value - 1.0 for value in values),
    "PD": lambda values: prod(value + 1.0 for value in values),
    "NS": lambda values: prod(a * b - 1.0 for a, b in combinations(values, 2)),
}


class Cycle:
    """Periodic orbits with a given sequence of legs.

    Unknowns `z` are the state at the beginning of the first leg, the legs' durations, of a forced machine the
    time at which the first one begins, and the free parameter.

    Parameters
    ----------
    system : System
        Its functions use NumPy's functions in place of those of `math`.
    legs : sequence of (mode, transition)
        The transition by its name, or one that the machine does not have: a turn that is to be looked at.
    parameters : dict
        What differs from the defaults.
    free : str
    image : callable, optional
        `image(x)`: the orbit is closed up to this map.
    periods : float
        So many periods of the forcing pass until then.
    """

    def __init__(
        self,
        system: System,
        legs: Sequence[tuple[str, str | Transition]],
        parameters: dict[str, float],
        free: str,
        image: Callable[[np.ndarray], np.ndarray] | None = None,
        periods: float = 1.0,
    ) -> None:
        self.given, self.free = {**system.defaults(), **parameters}, free
        modes = {mode.name: mode for mode in system.modes}
        events = {(event.source, event.name): event for event in system.transitions}
        self.legs = [
            (modes[mode], events[mode, event] if isinstance(event, str) else event) for mode, event in legs
        ]
        self.states, self.period, self.periods = len(system.states), system.period, periods
        self.image = image or (lambda x: x)

    def equations(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What the orbit misses by, and its Jacobian; rows: states, guards, the whole duration if forced."""
        moved = np.tile(z.astype(complex)[:, None], (1, len(z)))
        moved += 1j * TINY * np.eye(len(z))
        rows = self._round(moved)
        return rows[:, 0].real, rows.imag / TINY

    def _round(self, z: np.ndarray) -> np.ndarray:
        """Once round, of many orbits at once: a column each."""
        x, t, p, guards = z[: self.states], self._begin(z), None, []
        for k in range(len(self.legs)):
            t, x, p = self._leg(z, k, t, x)
            event = self.legs[k][1]
            guards.append(event.guard(t, x, p))
            if event.reset is not None:
                after = np.empty_like(x)
                event.reset(t, x, p, after)
                x = after
        rows = [*(self.image(x) - z[: self.states]), *guards]
        if self.period:
            rows.append(t - self._begin(z) - self.periods * self.period(p))
        return np.array(rows)

    def _begin(self, z: np.ndarray) -> np.ndarray:
        return z[-2] if self.period else 0.0 * z[-1]

    def _leg(self, z: np.ndarray, k: int, t: Any, x: np.ndarray) -> tuple[Any, np.ndarray, Any]:
        """Time, state and parameters at the end of leg k, which begins at t and x."""
        mode, lasting = self.legs[k][0], z[self.states + k]
        p = SimpleNamespace(**{**self.given, **mode.constants, self.free: z[-1]})
        return t + lasting, self._flown(mode.field, p, t, x, lasting), p

    def at_first_end(self, z: np.ndarray, function: Callable[..., Any]) -> float:
        """`function(t, x, p)`, a guard for example, where the first leg ends."""
        column = z[:, None]
        return float(function(*self._leg(column, 0, self._begin(column), column[: self.states]))[0])

    def _flown(self, field: Any, p: Any, t: np.ndarray, x: np.ndarray, lasting: np.ndarray) -> np.ndarray:
        def rate(s: float, y: np.ndarray) -> np.ndarray:
            dx = np.zeros_like(x)
            field(t + s * lasting, y.reshape(x.shape), p, dx)
            return (lasting * dx).ravel()

        motion = solve_ivp(rate, (0.0, 1.0), x.ravel(), method="DOP853", rtol=1e-13, atol=1e-14)
        return motion.y[:, -1].reshape(x.shape)

    def solved(self, z: np.ndarray, pinned: int = -1) -> np.ndarray:
        """The orbit near z that has this unknown's value; Newton's method."""
        pin = np.eye(len(z))[pinned]
        for _ in range(30):
            value, slopes = self.equations(z)
            change = np.linalg.solve(np.vstack([slopes, pin]), [*-value, 0.0])
            z = z + change
            if np.abs(change).max() < 1e-11 * max(1.0, np.abs(z).max()):
                return z
        raise AssertionError(f"Newton's method ends with a correction of {np.abs(change).max():.1g}")

    def multipliers(self, z: np.ndarray) -> np.ndarray:
        """Of the map from the beginning of a cycle to that of the next, in state and time; one is zero."""
        n, slopes = self.states, self.equations(z)[1]
        last = n + len(self.legs)
        whole = np.zeros((len(slopes), len(slopes)))
        whole[:, :] = slopes[:, :-1]
        whole[:n, :n] += np.eye(n)
        guards, kept = whole[n:last], [*range(n), *range(last, len(whole))]
        if self.period:
            whole[last, last] += 1.0  # the time of the next beginning
        lasting = -np.linalg.solve(guards[:, n:last], guards[:, kept])
        return np.linalg.eigvals(whole[np.ix_(kept, kept)] + whole[kept, n:last] @ lasting)

    def special(self, test: Callable[[Cycle, np.ndarray], float], z: np.ndarray, pinned: int) -> np.ndarray:
        """The orbit near z at which the test is zero: secants in the pinned unknown."""

        def tested(z: np.ndarray) -> tuple[np.ndarray, float]:
            z = self.solved(z, pinned)
            return z, test(self, z)

        z, value = tested(z)
        step = 1e-5 * max(1e-3, abs(z[pinned]))
        for _ in range(20):
            moved = z.copy()
            moved[pinned] += step
            before, (z, value) = value, tested(moved)
            step *= -value / (value - before)
            if abs(step) < 1e-13 * max(1e-3, abs(z[pinned])):
                return z
        raise AssertionError(f"secants end with a step of {step:.1g}")


def multipliers_test(label: str) -> Callable[[Cycle, np.ndarray], float]:
    """Zero where multipliers are those of this label."""
    return lambda cycle, z: float(np.real(TESTS[label](cycle.multipliers(z))))


def touching(guard: Callable[..., Any]) -> Callable[[Cycle, np.ndarray], float]:
    """Zero where this guard is zero at the end of the first leg, which is a turn of it."""
    return lambda cycle, z: cycle.at_first_end(z, guard)

"""Periodic orbits of one impact by SciPy's DOP853: the impact's instant is an unknown, no event is searched.

Unknowns are the state just before the impact, its instant and the free parameter. Derivatives are complex
steps of the integration, exact to its own error.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

TINY = 1e-40


class OneImpact:
    """Orbits of a forced machine that strikes once a period.

    Parameters
    ----------
    field, guard, reset : callable
        `field(t, x, p)` and `reset(t, x, p)` return arrays; all understand complex numbers.
    parameters : dict
    free : str
    period : float
    """

    def __init__(
        self, field: Any, guard: Any, reset: Any, parameters: dict[str, float], free: str, period: float
    ) -> None:
        self.field, self.guard, self.reset = field, guard, reset
        self.parameters, self.free, self.period = parameters, free, period

    def round(self, z: np.ndarray) -> tuple[np.ndarray, Any]:
        """The state a period after the impact, and the guard at it."""
        *x, instant, free = z
        p = SimpleNamespace(**{**self.parameters, self.free: free})
        after = self.reset(instant, np.array(x), p)
        motion = solve_ivp(
            lambda t, y: self.field(instant + t, y, p),
            (0.0, self.period),
            np.asarray(after, dtype=complex),
            method="DOP853",
            rtol=1e-13,
            atol=1e-13,
        )
        return motion.y[:, -1], self.guard(instant, np.array(x), p)

    def equations(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What the orbit misses by, and its Jacobian; rows: states, guard."""
        columns = []
        for k in range(len(z)):
            moved = z.astype(complex)
            moved[k] += 1j * TINY
            end, h = self.round(moved)
            columns.append(np.append(end - moved[:-2], h))
        return columns[0].real, np.array(columns).imag.T / TINY

    def _rate(self, z: np.ndarray) -> np.ndarray:
        *x, instant, free = z
        p = SimpleNamespace(**{**self.parameters, self.free: free})
        return np.asarray(self.field(instant + self.period, np.array(x), p))

    def guess(self, state: np.ndarray, free: float) -> np.ndarray:
        """An orbit whose state before the impact is known, and the instant of it not."""
        instants = np.linspace(0.0, self.period, 64, endpoint=False)
        tried = [np.array([*state, instant, free]) for instant in instants]
        return min(tried, key=lambda z: float(np.linalg.norm(self.round(z)[0] - state)))

    def special(self, z: np.ndarray, multiplier: float) -> np.ndarray:
        """The orbit with this multiplier near z: Newton's method for the orbit and a determinant.

        The determinant's own derivative begins as a difference quotient and follows Broyden's update, which
        bounds the speed of convergence and not what is converged to.
        """

        def both(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            value, slopes = self.equations(z)
            critical = slopes[:, :-1].copy()
            critical[:-1, :-1] += (1.0 - multiplier) * np.eye(len(z) - 2)
            critical[:-1, -1] += (multiplier - 1.0) * self._rate(z)  # the next impact moves, too
            return np.append(value, np.linalg.det(critical)), slopes

        steps = np.diag(1e-5 * np.maximum(1.0, np.abs(z)))
        gradient = np.array([(both(z + d)[0][-1] - both(z - d)[0][-1]) / (2.0 * d.max()) for d in steps])
        value, slopes = both(z)
        for _ in range(12):
            change = np.linalg.solve(np.vstack([slopes, gradient]), -value)
            before, (value, slopes) = value, both(z + change)
            gradient += (value[-1] - before[-1] - gradient @ change) * change / (change @ change)
            z = z + change
            if np.abs(change).max() < 1e-9:
                return z
        raise AssertionError(f"Newton's method ends with a correction of {np.abs(change).max():.1g}")

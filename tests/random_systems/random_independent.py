"""A machine of text evaluated without contwalk: in 40 digits, or in arrays and by complex steps."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import mpmath
import numpy as np
from random_recipe import Recipe
from scipy.integrate import solve_ivp

DIGITS = 40
IMAGINARY = 1e-30
# Far below what a run asks of its orbits (1e-6 of each state's variation and step), far above rounding.
RELATIVE = 1e-9
# Evaluations after which an integration is given up, and said to be unchecked.
MOST = 12000


def spread(parameters: dict[str, Any]) -> dict[str, Any]:
    """Parameters for states with one more axis behind that of the rows."""
    return {name: v[:, None] if isinstance(v, np.ndarray) else v for name, v in parameters.items()}


class Unchecked(Exception):
    """An independent integration came to no end."""


class TooLong(Unchecked):
    """It took more evaluations than are spent on it."""


class Machine:
    """The functions of a recipe in floats, arrays and complex numbers (`now`), or in 40 digits (`exact`)."""

    def __init__(self, recipe: Recipe) -> None:
        text = recipe.functions_text()
        self.recipe = recipe
        self.now: dict[str, Any] = {"sin": np.sin, "cos": np.cos, "pi": np.pi}
        exec(text, self.now)
        self.exact: dict[str, Any] = {"sin": mpmath.sin, "cos": mpmath.cos, "pi": mpmath.pi}
        exec(text, self.exact)

    # -- equilibria ------------------------------------------------------------------------------------------

    def residual(self, x: np.ndarray, parameters: dict[str, float]) -> np.ndarray:
        """f(x) to 40 digits, rounded: coefficients are the doubles of the text."""
        with mpmath.workdps(DIGITS):
            p = SimpleNamespace(**{k: mpmath.mpf(float(v)) for k, v in parameters.items()})
            dx = [mpmath.mpf(0)] * len(x)
            self.exact[next(iter(self.recipe.modes))](mpmath.mpf(0), [mpmath.mpf(float(v)) for v in x], p, dx)
            return np.array([float(v) for v in dx])

    def terms(self, x: np.ndarray, parameters: dict[str, float]) -> np.ndarray:
        """Sum of the magnitudes of the terms of each equation."""
        scope = {"sin": np.sin, "cos": np.cos, "x": x, "p": SimpleNamespace(**parameters), "t": 0.0}
        equations = next(iter(self.recipe.modes.values()))
        return np.array([sum(abs(eval(t.text, scope)) for t in terms) for terms in equations])

    def jacobians(self, x: np.ndarray, parameters: dict[str, Any]) -> np.ndarray:
        """df/dx at states x, shape (n, k), by complex steps: shape (k, n, n)."""
        n = len(x)
        columns = np.repeat(x[:, :, None].astype(complex), n, axis=2)
        columns[np.arange(n), :, np.arange(n)] += 1j * IMAGINARY
        return self.field(0.0, columns, spread(parameters)).imag.transpose(1, 0, 2) / IMAGINARY

    def field(self, t: Any, x: np.ndarray, parameters: dict[str, Any], mode: str | None = None) -> np.ndarray:
        """f at many states, shape (n, ...); parameters may be arrays that go with them."""
        return self.written(mode or next(iter(self.recipe.modes)), t, x, parameters)

    def written(self, name: str, t: Any, x: np.ndarray, parameters: dict[str, Any]) -> np.ndarray:
        """What a function writes into its last argument."""
        out = np.empty(x.shape, dtype=np.result_type(x, np.asarray(t)))
        self.now[name](t, x, SimpleNamespace(**parameters), out)
        return out

    # -- motions ---------------------------------------------------------------------------------------------

    def carried(
        self,
        x: np.ndarray,
        begin: np.ndarray,
        duration: np.ndarray,
        parameters: dict[str, Any],
        scale: np.ndarray,
        mode: str | None = None,
        derivative: bool = True,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Motions from x (n, k) at `begin` for `duration` (k,): 33 states on the way, ends, derivatives.

        Shapes (33, n, k), (n, k), (k, n, n). Unknowns are deviations from the start in units of `scale`
        (n, k), so that an orbit of any size is resolved alike.
        """
        n, k = x.shape
        width = 1 + (n if derivative else 0)
        values, calls = spread(parameters), 0

        def right(tau: float, y: np.ndarray) -> np.ndarray:
            nonlocal calls
            calls += 1
            if calls > MOST:
                raise TooLong
            z = y.reshape(n, k, width)
            if not derivative:
                slopes = self.field(begin + tau * duration, x + scale * z[:, :, 0], parameters, mode)
                return (slopes / scale * duration).ravel()
            states = np.repeat((x + scale * z[:, :, 0])[:, :, None], width, axis=2).astype(complex)
            states[:, :, 1:] += 1j * IMAGINARY * scale[:, :, None] * z[:, :, 1:]
            f = self.field((begin + tau * duration)[:, None], states, values, mode)
            rate = np.empty((n, k, width))
            rate[:, :, 0] = f[:, :, 0].real / scale
            rate[:, :, 1:] = f[:, :, 1:].imag / IMAGINARY / scale[:, :, None]
            return (rate * duration[:, None]).ravel()

        start = np.zeros((n, k, width))
        if derivative:
            start[np.arange(n), :, np.arange(1, width)] = 1.0
        with np.errstate(all="ignore"):
            found = solve_ivp(
                right,
                (0.0, 1.0),
                start.ravel(),
                "DOP853",
                rtol=RELATIVE,
                atol=RELATIVE,
                t_eval=np.linspace(0.0, 1.0, 33),
            )
        if not found.success:
            raise Unchecked
        on_the_way = found.y.T.reshape(-1, n, k, width)
        states = x + scale * on_the_way[..., 0]
        if not derivative:
            return states, states[-1], np.zeros((k, n, n))
        last = on_the_way[-1][..., 1:].transpose(1, 0, 2)  # (k, n, n) in units of scale
        return states, states[-1], last * scale.T[:, :, None] / scale.T[:, None, :]

    def differential(
        self, function: Callable[[Any, np.ndarray], np.ndarray], t: float, x: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """d/dx, shape (m, n), and d/dt, shape (m,), of a function of time and state at one state."""
        n = len(x)
        columns = []
        for j in range(n):
            moved = x.astype(complex)
            moved[j] += 1j * IMAGINARY
            columns.append(np.atleast_1d(function(t + 0j, moved)).imag / IMAGINARY)
        in_time = np.atleast_1d(function(t + 1j * IMAGINARY, x.astype(complex))).imag / IMAGINARY
        return np.column_stack(columns), in_time

"""Motions and their derivatives with nothing of the engine: the plugin's own field, scipy, complex steps.

The fields of the tests are analytic (polynomials and numpy's functions), and write their entries from those
of x by arithmetic alone; so one call with x of shape (n, k) gives k velocities, and with an imaginary part of
1e-30 their derivatives to rounding.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
from scipy.integrate import solve_ivp

from contwalk.system import System

IMAGINARY = 1e-30
# The tightest that scipy's DOP853 takes is 100 roundings; its error per period is then some 1e-12.
RELATIVE = 3e-14
# For how far a motion reaches: of its size, three digits would do.
ROUGH = 1e-6


@dataclass(frozen=True)
class Passage:
    """A piece of a motion: states at the steps, shape (s, n), and the derivative of its end, shape (n, n)."""

    times: np.ndarray
    states: np.ndarray
    derivative: np.ndarray
    growth: float


def derived(function: Callable[..., None], t: float, x: np.ndarray, p: SimpleNamespace, v: np.ndarray):
    """f(x), shape (n,), and f'(x) V, shape (n, k), of a function that writes its last argument."""
    columns = np.column_stack([x, v]).astype(complex)
    columns[:, 1:] = x[:, None] + 1j * IMAGINARY * v
    out = np.full(columns.shape, np.nan + 0j)
    function(t, columns, p, out)
    return out[:, 0].real, out[:, 1:].imag / IMAGINARY


def passed(
    system: System,
    parameters: Mapping[str, float],
    x: np.ndarray,
    begin: float,
    end: float,
    scale: np.ndarray,
    method: str = "DOP853",
    relative: float = RELATIVE,
) -> Passage:
    """The motion from x between two times, with the variational equations in units of `scale`.

    `relative` is the local error that scipy is asked for; a third of it in parts of `scale`.
    """
    n, p = len(x), SimpleNamespace(**parameters)
    field = system.modes[0].field
    duration = end - begin

    def right(tau: float, y: np.ndarray) -> np.ndarray:
        f, moved = derived(
            field, begin + tau * duration, scale * y[:n], p, scale[:, None] * y[n:].reshape(n, n)
        )
        return duration * np.concatenate([f / scale, (moved / scale[:, None]).ravel()])

    start = np.concatenate([x / scale, np.eye(n).ravel()])
    found = solve_ivp(right, (0.0, 1.0), start, method=method, rtol=relative, atol=relative / 3.0)
    assert found.success, found.message
    derivatives = found.y[n:].T.reshape(-1, n, n)
    growth = max(float(np.linalg.norm(d, 2)) for d in derivatives)
    times = begin + found.t * duration
    return Passage(times, found.y[:n].T * scale, derivatives[-1] * scale[:, None] / scale, growth)


def reached(
    system: System,
    parameters: Mapping[str, float],
    x: np.ndarray,
    begin: float,
    end: float,
    scale: np.ndarray,
    method: str = "DOP853",
) -> np.ndarray:
    """States at the steps of the motion from x between two times, shape (s, n), to `ROUGH`."""
    p, field, duration = SimpleNamespace(**parameters), system.modes[0].field, end - begin

    def right(tau: float, y: np.ndarray) -> np.ndarray:
        out = np.full((len(x), 1), np.nan)
        field(begin + tau * duration, (scale * y)[:, None], p, out)
        return duration * out[:, 0] / scale

    # A step of a tenth at most: extremes of a state lie between two of them.
    found = solve_ivp(right, (0.0, 1.0), x / scale, method=method, rtol=ROUGH, atol=ROUGH, max_step=0.1)
    assert found.success, found.message
    return found.y.T * scale

"""Small systems with periodic orbits known in closed form, for the tests of this folder."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from small_systems import small_system

import contwalk as cw
from contwalk.branch import Branch
from contwalk.system import State

# Points of a walk are integrated to a tolerance this much coarser than the accuracy asked for special points.
WALKING = 100.0


def orbits(
    field: Callable[..., None],
    states: Sequence[str | State],
    parameters: dict[str, float],
    free: str,
    accuracy: float = 1e-8,
    method: str = "auto",
    **rest: Any,
) -> cw.PeriodicOrbit:
    """The periodic orbits of a small system."""
    system = small_system(field, states, parameters, **rest)
    chosen = cw.Discretization(accuracy=accuracy, method=method)
    return cw.PeriodicOrbit(system, system.defaults(), free, discretization=chosen)


def stuart_landau(
    rate: float = 1.0, cubic: float = 1.0, middle: float = 0.0, unit: float = 1.0
) -> Callable[..., None]:
    """Cycle of radius sqrt(mu / cubic) around (middle, 2 middle); period 2 pi / rate.

    The other multiplier is exp(-4 pi mu). `unit` is what the parameter counts as one.
    """

    def field(t, x, p, dx):
        u, v, mu = x[0] - middle, x[1] - 2.0 * middle, p.mu / unit
        square = cubic * (u * u + v * v)
        dx[0] = rate * (mu * u - v - u * square)
        dx[1] = rate * (u + mu * v - v * square)

    return field


def assert_stuart_landau(branch: Branch, rate: float, tolerance: float, unit: float = 1.0) -> None:
    """Periods and multipliers of all points of a branch are those of the closed form."""
    assert np.all(np.abs(branch["period"] * rate / (2.0 * math.pi) - 1.0) <= tolerance)
    true = np.exp(-4.0 * math.pi * branch["mu"] / unit)
    assert np.all(np.abs(branch.points["spectrum"][:, 0] - true) <= tolerance)
    assert np.all(branch["unstable"] == 0)


def moebius(apart: float, steep: float = 1.0, centre: float = 0.3) -> Callable[..., None]:
    """A cycle of period 2 pi with a transverse plane that turns half round, as a Moebius strip does.

    Its multipliers are exp(-4 pi), -exp(2 pi g) and -exp(-2 pi), where
    g = steep ((lam - centre)^2 - (apart / 2)^2): supercritical period doublings at
    lam = centre -+ apart / 2.
    """
    half = 0.5 * apart

    def field(t, x, p, dx):
        g = steep * ((p.lam - centre) ** 2 - half * half)
        square, q = x[0] ** 2 + x[1] ** 2, x[2] ** 2 + x[3] ** 2
        mean, spread = 0.5 * (g - 1.0) - q, 0.5 * (g + 1.0)
        dx[0] = x[0] - x[1] - x[0] * square
        dx[1] = x[0] + x[1] - x[1] * square
        dx[2] = mean * x[2] + spread * (x[0] * x[2] + x[1] * x[3]) - 0.5 * x[3]
        dx[3] = mean * x[3] + spread * (x[1] * x[2] - x[0] * x[3]) + 0.5 * x[2]

    return field


def moebius_branch(apart: float, accuracy: float = 1e-8, range: tuple[float, float] = (-0.5, 1.0)) -> Branch:
    """The cycle of `moebius` over its parameter."""
    problem = orbits(moebius(apart), "xyuv", {"lam": range[0]}, "lam", accuracy)
    return cw.continue_branch(problem, [1.0, 0.0, 0.0, 0.0], range, period=6.28)

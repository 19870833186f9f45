"""Systems whose periodic orbits, multipliers and normal forms are known in closed form, written as plugins.

All are built round the cycle r = 1 of r' = r (1 - r^2), phi' = omega, in smooth coordinates x + i y = r
exp(i phi).
A state that is zero on the cycle has no size but the declared scale, and normal forms are in units of it.
"""

from __future__ import annotations

import math
from typing import Any

from small_systems import small_system

import contwalk as cw
from contwalk.branch import Branch, SpecialPoint
from contwalk.system import State, System

ACCURACY = 1e-9


def orbits(system: System, free: str, accuracy: float = ACCURACY, **changes: Any) -> cw.PeriodicOrbit:
    """The problem of a small system's orbits."""
    chosen = cw.Discretization(accuracy=accuracy, **changes)
    return cw.PeriodicOrbit(system, system.defaults(), free, discretization=chosen)


def assert_met(point: SpecialPoint, name: str, truth: float, accuracy: float = ACCURACY) -> None:
    """The claimed error is an upper bound of the true one, and the accuracy that was asked for is met."""
    value = point.parameters[name]
    assert point.status == "located", point.note
    assert point.error is not None
    true = abs(value - truth)
    # `truth` is a float: it is itself known to half a rounding.
    assert true <= point.error + 2.3e-16 * abs(truth), f"true error {true}, estimate {point.error}"
    assert point.error <= accuracy * abs(truth), f"error {point.error}: {accuracy} was asked for"


def at_bound(branch: Branch, which: int = -1) -> Any:
    """The first or last row of a branch."""
    return branch.points[which]


def stuart_landau(
    matrix: tuple[float, float, float, float] = (1, 0, 0, 1), offset=(0.0, 0.0), **values: float
):
    """z' = (mu + i omega) z - (1 - i b) z |z|^2 in affine coordinates: (x, y) = offset + matrix (Re z, Im z).

    For mu > 0 the cycle |z|^2 = mu has the period 2 pi / (omega + b mu), the multiplier exp(-2 mu T).
    """
    a, b, c, d = matrix
    det = a * d - b * c

    def field(t, x, p, dx):
        u, v = x[0] - offset[0], x[1] - offset[1]
        re, im = (d * u - b * v) / det, (a * v - c * u) / det
        s = re**2 + im**2
        f = (p.mu - s) * re - (p.omega + p.b * s) * im
        g = (p.omega + p.b * s) * re + (p.mu - s) * im
        dx[0] = a * f + b * g
        dx[1] = c * f + d * g

    return small_system(field, "xy", {"mu": 1.0, "omega": 2.0, "b": 0.5, **values})


def bautin(omega: float = 3.0, b: float = 0.4) -> System:
    """r' = r (mu - 1 + r^2 - r^4), phi' = omega + b r^2 (Kuznetsov 2004, section 8.3).

    Cycles r^2 = 1/2 +- sqrt(mu - 3/4): a fold at mu = 3/4, r^2 = 1/2; a subcritical Hopf point at mu = 1.
    The multiplier is exp(T (2 r^2 - 4 r^4)).
    """

    def field(t, x, p, dx):
        s = x[0] ** 2 + x[1] ** 2
        g, w = p.mu - 1.0 + s - s * s, p.omega + p.b * s
        dx[0] = g * x[0] - w * x[1]
        dx[1] = w * x[0] + g * x[1]

    return small_system(field, "xy", {"mu": 0.9, "omega": omega, "b": b})


def transverse(
    growth, omega: float = 2.0, tilt: float = 0.0, scale: float | None = 1.0, **values: float
) -> System:
    """The unit cycle with one state across it: zeta' = growth(lam, zeta), z = zeta + tilt x.

    Multipliers of the cycle zeta = constant: exp(-2 T) and exp(T growth'), with T = 2 pi / omega.
    """

    def field(t, x, p, dx):
        s = x[0] ** 2 + x[1] ** 2
        dx[0] = (1.0 - s) * x[0] - p.omega * x[1]
        dx[1] = p.omega * x[0] + (1.0 - s) * x[1]
        dx[2] = growth(p, x[2] - tilt * x[0]) + tilt * dx[0]

    states = ("x", "y", State("z", scale=scale))
    return small_system(field, states, {"lam": 1.0, "omega": omega, **values})


def born_across(growth, unit: float, omega: float = 2.0) -> System:
    """Cycles x^2 + y^2 = lam from a Hopf point at lam = 0, zeta' = growth(lam, zeta) across them.

    z = zeta / unit is not declared a scale: as long as it is zero, nothing tells its size.
    """

    def field(t, x, p, dx):
        s = x[0] ** 2 + x[1] ** 2
        dx[0] = (p.lam - s) * x[0] - omega * x[1]
        dx[1] = omega * x[0] + (p.lam - s) * x[1]
        dx[2] = growth(p, unit * x[2]) / unit

    return small_system(field, "xyz", {"lam": -0.5})


def torus(nu: float, sigma: float, beta: float = 0.0, kappa: float = 0.0, omega: float = 1.5) -> System:
    """The unit cycle with a linear oscillator across it: w' = (lam - 1 + i nu + beta (r^2 - 1) + sigma
    |w|^2) w.

    The cycle is fed back by r' = r (1 - r^2 + kappa |w|^2), so that r^2 = 1 + kappa |w|^2 on the centre
    manifold and
    the cubic coefficient is sigma + beta kappa. Multipliers exp(T (lam - 1 +- i nu)): a Neimark-Sacker
    point at
    lam = 1 with the rotation number nu / omega and, with w = sqrt(2) zeta for |q| = 1 (declared unit scales),
    Re d = 2 T (sigma + beta kappa). The torus is |w|^2 = (1 - lam) / (sigma + beta kappa).
    """

    def field(t, x, p, dx):
        s, q = x[0] ** 2 + x[1] ** 2, x[2] ** 2 + x[3] ** 2
        g = 1.0 - s + kappa * q
        dx[0] = g * x[0] - p.omega * x[1]
        dx[1] = p.omega * x[0] + g * x[1]
        a = p.lam - 1.0 + beta * (s - 1.0) + sigma * q
        dx[2] = a * x[2] - p.nu * x[3]
        dx[3] = p.nu * x[2] + a * x[3]

    states = ("x", "y", State("u", scale=1.0), State("v", scale=1.0))
    return small_system(field, states, {"lam": 0.7, "omega": omega, "nu": nu})


def moebius(
    sigma: float, beta: float = 0.0, kappa: float = 0.0, omega: float = 2.0, scale: float | None = 1.0
) -> System:
    """The unit cycle in a Moebius band: across it, in a frame that makes half a turn a round, a and b obey

    a' = (lam - 1 + beta (r^2 - 1) + sigma a^2) a,  b' = -b / 2,  r' = r (1 - r^2 + kappa a^2).

    The projection on the frame's first vector, (1 + [[cos phi, sin phi], [sin phi, -cos phi]]) / 2, is smooth
    though the frame is not. Multipliers -exp(T (lam - 1)), -exp(-T / 2), exp(-2 T): a period doubling at
    lam = 1 with
    c = -T (sigma + beta kappa) for |q| = 1 (declared unit scales). On the doubled orbit
    a^2 = (1 - lam) / (sigma + beta kappa), r^2 = 1 + kappa a^2, its period is 2 T.
    """

    def field(t, x, p, dx):
        s = x[0] ** 2 + x[1] ** 2
        r = s**0.5
        cos, sin = x[0] / r, x[1] / r
        first = 0.5 * ((1.0 + cos) * x[2] + sin * x[3])  # the projection
        second = 0.5 * (sin * x[2] + (1.0 - cos) * x[3])
        square = first * first + second * second
        g = 1.0 - s + kappa * square
        dx[0] = g * x[0] - p.omega * x[1]
        dx[1] = p.omega * x[0] + g * x[1]
        a = p.lam - 1.0 + beta * (s - 1.0) + sigma * square
        dx[2] = a * first - 0.5 * (x[2] - first) - 0.5 * p.omega * x[3]
        dx[3] = a * second - 0.5 * (x[3] - second) + 0.5 * p.omega * x[2]

    states = ("x", "y", State("z", scale=scale), State("w", scale=scale))
    return small_system(field, states, {"lam": 0.7, "omega": omega})


def period_of(omega: float) -> float:
    """2 pi / omega."""
    return 2.0 * math.pi / omega

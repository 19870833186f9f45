"""The impact oscillator in closed form: its motion without impacts, and those with one impact in a duration.

Without impacts the displacement is a cosine of amplitude force / |(1 - omega^2, 2 zeta omega)|. With one
impact in the time T the free motion is that cosine w and a decaying part, which E = exp(A T) carries from
just after an impact, (gap, v) - w, to just before the next one, (gap, -v / restitution) - w. So w is
linear in v, and its amplitude gives a quadratic equation for v: two motions, which meet in a fold.
"""

from __future__ import annotations

import math
from types import SimpleNamespace

import mpmath


def parameters(omega: float, zeta: float, restitution: float = 0.8, force: float = 1.0) -> SimpleNamespace:
    return SimpleNamespace(omega=omega, zeta=zeta, restitution=restitution, force=force, gap=1.0)


def stiffness(p: SimpleNamespace) -> float:
    """Force over amplitude."""
    return math.hypot(1.0 - p.omega**2, 2.0 * p.zeta * p.omega)


def forced(p: SimpleNamespace, t: float) -> list[float]:
    """Displacement and velocity of the motion without impacts."""
    turn = p.omega * t - math.atan2(2.0 * p.zeta * p.omega, 1.0 - p.omega**2)
    amplitude = p.force / stiffness(p)
    return [amplitude * math.cos(turn), -p.omega * amplitude * math.sin(turn)]


class OneImpact:
    """The motions with one impact in a duration, to 30 digits, as functions of the force."""

    def __init__(self, p: SimpleNamespace, periods: int = 1) -> None:
        mp = mpmath.mpf
        self.omega, self.zeta, self.e, self.gap = mp(p.omega), mp(p.zeta), mp(p.restitution), mp(p.gap)
        self.duration = 2 * mpmath.pi * periods / self.omega
        self.carried = self.free(self.duration)
        left = mpmath.eye(2) - self.carried
        at_rest = mpmath.matrix([self.gap, 0])
        self.constant = mpmath.lu_solve(left, at_rest - self.carried * at_rest)
        self.slope = mpmath.lu_solve(
            left, mpmath.matrix([0, -1 / self.e]) - self.carried * mpmath.matrix([0, 1])
        )

    def free(self, t: mpmath.mpf) -> mpmath.matrix:
        return mpmath.expm(mpmath.matrix([[0, 1], [-1, -2 * self.zeta]]) * t)

    def product(self, a: mpmath.matrix, b: mpmath.matrix) -> mpmath.mpf:
        return a[0] * b[0] + a[1] * b[1] / self.omega**2

    @property
    def stiffness(self) -> mpmath.mpf:
        return mpmath.sqrt((1 - self.omega**2) ** 2 + (2 * self.zeta * self.omega) ** 2)

    def quadratic(self, force: mpmath.mpf) -> tuple[mpmath.mpf, mpmath.mpf, mpmath.mpf]:
        return (
            self.product(self.slope, self.slope),
            2 * self.product(self.slope, self.constant),
            self.product(self.constant, self.constant) - (force / self.stiffness) ** 2,
        )

    def fold(self) -> mpmath.mpf:
        """The force at which both motions are one."""
        a, b, c = self.quadratic(mpmath.mpf(0))
        return self.stiffness * mpmath.sqrt(c - b**2 / (4 * a))

    def velocity(self, force: mpmath.mpf, faster: bool) -> mpmath.mpf:
        """Just after the impact, where it is negative."""
        a, b, c = self.quadratic(force)
        root = mpmath.sqrt(b**2 - 4 * a * c)
        return (-b - root if faster else -b + root) / (2 * a)

    def wave(self, v: mpmath.mpf) -> mpmath.matrix:
        """Displacement and velocity of the cosine at the impact."""
        return self.constant + self.slope * v

    def at(self, v: mpmath.mpf, t: mpmath.mpf) -> mpmath.matrix:
        """Displacement and velocity a while after the impact."""
        w = self.wave(v)
        cosine, sine = mpmath.cos(self.omega * t), mpmath.sin(self.omega * t)
        turned = mpmath.matrix(
            [w[0] * cosine + w[1] / self.omega * sine, w[1] * cosine - w[0] * self.omega * sine]
        )
        return turned + self.free(t) * (mpmath.matrix([self.gap, v]) - w)

    def trace(self, v: mpmath.mpf) -> mpmath.mpf:
        """Of the derivative over an impact and a flight.

        Saltation is ((-e, 0), ((a_after + e a_before) / v_before, -e)) with the accelerations on both sides.
        """
        before = -v / self.e
        w = self.wave(v)
        # w'' = force cos(..) - 2 zeta w' - w = -omega^2 w tells what the force is at the impact.
        pushed = w[0] * (1 - self.omega**2) + 2 * self.zeta * w[1]
        first = pushed - 2 * self.zeta * before - self.gap
        second = pushed - 2 * self.zeta * v - self.gap
        saltation = mpmath.matrix([[-self.e, 0], [(second + self.e * first) / before, -self.e]])
        whole = saltation * self.carried
        return whole[0, 0] + whole[1, 1]

    def determinant(self) -> mpmath.mpf:
        return self.e**2 * mpmath.exp(-2 * self.zeta * self.duration)

    def doubling(self, guess: float, faster: bool) -> mpmath.mpf:
        """The force at which -1 is a multiplier."""
        return mpmath.findroot(
            lambda force: 1 + self.trace(self.velocity(force, faster)) + self.determinant(), guess
        )

    def touching(self, guess: tuple[float, float], faster: bool) -> mpmath.mpf:
        """The force at which the stop is touched again between impacts."""

        def equations(force: mpmath.mpf, t: mpmath.mpf) -> list[mpmath.mpf]:
            q, rate = self.at(self.velocity(force, faster), t)
            return [q - self.gap, rate]

        return mpmath.findroot(equations, guess)[0]

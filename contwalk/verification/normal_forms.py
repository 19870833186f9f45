"""Normal forms of orbits by finite differences of their own return map.

Notation and formulas of Yu. A. Kuznetsov, Elements of Applied Bifurcation Theory, 2004, section 5.4: A the
map's derivative, q and p its right and left critical vector, B and C its second and third derivatives.
Differences along q are taken at two lengths, the smaller of which loses as much to rounding as to its order.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import factorial

import numpy as np

from contwalk.verification.finding import CannotTell
from contwalk.verification.passage import EPSILON
from contwalk.verification.rounds import Round

# Values are taken at so many lengths on both sides.
NODES = range(-3, 4)


@dataclass(frozen=True)
class Told:
    """A coefficient, and how exactly differences tell it."""

    value: float
    error: float


def widest() -> float:
    """The length of third differences of the fourth order, in sizes of what is differentiated.

    A rounding over its third power is as large as its fourth power.
    """
    return EPSILON ** (1.0 / (3.0 + 4.0))


def shares(order: int) -> np.ndarray:
    """By what values at the nodes are multiplied for the derivative of an order, shape (7,).

    They give those of all powers up to the sixth.
    """
    powers = np.vander(np.array(NODES, dtype=float), increasing=True).T
    return np.linalg.solve(powers, float(factorial(order)) * np.eye(len(powers))[order])


class Differences:
    """Derivatives of a return map along curves.

    Parameters
    ----------
    round_ : Round
    unit : callable
        How long a direction xi, shape (r,), is in sizes of the orbit.
    length : float
        Of differences, in sizes of the orbit.
    """

    def __init__(self, round_: Round, unit: Callable[[np.ndarray], float], length: float) -> None:
        self.round, self.unit, self.length = round_, unit, length
        self.zero = round_(np.zeros(len(round_.matrix)))

    def curve(self, x1: np.ndarray, x2: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Second and third derivative of the image of s x1 + s^2 x2 / 2, both of shape (r,)."""
        if not x1.any():
            return np.zeros(len(x1)), np.zeros(len(x1))
        h = self.length / max(self.unit(x1), 1e-300)
        bend = np.zeros(len(x1)) if x2 is None else x2
        values = [self.zero if k == 0 else self.round(k * h * x1 + 0.5 * (k * h) ** 2 * bend) for k in NODES]
        return shares(2) @ np.array(values) / h**2, shares(3) @ np.array(values) / h**3

    def mixed(self, v: np.ndarray, w: np.ndarray) -> np.ndarray:
        """B(v, w) of real vectors, by polarisation."""
        return 0.25 * (self.curve(v + w)[0] - self.curve(v - w)[0])


def critical(matrix: np.ndarray, value: complex) -> tuple[np.ndarray, np.ndarray]:
    """q and p of an eigenvalue, shapes (r,), with p.q = 1."""
    left, _, right = np.linalg.svd(matrix - value * np.eye(len(matrix)))
    q, p = right[-1].conj(), left[:, -1].conj()
    if abs(value.imag) == 0.0:
        q, p = q.real, p.real
    return q, p / (p @ q)


def bordered(matrix: np.ndarray, q: np.ndarray, p: np.ndarray, right: np.ndarray) -> np.ndarray:
    """The solution of a singular system across its null vector q, shape (r,)."""
    whole = np.block([[matrix, p[:, None]], [q[None], np.zeros((1, 1))]])
    return np.asarray(np.linalg.solve(whole, np.append(right, 0.0))[:-1])


def flip(found: Differences) -> float:
    """c of xi -> -(1 + mu) xi + c xi^3, with the q of `critical`."""
    a = found.round.matrix
    q, p = critical(a, -1.0 + 0j)
    h = np.linalg.solve(np.eye(len(a)) - a, found.curve(q)[0])
    return float(p @ found.curve(q, h)[1]) / 6.0


def pitchfork(found: Differences) -> float:
    """c of xi -> xi + c xi^3 on the centre manifold."""
    a = found.round.matrix
    q, p = critical(a, 1.0 + 0j)
    h = bordered(a - np.eye(len(a)), q, p, -found.curve(q)[0])
    return float(p @ found.curve(q, h)[1]) / 6.0


def fold(found: Differences) -> float:
    """a b of xi -> xi + b mu + a xi^2, which no length of q changes."""
    q, p = critical(found.round.matrix, 1.0 + 0j)
    return 0.5 * float(p @ found.curve(q)[0]) * float(p @ found.round.by_free[:, 0])


def torus(found: Differences, theta: float) -> float:
    """Re d of a pair exp(+-i theta), by the harmonics of the curve s (exp(i phi) q + c.c.)."""
    turn, a = np.exp(1j * theta), found.round.matrix
    q, p = critical(a, complex(turn))
    one, turns = np.eye(len(a)), np.arange(4) * np.pi / 4.0

    def turned(v: np.ndarray, phi: float) -> np.ndarray:
        return np.asarray(2.0 * (np.exp(1j * phi) * v).real)

    def harmonic(sampled: dict[float, np.ndarray], order: int) -> np.ndarray:
        return np.asarray(np.mean([np.exp(-1j * order * phi) * v for phi, v in sampled.items()], axis=0))

    second = {phi: found.curve(turned(q, phi))[0] for phi in turns}
    h11 = np.linalg.solve(one - a, 0.5 * np.mean(list(second.values()), axis=0))
    h20 = np.linalg.solve(turn**2 * one - a, harmonic(second, 2))
    third = {phi: found.curve(turned(q, phi), turned(h20, 2.0 * phi) + 2.0 * h11)[1] for phi in turns}
    return float((np.conj(turn) * (p @ harmonic(third, 1))).real) / 6.0


def told(round_: Round, value: complex, form: Callable[[Differences], float]) -> Told:
    """A coefficient of a critical multiplier at two lengths of differences.

    Raises
    ------
    CannotTell
        If motions beside the orbit do not come back.
    """
    equations = round_.equations
    scale = equations._scale(round_.mode)

    def unit(xi: np.ndarray) -> float:
        return float(np.max(np.abs(round_.basis @ xi) / scale))

    length = straight(round_, unit, value)
    values = [form(Differences(round_, unit, times * length)) for times in (1.0, 0.5)]
    return Told(values[1], abs(values[1] - values[0]))


def straight(round_: Round, unit: Callable[[np.ndarray], float], value: complex) -> float:
    """A length over which what comes back along the critical vector is linear but for a tenth.

    Beyond it, as beside a canard, differences tell of other motions.
    """
    q, _ = critical(round_.matrix, value)
    length = widest()
    while length > EPSILON**0.5:
        along = 3.0 * length * q.real / max(unit(q.real), 1e-300)
        try:
            bent = [round_(way * along) - way * (round_.matrix @ along) for way in (1.0, -1.0)]
            if max(float(np.linalg.norm(each)) for each in bent) <= 0.1 * float(np.linalg.norm(along)):
                return length
        except CannotTell:
            pass
        length /= 4.0
    raise CannotTell("Beside the orbit no length is short enough for differences.")

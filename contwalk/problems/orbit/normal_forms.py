"""Normal forms of orbits: derivatives of the map that takes the section once round.

The first three derivatives of the map along curves are integrated (the jet lift); mixed ones follow by
polarisation. Where the period is unknown, it and the drifts of pinned directions change with the start so
that the end lies in the section and in the pins again: their own derivatives are found order by order.

Notation (docs/theory.md): A the map's derivative, B and C its second and third; q right and p left critical
vector with p.q = 1. |q| = 1 means that the deviation that starts as q has root mean square one over the
closure, across the flow and in units of half the range of each state: so the numbers do not depend on
where on the orbit the section lies. Formulas of Yu. A. Kuznetsov, Elements of Applied Bifurcation Theory,
2004, sections 5.4 and 8.7.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import numpy as np

from contwalk.errors import NotFinite
from contwalk.numerics.linear import bordered_by
from contwalk.system import System

EPSILON = float(np.finfo(float).eps)
# Beside deviations that are rounded by so much nothing is known of one that is one.
LOST = 100.0
# c11 this small against its terms is zero: a pitchfork.
EQUAL = 1e-5
# And where the cubic term takes over from the parameter, the quadratic one is this small a part of both,
LIKE = 1e-3
# or moves the parameter by this part of its magnitude only.
VANISHES = 1e-9
# A state that moves less than this part of its magnitude has no range on the orbit; its magnitude stands in.
# Where that is as small a part of what others move, it is the walk's least weight: nothing tells.
MOVES = 1e-5


class SectionMap(ABC):
    """The map of a section once round a closed orbit, with its derivatives along curves.

    Vectors are coordinates xi of shape (r,).
    """

    @property
    @abstractmethod
    def a(self) -> np.ndarray:
        """A, shape (r, r)."""

    @property
    @abstractmethod
    def by_parameter(self) -> np.ndarray:
        """Derivative of the map by the free parameter, shape (r,)."""

    @abstractmethod
    def curve(
        self, x1: np.ndarray, x2: np.ndarray | None = None, lam: float = 0.0, order: int = 3
    ) -> list[np.ndarray]:
        """First derivatives, up to `order`, of the image of the curve xi = s x1 + s^2 x2 / 2, lambda
        + s lam.
        """

    @abstractmethod
    def size(self, q: np.ndarray) -> float:
        """Root mean square over the closure of the deviation that starts as q, across the flow."""

    @abstractmethod
    def reach(self, q: np.ndarray) -> float:
        """How many times q, shape (r,), moves a state by its largest value on the orbit, at the section."""

    def unit_of_cubic(self, q: np.ndarray) -> float:
        """A cubic coefficient of a deviation q, shape (r,), by which deviations as large as the states on the
        orbit change by as much as they are; of smaller states than their units, by as large as the units.
        """
        return max(self.reach(q), 1.0) ** -2

    def critical(self, value: complex) -> tuple[np.ndarray, np.ndarray]:
        """q and p of an eigenvalue of A, |q| = 1 over the orbit and p @ q = 1; the largest entry of q is
        positive.

        Raises
        ------
        NotFinite
            If deviations grow so much that nothing is left of the critical one, or if it is a double one with
            one direction.
        """
        growth = float(np.linalg.norm(self.a, 2))
        if not growth * EPSILON < LOST:
            raise NotFinite(
                f"deviations grow by {growth:.1e} in a round, and the critical one is lost in them"
            )
        u, _, vh = np.linalg.svd(self.a - value * np.eye(len(self.a)))
        q, p = vh[-1].conj(), u[:, -1].conj()
        largest = q[np.argmax(np.abs(q))]
        q = q * np.conj(largest) / abs(largest) / self.size(q)
        if abs(p @ q) <= EPSILON * float(np.linalg.norm(q)):
            raise NotFinite("the critical multiplier is a double one that has a single direction")
        return q, p / (p @ q)

    def b(self, v: np.ndarray, w: np.ndarray, lv: float = 0.0, lw: float = 0.0) -> np.ndarray:
        """B(v, w) of real vectors, with components along the free parameter."""
        if v is w and lv == lw:
            return self.curve(v, None, lv, 2)[1]
        plus = self.curve(v + w, None, lv + lw, 2)[1]
        return 0.25 * (plus - self.curve(v - w, None, lv - lw, 2)[1])

    def b_complex(self, v: np.ndarray, w: np.ndarray) -> np.ndarray:
        """B(v, w) of complex vectors."""
        real = self.b(v.real, w.real) - self.b(v.imag, w.imag)
        return real + 1j * (self.b(v.real, w.imag) + self.b(v.imag, w.real))

    def c_squared(self, q: np.ndarray) -> np.ndarray:
        """C(q, q, q*) of a complex vector of shape (r,)."""
        r, i = q.real, q.imag
        cubes = {s: self.curve(r * s[0] + i * s[1])[2] for s in ((1, 0), (0, 1), (1, 1), (1, -1))}
        rri = (cubes[1, 1] - cubes[1, -1] - 2.0 * cubes[0, 1]) / 6.0
        rii = (cubes[1, 1] + cubes[1, -1] - 2.0 * cubes[1, 0]) / 6.0
        return np.asarray(cubes[1, 0] + rii + 1j * (rri + cubes[0, 1]))

    def c_twice(self, v: np.ndarray, w: np.ndarray) -> np.ndarray:
        """C(v, w, w) of a complex and a real vector."""
        parts = [
            (self.curve(w + x)[2] - self.curve(w - x)[2] - 2.0 * self.curve(x)[2]) / 6.0
            for x in (v.real, v.imag)
        ]
        return np.asarray(parts[0] + 1j * parts[1])

    def c_cubed(self, q: np.ndarray) -> np.ndarray:
        """C(q, q, q) of a complex vector."""
        r, i = q.real, q.imag
        once = self.c_twice(i + 0j, r).real, self.c_twice(r + 0j, i).real
        return np.asarray(self.curve(r)[2] - 3.0 * once[1] + 1j * (3.0 * once[0] - self.curve(i)[2]))


def units(system: System, states: np.ndarray, magnitudes: np.ndarray) -> np.ndarray:
    """What deviations of each state are measured in: half its range on the orbit, shape (n,).

    Of a state at rest its declared scale, or its magnitude; where it has none, what moves most stands in. One
    that not every mode has (NaN elsewhere) has no range.
    """
    half = 0.5 * np.ptp(states, axis=0)
    most = np.max(half, initial=0.0, where=np.isfinite(half))
    declared = np.array([state.scale is not None for state in system.states])
    known = declared | (magnitudes > MOVES * most)
    at_rest = np.where(known, magnitudes, most)
    return np.where(half > MOVES * magnitudes, half, at_rest)


def fold(map_: SectionMap) -> dict[str, Any]:
    """a = p.B(q,q) / 2 and b = p.P_lambda of xi -> xi + b mu + a xi^2."""
    q, p = map_.critical(1.0)
    return {
        "a": 0.5 * float(p @ map_.b(q, q)),
        "b": float(p @ map_.by_parameter),
        "convention": "return map xi -> xi + b mu + a xi^2, a = p.B(q,q)/2, |q| = 1 over the orbit, "
        "p.q = 1 (Kuznetsov 2004, section 5.4)",
    }


def cusp(map_: SectionMap) -> dict[str, Any]:
    """c of xi -> xi + c xi^3 at a fold whose quadratic coefficient is zero."""
    q, p = map_.critical(1.0)
    bordered = bordered_by(map_.a - np.eye(len(q)), q, p)
    h = bordered.solve(np.append(-map_.b(q, q), 0.0))[:-1]
    return {
        "c": float(p @ map_.curve(q, h)[2]) / 6.0,
        "convention": "return map xi -> xi + c xi^3, c = p.(C(q,q,q) - 3 B(q, (A-1)^-1 B(q,q)))/6, |q| = 1 "
        "over the orbit, p.q = 1 (Kuznetsov 2004, section 9.2)",
    }


def flip(map_: SectionMap) -> dict[str, Any]:
    """c of xi -> -(1 + mu) xi + c xi^3: positive where the doubled orbit is stable beside a stable one."""
    return {
        "c": cubic_of_flip(map_)[0],
        "convention": "return map xi -> -(1 + mu) xi + c xi^3, c = p.(C(q,q,q) + 3 B(q, (1 - A)^-1 "
        "B(q,q)))/6, "
        "|q| = 1 over the orbit, p.q = 1 (Kuznetsov 2004, section 5.4)",
    }


def cubic_of_flip(map_: SectionMap) -> tuple[float, float]:
    """c of a period doubling, and the size of the terms that it is the sum of."""
    q, p = map_.critical(-1.0)
    h = np.linalg.solve(np.eye(len(q)) - map_.a, map_.b(q, q))
    third = map_.curve(q)[2]
    total = map_.curve(q, h)[2]
    terms = float(np.abs(p) @ (np.abs(third) + np.abs(total - third))) / 6.0
    return float(p @ total) / 6.0, max(terms, map_.unit_of_cubic(q))


def torus(map_: SectionMap, theta: float) -> dict[str, Any]:
    """Re d of the normal form of a Neimark-Sacker point: negative where a stable torus surrounds."""
    return {
        "d": cubic_of_torus(map_, theta)[0].real,
        "theta": theta,
        "rotation_number": theta / (2.0 * np.pi),
        "convention": "Re d, d = exp(-i theta) p.(C(q,q,q*) + 2 B(q,(1-A)^-1 B(q,q*)) + "
        "B(q*,(exp(2 i theta)-A)^-1 B(q,q)))/2, |q| = 1 over the orbit, p.q = 1 "
        "(Kuznetsov 2004, section 5.4); theta in rad per closure",
    }


def cubic_of_torus(map_: SectionMap, theta: float) -> tuple[complex, float]:
    """d of a Neimark-Sacker point, and the size of the terms that it is the sum of.

    Along s (exp(i phi) q + c.c.) the second derivative of the map has B(q,q*) and B(q,q) as its harmonics in
    phi; with the second order of the invariant manifold the third one has what d is made of.

    On other steps than those that an orbit is a torus's on, its multiplier is not on the circle to rounding.
    Beside a third of a turn h20 is large, and of it d's real part is left only where that is so.
    """
    turn = np.exp(1j * theta)
    q, p = map_.critical(turn)
    a = map_.a + 2.0 * ((turn - p @ map_.a @ q) * np.outer(q, p)).real
    one = np.eye(len(q))
    turns = np.arange(4) * np.pi / 4.0  # the same lines for both orders, whose second derivatives are kept
    second = {phi: map_.curve(_turned(q, phi), None, 0.0, 2)[1] for phi in turns}
    h11 = np.linalg.solve(one - a, 0.5 * np.mean(list(second.values()), axis=0))
    h20 = np.linalg.solve(turn**2 * one - a, _harmonic(second, 2))
    third = {phi: map_.curve(_turned(q, phi), _turned(h20, 2.0 * phi) + 2.0 * h11)[2] for phi in turns}
    alone, whole = map_.curve(_turned(q, 0.0))[2], third[0.0]
    d = complex(np.conj(turn) * (p @ _harmonic(third, 1))) / 6.0
    terms = float(np.abs(p) @ (np.abs(alone) + np.abs(whole - alone))) / 6.0
    return d, max(terms, map_.unit_of_cubic(q))


def _turned(v: np.ndarray, phi: float) -> np.ndarray:
    """exp(i phi) v and its conjugate, added."""
    return np.asarray(2.0 * (np.exp(1j * phi) * v).real)


def _harmonic(sampled: dict[float, np.ndarray], order: int) -> np.ndarray:
    """The coefficient of exp(i order phi) of vectors sampled at evenly spaced phi."""
    return np.asarray(np.mean([np.exp(-1j * order * phi) * v for phi, v in sampled.items()], axis=0))


def branch_point(map_: SectionMap, weight: float) -> dict[str, Any]:
    """Coefficients of the branching equation c11 s^2 + 2 c12 s t + c22 t^2 = 0 and of the cubic term.

    `weight` is the typical magnitude of the free parameter.
    """
    q, p = map_.critical(1.0)
    shifted = map_.a - np.eye(len(q))
    bordered = bordered_by(shifted, q, p)
    h = bordered.solve(np.append(-map_.by_parameter, 0.0))[:-1]
    b11 = map_.b(q, q)
    c11 = float(p @ b11)
    c12, c22 = float(p @ map_.b(q, h, 0.0, 1.0)), float(p @ map_.b(h, h, 1.0, 1.0))
    h2 = bordered.solve(np.append(-b11, 0.0))[:-1]
    c = float(p @ map_.curve(q, h2)[2]) / 6.0
    terms = float(np.abs(p) @ np.abs(b11)) + abs(6.0 * c)
    if _is_pitchfork(c11, c, terms, abs(2.0 * c12 * weight)):
        c11 = 0.0
    return {
        "c11": c11,
        "c12": c12,
        "c22": c22,
        "c": c,
        "convention": "return map minus identity; c11 s^2 + 2 c12 s t + c22 t^2 = 0 for the directions "
        "s q + t h; "
        "c = p.(C(q,q,q) - 3 B(q, (A-1)^-1 B(q,q)))/6, |q| = 1 over the orbit, p.q = 1",
    }


def _is_pitchfork(c11: float, c: float, terms: float, drive: float) -> bool:
    """Whether c11 counts as zero: against its terms, and whatever the critical state is measured in.

    In another unit of the critical state c11 is multiplied by a factor and c by its square: only the
    second comparison does not depend on it.
    """
    small = abs(c11) <= EQUAL * max(terms, drive)
    return small and abs(c11) <= max(LIKE * float(np.sqrt(abs(c) * drive)), VANISHES * drive)

"""Collocation at Gauss points, of degrees 2 to 7 and so of orders 4 to 14 (and of 8, which tells errors).

On each step the motion is a polynomial of degree s that begins at the step's start and satisfies the
equation at the s zeros of the shifted Legendre polynomial. At the ends of steps its error is of order 2 s.
The steps are symmetric in time: what grows is carried as exactly as what decays.

Source: C. de Boor, B. Swartz, Collocation at Gaussian points, SIAM J. Numer. Anal. 10 (1973) 582-606; E.
Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd edition, IV.5.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

LEAST_DEGREE, MOST_DEGREE = 2, 8


@dataclass(frozen=True, eq=False)
class GaussPoints:
    """Collocation of one degree s, in terms of the increments Z of the state at the points.

    Its numbers are made when they are first asked for: most studies take no steps of this kind.

    Parameters
    ----------
    degree : int
        Degree of the polynomials, and number of points in a step.
    """

    degree: int

    @property
    def order(self) -> int:
        """Order of convergence at the ends of steps."""
        return 2 * self.degree

    @cached_property
    def nodes(self) -> np.ndarray:
        """The points, in 0..1, shape (s,)."""
        return 0.5 * (1.0 + np.polynomial.legendre.leggauss(self.degree)[0])

    @property
    def inverse(self) -> np.ndarray:
        """Derivatives of the polynomial at the points, shape (s, s): inverse Z = h f(x + Z)."""
        return self._matrices[0]

    @property
    def end(self) -> np.ndarray:
        """The polynomial at 1, shape (s,): x + end . Z."""
        return self._matrices[1]

    @cached_property
    def _matrices(self) -> tuple[np.ndarray, np.ndarray]:
        degree, places = self.degree, np.append(0.0, self.nodes)  # at the first it is zero: increments
        apart = places[:, None] - places[None, :]
        np.fill_diagonal(apart, 1.0)
        inverse, end = np.empty((degree, degree)), np.empty(degree)
        for j in range(1, degree + 1):
            others = np.arange(degree + 1) != j
            end[j - 1] = np.prod((1.0 - places[others]) / apart[j, others])
            for i in range(1, degree + 1):
                inverse[i - 1, j - 1] = _slope(places, apart, i, j)
        return inverse, end

    def packed(self) -> np.ndarray:
        """All numbers in one array, shape (s (s + 2),): nodes, `inverse` row by row, `end`."""
        return np.concatenate([self.nodes, self.inverse.ravel(), self.end])


@cache
def gauss_points(degree: int) -> GaussPoints:
    """Collocation at so many points.

    Raises
    ------
    ValueError
        If the degree is none of 2 to 8.
    """
    if not LEAST_DEGREE <= degree <= MOST_DEGREE:
        raise ValueError(f"a degree of {degree}, where {LEAST_DEGREE} to {MOST_DEGREE} are allowed")
    return GaussPoints(degree)


def _slope(places: np.ndarray, apart: np.ndarray, i: int, j: int) -> float:
    """Derivative at place i of the polynomial that is 1 at place j and 0 at the others."""
    count = len(places)
    if i == j:
        return float(sum(1.0 / apart[j, k] for k in range(count) if k != j))
    rest = [k for k in range(count) if k not in (i, j)]
    return float(np.prod(apart[i, rest] / apart[j, rest]) / apart[j, i])

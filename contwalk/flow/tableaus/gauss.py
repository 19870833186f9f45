"""Collocation at Gauss points, of degrees 2 to 7 and so of orders 4 to 14 (and of 8, which tells errors).

On each step the motion is a polynomial of degree s that begins at the step's start and satisfies the
equation at the s zeros of the shifted Legendre polynomial. At the ends of steps its error is of order 2 s.
The steps are symmetric in time: what grows is carried as exactly as what decays.

Source: C. de Boor, B. Swartz, Collocation at Gaussian points, SIAM J. Numer. Anal. 10 (1973) 582-606; E.
Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd edition, IV.5.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

LEAST_DEGREE, MOST_DEGREE = 2, 8


@dataclass(frozen=True, eq=False)
class GaussPoints:
    """Collocation of one degree s, in terms of the increments Z of the state at the points.

    Attributes
    ----------
    nodes : ndarray, shape (s,)
        The points, in 0..1.
    inverse : ndarray, shape (s, s)
        Derivatives of the polynomial at the points: inverse Z = h f(x + Z).
    end : ndarray, shape (s,)
        The polynomial at 1: x + end . Z.
    """

    nodes: np.ndarray
    inverse: np.ndarray
    end: np.ndarray

    @property
    def degree(self) -> int:
        """Degree of the polynomials, and number of points in a step."""
        return len(self.nodes)

    @property
    def order(self) -> int:
        """Order of convergence at the ends of steps."""
        return 2 * self.degree

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
    nodes = 0.5 * (1.0 + np.polynomial.legendre.leggauss(degree)[0])
    places = np.append(0.0, nodes)  # the polynomial is zero at the first: increments count from there
    apart = places[:, None] - places[None, :]
    np.fill_diagonal(apart, 1.0)
    inverse, end = np.empty((degree, degree)), np.empty(degree)
    for j in range(1, degree + 1):
        others = np.arange(degree + 1) != j
        end[j - 1] = np.prod((1.0 - places[others]) / apart[j, others])
        for i in range(1, degree + 1):
            inverse[i - 1, j - 1] = _slope(places, apart, i, j)
    return GaussPoints(nodes, inverse, end)


def _slope(places: np.ndarray, apart: np.ndarray, i: int, j: int) -> float:
    """Derivative at place i of the polynomial that is 1 at place j and 0 at the others."""
    count = len(places)
    if i == j:
        return float(sum(1.0 / apart[j, k] for k in range(count) if k != j))
    rest = [k for k in range(count) if k not in (i, j)]
    return float(np.prod(apart[i, rest] / apart[j, rest]) / apart[j, i])

"""Functions of z that vanish where the linearised equations have a critical eigenvalue, with derivatives.

With a column w and a row v the matrix of

    [ F_u - s E   w ] [ q ]   [ 0 ]
    [ v           0 ] [ g ] = [ 1 ]

is regular where s is a simple eigenvalue, and g(z, s) vanishes there and nowhere else (Govaerts 2000,
Numerical Methods for Bifurcations of Dynamical Equilibria, section 4.1). E is one for states and zero for
drifts. A zero eigenvalue is g(z, 0) = 0. A pair s, -s with s^2 = -kappa is g = 0 at both; with
g = alpha + s beta, computed in the numbers a + s b, that is alpha = beta = 0: imaginary for positive kappa,
real for negative (a neutral saddle), and a double zero (Bogdanov-Takens) for kappa = 0, where the conditions
are as regular as elsewhere. Derivatives by z are -p (F_u)_z q with the left vector p of the same matrix.
An eigenvalue whose real part is sigma is one of F_u - sigma E whose real part is zero.

A branch point is where DF by states and one parameter, (N, N + 1), loses rank: with one column and two rows
as borders there are two such functions, and both vanish.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from contwalk.numerics.linear import EPSILON, balanced
from contwalk.problems.locus.plane import FloatPlace, Place

# Two vectors whose angle has a smaller cosine than this tell no sum; a singular value that is a larger part
# of the next one tells no vector.
UNTOLD = 0.1

# Gives of a square matrix the function that applies its inverse.
Solver = Callable[[np.ndarray], Callable[[np.ndarray], np.ndarray]]


@dataclass(frozen=True)
class Borders:
    """The column w and the row v, shape (N,) each."""

    column: np.ndarray
    row: np.ndarray


@dataclass(frozen=True)
class Critical:
    """What a bordered matrix tells: g = value[0] + s value[1], q and p in the same way, shape (N,) each.

    Of a zero eigenvalue there is only the first of each.
    """

    values: tuple[np.ndarray, ...]
    right: tuple[np.ndarray, ...]
    left: tuple[np.ndarray, ...]

    @property
    def vector(self) -> np.ndarray:
        """q at s = i omega, or at s = 0: its first part, shape (N,)."""
        return self.right[0]


def zero_borders(matrix: np.ndarray, units: np.ndarray | None = None) -> Borders:
    """Borders for a zero eigenvalue of F_u, shape (N, N), from its singular vectors.

    These are taken in balanced units, or in given ones, shape (N,): near an invariant face balance is lost.
    Of a matrix that is nilpotent but for roundings, as of a conservative motion at its fold, balance makes
    one of several small singular values: then they are taken in the states' own units, if these tell one.
    """
    scaled, d = balanced(matrix) if units is None else (matrix * units / units[:, None], units)
    u, values, vh = np.linalg.svd(scaled)
    if units is None and _next_to_least(values) > UNTOLD:
        own = np.linalg.svd(matrix)
        if _next_to_least(own[1]) < UNTOLD:
            (u, _, vh), d = own, np.ones(len(matrix))
    return _borders(vh[-1], u[:, -1], d)


def _next_to_least(values: np.ndarray) -> float:
    """The least singular value against the next one, of shape (N,); zero of one alone."""
    return float(values[-1] / values[-2]) if len(values) > 1 and values[-2] > 0.0 else 0.0


def pair_borders(matrix: np.ndarray, finite: np.ndarray, kappa: float) -> Borders:
    """Borders for the eigenvalues s and -s with s^2 = -kappa, the same for both.

    In balanced units the row is the sum of both right vectors, turned to each other: it is at a right angle
    to neither of them, nor to the vector that they become where they meet. Balanced, two vectors that nearly
    meet may be at a right angle to each other, and tell no such sum: then it is taken in the states' own
    units.

    The matrix is F_u, shape (N, N), `finite` which unknowns have rates, shape (N,).
    """
    scaled, d = balanced(matrix)
    right, left = _pair_vectors(scaled, finite, kappa)
    if min(_sum_told(right), _sum_told(left)) < UNTOLD:
        scaled, d = matrix, np.ones(len(matrix))
        right, left = _pair_vectors(scaled, finite, kappa)
    return _borders(_turned_sum(right), _turned_sum(left), d)


def _pair_vectors(matrix: np.ndarray, finite: np.ndarray, kappa: float) -> tuple[np.ndarray, np.ndarray]:
    """Both right and both left vectors of s and -s, units, each of the shape (2, N)."""
    s = 1j * np.sqrt(kappa) if kappa > 0.0 else np.sqrt(-kappa)
    first, second = (np.linalg.svd(matrix - sign * s * np.diag(finite)) for sign in (1.0, -1.0))
    return np.array([first[2][-1], second[2][-1]]).conj(), np.array([first[0][:, -1], second[0][:, -1]])


def _sum_told(pair: np.ndarray) -> float:
    """How far two vectors, shape (2, N), are from a right angle to each other: a cosine."""
    first, second = pair
    return float(abs(np.sum(first * first))) if np.iscomplexobj(pair) else float(abs(first @ second))


def _turned_sum(pair: np.ndarray) -> np.ndarray:
    """The sum of two vectors, shape (2, N), turned to each other, real, shape (N,)."""
    first, second = pair
    return major(first) if np.iscomplexobj(pair) else towards(second, first) + first


def major(v: np.ndarray) -> np.ndarray:
    """The real part of a complex vector, turned so that it is as long as possible.

    v has the shape (N,).
    """
    turned = v * np.exp(-0.5j * np.angle(np.sum(v * v)))
    return np.asarray(turned.real)


def towards(v: np.ndarray, other: np.ndarray) -> np.ndarray:
    """A vector or its opposite, whichever is at no obtuse angle to another one.

    v has the shape (N,).
    """
    return v if v @ other >= 0.0 else -v


def _borders(right: np.ndarray, left: np.ndarray, d: np.ndarray) -> Borders:
    """Borders for vectors in balanced units: row @ q = p @ column = 1, the largest entry of q positive."""
    right = right * np.sign(right[np.argmax(np.abs(right))])
    left = left * np.sign(left[np.argmax(np.abs(left))])
    scale = float(np.linalg.norm(right * d))  # q = right d, of length one
    return Borders(left * d / (left @ left), right / d * (scale / (right @ right)))


def shifted(place: Place, sigma: float) -> np.ndarray:
    """F_u - sigma E, shape (N, N)."""
    if sigma == 0.0:
        return place.matrix
    e = np.diag(place.plane.finite)
    return place.matrix - sigma * (e.astype(object) if place.matrix.dtype == object else e)


def zero_condition(place: Place, borders: Borders, sigma: float = 0.0) -> Critical:
    """g(z, sigma) with its vectors."""
    matrix = shifted(place, sigma)
    bordered = np.block([[matrix, borders.column[:, None]], [borders.row[None, :], np.zeros((1, 1))]])
    unit = _unit(len(bordered))
    right, left = place.solver(bordered)(unit), place.solver(bordered.T)(unit)
    return Critical((right[-1],), (right[:-1],), (left[:-1],))


def pair_condition(place: Place, borders: Borders, kappa: object, sigma: float = 0.0) -> Critical:
    """alpha, beta of g(z, sigma + s) = alpha + s beta with s^2 = -kappa, and q and p in the same numbers."""
    matrix = shifted(place, sigma)
    bordered = np.block([[matrix, borders.column[:, None]], [borders.row[None, :], np.zeros((1, 1))]])
    e = np.diag(np.append(place.plane.finite, 0.0))
    if bordered.dtype == object:
        e = e.astype(object)
    unit = _unit(2 * len(bordered), len(bordered) - 1)
    size = len(bordered)
    parts = []
    for one in (bordered, bordered.T):
        solved = place.solver(np.block([[one, kappa * e], [-e, one]]))(unit)
        parts.append((solved[:size], solved[size:]))
    (qa, qb), (pa, pb) = parts
    return Critical((qa[-1], qb[-1]), (qa[:-1], qb[:-1]), (pa[:-1], pb[:-1]))


def _unit(size: int, which: int = -1) -> np.ndarray:
    unit = np.zeros(size)
    unit[which] = 1.0
    return unit


def gradients(place: Place, found: Critical, kappa: Any) -> np.ndarray:
    """Derivatives of the values by z, shape (1, N + 2), or of alpha and beta by z and kappa, (2, N + 3)."""
    slopes = [place.slopes(q) for q in found.right]
    if len(found.right) == 1:
        return -(found.left[0] @ slopes[0])[None, :]
    (pa, pb), (sa, sb) = found.left, slopes
    by_z = -np.array([pa @ sa - kappa * (pb @ sb), pa @ sb + pb @ sa])
    e = place.plane.finite
    by_kappa = -np.array([pa @ (e * found.right[1]), pb @ (e * found.right[1])])
    return np.column_stack([by_z, by_kappa])


def levels(place: FloatPlace, found: Critical, kappa: float) -> np.ndarray:
    """Rounding of the values, shape (1,) or (2,), from that of the entries of F_u."""
    noise = place.noise
    right, left = [np.abs(q) for q in found.right], [np.abs(p) for p in found.left]
    if len(right) == 1:
        return np.array([left[0] @ noise @ right[0]])
    (qa, qb), (pa, pb) = right, left
    return np.array([pa @ noise @ qa + abs(kappa) * (pb @ noise @ qb), pa @ noise @ qb + pb @ noise @ qa])


# -- branch points -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class CrossingBorders:
    """A column, shape (M,), and two rows, shape (2, M + 1), for a matrix of shape (M, M + 1).

    `dual`, shape (M,), takes the column to one; `least` is the rounding of what it makes of equations with
    terms as large as they are told to be.
    """

    column: np.ndarray
    rows: np.ndarray
    dual: np.ndarray
    least: float

    def rounding(self, levels: np.ndarray) -> float:
        """What roundings of the first k equations, shape (k,), could pass for an unfolding."""
        return self.least + float(np.abs(self.dual[: len(levels)]) @ levels)


@dataclass(frozen=True)
class Deficient:
    """What a matrix with these borders tells: its two values, q_1 and q_2, shape (M + 1,) each, and p, (M,).

    The matrix takes what vanishes of both vectors, and p it, to zero.
    """

    values: tuple[np.ndarray, ...]
    right: tuple[np.ndarray, ...]
    left: np.ndarray


def crossing_borders(jacobian: np.ndarray, rows: np.ndarray, weights: np.ndarray) -> CrossingBorders:
    """Borders for a loss of rank of DF, shape (M, M + 1).

    `rows` are the sizes of the equations' terms, shape (M,), and `weights` magnitudes of the unknowns, shape
    (M + 1,). A row that is nothing but rounding must not be scaled by itself.
    """
    scaled = jacobian * weights / rows[:, None]
    u, _, vh = np.linalg.svd(scaled)
    left = u[:, -1] * np.sign(u[np.argmax(np.abs(u[:, -1])), -1])
    terms = np.maximum(np.abs(scaled).max(axis=1), 1.0)
    least = EPSILON * float(np.max(np.abs(left) * terms))
    return CrossingBorders(left * rows, vh[-2:] / weights, left / rows, least)


def deficient(jacobian: np.ndarray, borders: CrossingBorders, solver: Solver) -> Deficient:
    """The two values of a matrix, shape (M, M + 1), with its vectors; `solver` applies inverses."""
    size = len(jacobian)
    bordered = np.block([[jacobian, borders.column[:, None]], [borders.rows, np.zeros((2, 1))]])
    right = [solver(bordered)(_unit(size + 2, size + k)) for k in (0, 1)]
    left = solver(bordered.T)(_unit(size + 2))
    return Deficient(tuple(q[-1] for q in right), tuple(q[:-1] for q in right), left[:size])

"""Small dense linear algebra, scaled so that units of equations and unknowns do not matter."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

EPSILON = float(np.finfo(float).eps)
# A row below the smallest normal float is zero: its inverse would overflow.
SMALLEST = float(np.finfo(float).tiny)


def equilibration(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Row and column factors, shapes (m,) and (n,), after which the largest entry of each is about one.

    Factors are powers of two, so that scaling is free of rounding; the work is done on exponents.
    """
    exponents = np.frexp(np.abs(matrix))[1]
    exponents[matrix == 0] = _NO_ENTRY
    rows, columns = np.zeros(matrix.shape[0], dtype=int), np.zeros(matrix.shape[1], dtype=int)
    for _ in range(5):  # D. Ruiz (2001): half of each excess from the rows, half from the columns
        excess = _largest(exponents, 1)
        half = (excess + 1) >> 1
        rows -= half
        exponents -= half[:, None]
        excess = _largest(exponents, 0)
        half = (excess + 1) >> 1
        columns -= half
        exponents -= half
        if np.minimum.reduce(excess) > -2 and np.maximum.reduce(excess) < 2:
            break
    rows -= _largest(exponents, 1)
    return _power(rows), _power(columns)


_NO_ENTRY = -100_000
# Factors end where normal floats do: of what has diverged no others are needed.
_LEAST, _MOST = -1022, 1022


def _power(exponents: np.ndarray) -> np.ndarray:
    """Powers of two, the nearest to those asked for that are floats."""
    return np.ldexp(1.0, np.minimum(np.maximum(exponents, _LEAST), _MOST))


def _largest(exponents: np.ndarray, axis: int) -> np.ndarray:
    """Largest exponents along an axis; 0 for a row or column of zeros."""
    found = np.maximum.reduce(exponents, axis)
    found[found <= _NO_ENTRY // 2] = 0
    return found


class Factorization(ABC):
    """A square matrix prepared for solving with it; what raises does so where it is exactly singular."""

    @abstractmethod
    def solve(self, right: np.ndarray) -> np.ndarray:
        """x with matrix @ x = right, of one right-hand side, shape (n,), or columns of them, (n, k).

        Raises
        ------
        numpy.linalg.LinAlgError
        """

    @abstractmethod
    def solve_adjoint(self, right: np.ndarray) -> np.ndarray:
        """y with matrix* @ y = right, of one right-hand side, shape (n,), or columns of them, (n, k).

        Raises
        ------
        numpy.linalg.LinAlgError
        """

    @abstractmethod
    def orientation(self) -> float:
        """Sign of the determinant."""

    @abstractmethod
    def error(self, levels: np.ndarray, weights: np.ndarray) -> float:
        """What errors `levels` (m,) of the first equations do to the solution in the metric (n,), at most."""


class Factored(Factorization):
    """A square matrix, equilibrated; `solve` applies its inverse.

    Where typical magnitudes of the unknowns are known (`weights`), they scale the columns, which is cheaper.
    """

    def __init__(self, matrix: np.ndarray, weights: np.ndarray | None = None) -> None:
        if weights is None:
            self.rows, self.columns = equilibration(matrix)
            self._scaled = matrix * self.rows[:, None] * self.columns
        else:
            self.columns = weights
            scaled = matrix * weights
            largest = np.abs(scaled).max(axis=1)
            self.rows = 1.0 / np.where(largest > SMALLEST, largest, 1.0)
            self._scaled = scaled * self.rows[:, None]

    def solve(self, right: np.ndarray) -> np.ndarray:
        """x with matrix @ x = right, of one right-hand side, shape (n,), or columns of them, (n, k)."""
        return (self.columns * np.linalg.solve(self._scaled, (self.rows * right.T).T).T).T

    def solve_adjoint(self, right: np.ndarray) -> np.ndarray:
        """y with matrix* @ y = right, of one right-hand side, shape (n,), or columns of them, (n, k)."""
        return (self.rows * np.linalg.solve(self._scaled.conj().T, (self.columns * right.T).T).T).T

    def orientation(self) -> float:
        """Sign of the determinant."""
        return float(np.linalg.slogdet(self._scaled)[0])

    def condition(self) -> float:
        """Condition number of the equilibrated matrix."""
        return float(np.linalg.cond(self._scaled))

    def regular(self, errors: np.ndarray) -> bool:
        """Whether no matrix is singular whose entries are within errors, shape (n, n), of these.

        The spectral radius of |A^-1| E is below one, in whatever units of equations and unknowns (J. W.
        Demmel, SIAM J. Matrix Anal. Appl. 13, 10, 1992): a slow state beside a fast one is no matter.
        """
        if not np.isfinite(self._scaled).all():
            return False
        try:
            inverse = np.abs(np.linalg.inv(self._scaled))
        except np.linalg.LinAlgError:
            return False
        moved = inverse @ (errors * self.rows[:, None] * self.columns)
        return bool(np.isfinite(moved).all() and np.abs(np.linalg.eigvals(moved)).max() < 1.0)

    def error(self, levels: np.ndarray, weights: np.ndarray) -> float:
        """What errors `levels` (m,) of the first equations do to the solution in the metric (n,), at most."""
        count = len(levels)
        inverse = np.linalg.inv(self._scaled)[:, :count]
        with np.errstate(over="ignore"):  # as good as singular: nothing is known
            return float(np.max((np.abs(inverse) @ (self.rows[:count] * levels)) * (self.columns / weights)))


class LeastSquares:
    """A square matrix of deficient rank, equilibrated; `solve` gives the shortest least-squares solution."""

    def __init__(self, matrix: np.ndarray) -> None:
        self.rows, self.columns = equilibration(matrix)
        self._inverse = np.linalg.pinv(matrix * self.rows[:, None] * self.columns, rcond=1e-9)

    def solve(self, right: np.ndarray) -> np.ndarray:
        """x, shape (n,), nearest to matrix @ x = right."""
        return self.columns * (self._inverse @ (self.rows * right))


def norm(vector: np.ndarray) -> float:
    """Euclidean norm of a real vector, shape (n,), contiguous: the same bits as `numpy.linalg.norm` gives.

    Of short vectors most of that one's time is looking at what it is given.
    """
    return math.sqrt(vector.dot(vector))


def norm_in(step: np.ndarray, weights: np.ndarray) -> float:
    """Norm of a step in the metric of `weights`, both of shape (n,): that of step / weights."""
    return norm(step / weights)


def unit_in(tangent: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """The unit vector along a tangent in the metric of `weights`, all of shape (n,).

    A stored tangent is a unit vector already and stays as it is: dividing would change its last digits.
    """
    length = norm_in(tangent, weights)
    return tangent if abs(length - 1.0) < 1e-14 else tangent / length


def parameter_held(weights: np.ndarray) -> np.ndarray:
    """The normal of corrections that keep the last unknown, the free parameter; both of shape (n,)."""
    return np.append(np.zeros(len(weights) - 1), 1.0 / weights[-1])


def kernel_direction(matrix: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """The vector, shape (n + 1,), that an (n, n + 1) matrix takes to zero, a unit in the metric.

    It is asked for where a branch begins and no neighbour gives a border: that is what the SVD is for.
    """
    scaled = matrix * weights
    largest = np.abs(scaled).max(axis=1, keepdims=True)
    return np.linalg.svd(scaled / np.where(largest > 0, largest, 1.0))[2][-1] * weights


# A coupling so many times the diagonal is one of units, and not one beside a double zero.
ONE_WAY = 1e12


def balanced(matrix: np.ndarray, one_way: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """D^-1 A D, shape (n, n), with rows and columns of like norm, and the diagonal of D, shape (n,).

    Its entries are powers of two.

    Eigenvalues of a matrix whose states have very different units are accurate only after this
    (E. E. Osborne, J. ACM 7, 338, 1960). Of a state that only drives others, or is only driven, units may be
    anything: `one_way` couplings, which nothing answers, are made as large as the diagonal where they are
    beyond comparison with it. Not where ranks are judged: beside a double zero no diagonal is left, and the
    coupling makes it one of one vector.
    """
    size = len(matrix)
    d = np.ones(size)
    magnitude = np.abs(matrix)
    least = float(magnitude.diagonal().max(initial=0.0))
    magnitude.flat[:: size + 1] = 0.0
    unanswered = _unanswered(magnitude, least) if one_way else None
    for _ in range(20):
        rows, columns = magnitude.sum(axis=1), magnitude.sum(axis=0)
        if unanswered is not None:
            only_drive, only_driven = unanswered
            rows, columns = (
                np.where(only_drive & (columns > least), least, rows),
                np.where(only_driven & (rows > least), least, columns),
            )
        ratio = np.divide(rows, columns, out=np.ones(size), where=(rows > 0) & (columns > 0))
        exponents = np.rint(0.25 * np.log2(ratio))
        if not exponents.any():
            break
        factor = np.exp2(exponents)
        magnitude = magnitude / factor[:, None] * factor
        d *= factor
    return matrix / d[:, None] * d, d


def _unanswered(magnitude: np.ndarray, least: float) -> tuple[np.ndarray, np.ndarray] | None:
    """Which states only drive others, and which are only driven, beyond comparison with the diagonal.

    Each is a bool of shape (n,); None where there is no such state. `magnitude`, shape (n, n), has no
    diagonal, of which `least` is the largest entry.
    """
    rows, columns = magnitude.sum(axis=1), magnitude.sum(axis=0)
    found = (rows == 0.0) & (columns > ONE_WAY * least), (columns == 0.0) & (rows > ONE_WAY * least)
    return found if least > 0.0 and np.any(found) else None


@dataclass(frozen=True)
class EigenPair:
    """An eigenvalue with its vectors, |right| = 1 and left . right = 1, and its estimated absolute error.

    `right` and `left` have length n; A right = value right, left A = value left.
    """

    value: complex
    right: np.ndarray
    left: np.ndarray
    error: float


def nearest_eigenpair(matrix: np.ndarray, value: complex) -> EigenPair:
    """The eigenvalue of an (n, n) matrix nearest to `value`, with |right| = 1 and left . right = 1."""
    scaled, d = balanced(matrix)
    values, right = np.linalg.eig(scaled)
    transposed, left = np.linalg.eig(scaled.T)
    k = int(np.argmin(np.abs(values - value)))
    row = left[:, int(np.argmin(np.abs(transposed - values[k])))]
    q, p = right[:, k] * d, row / d
    q = q / np.linalg.norm(q)
    product = p @ q
    p = p / (product if abs(product) > 1e-12 * np.linalg.norm(p) else np.linalg.norm(p))
    condition = float(np.linalg.norm(p * d) * np.linalg.norm(q / d))
    return EigenPair(complex(values[k]), q, p, EPSILON * float(np.linalg.norm(scaled)) * condition)


def critical_pair(matrix: np.ndarray, errors: np.ndarray | None = None) -> EigenPair:
    """Null vectors q and p of a real (n, n) matrix that is nearly singular: |q| = 1 and p.q = 1.

    They are singular vectors of the balanced matrix. Balancing does not change eigenvalues, so a small one
    cannot hide behind units as it can behind a scaling of rows and columns; and singular vectors are
    accurate where a double zero makes eigenvectors meet. There, with p.q = 0, p is scaled by p.r = 1 with A
    r = q. Where `errors` of the entries are known, shape (n, n), they tell which of several small eigenvalues
    is zero, and whether p.q is: one that is slow is no more zero than another.
    """
    if errors is None:
        scaled, d = balanced(matrix, one_way=True)
        rows, columns = 1.0 / d, d
    else:
        rows, columns = _by_errors(matrix, errors)
        scaled = matrix * rows[:, None] * columns
    u, values, vh = np.linalg.svd(scaled)
    # In balanced units every entry is as large as it matters; what is far below is noise.
    v, w = (np.where(np.abs(x) < 1e-13, 0.0, x) for x in (vh[-1], u[:, -1]))
    error = EPSILON * float(values[0]) * len(values)
    if errors is not None:
        return _refined_pair(matrix, errors, v * columns, w * rows)
    product = float(w @ v)
    if abs(product) < 1e-6:
        generalized = np.linalg.lstsq(scaled, v, rcond=1e-9)[0]
        product = float(w @ generalized) if abs(w @ generalized) > 1e-12 else 1.0
    length = float(np.linalg.norm(v * d))
    return EigenPair(float(values[-1]), v * d / length, w / d * (length / product), error)


def _by_errors(matrix: np.ndarray, errors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Factors of rows and columns, shape (n,), after which all rows are known to the same: that to which the
    errors make the matrix singular first.

    With h the Perron vector of |A^-1| E they are 1 / (E h) and h (as in `Factored.regular`).
    """
    size = len(matrix)
    units = equilibration(np.abs(matrix) + errors)
    known = errors * units[0][:, None] * units[1]
    least = EPSILON**2 * np.maximum(known.max(), 1.0)  # what is zero exactly is known to as good as that
    known = known + least * np.eye(size)
    scaled = matrix * units[0][:, None] * units[1]
    inverse = np.abs(np.linalg.pinv(scaled + least * np.eye(size), rcond=0.0))
    values, vectors = np.linalg.eig(inverse @ known)
    perron = np.abs(vectors[:, int(np.argmax(np.abs(values)))])
    perron = np.maximum(perron, EPSILON**2 * perron.max())
    return units[0] / (known @ perron), units[1] * perron


def _refined_pair(matrix: np.ndarray, errors: np.ndarray, q: np.ndarray, p: np.ndarray) -> EigenPair:
    """Null vectors near given ones, shape (n,), all entries as exact as the matrix, shape (n, n), tells."""
    size, unit = len(matrix), np.append(np.zeros(len(matrix)), 1.0)
    q, p = q / np.linalg.norm(q), p / np.linalg.norm(p)
    bordered = bordered_by(matrix, q, p)
    try:
        q, p = bordered.solve(unit)[:size], bordered.solve_adjoint(unit)[:size]
        inverse = bordered.solve(np.eye(size + 1))[:size, :size]
    except np.linalg.LinAlgError:  # more than one is zero
        inverse = np.zeros_like(matrix)
    q = q / np.linalg.norm(q)
    product = float(p @ q)
    apart = np.abs(inverse)
    if abs(product) <= float(np.abs(p) @ (errors @ apart + apart @ errors) @ np.abs(q)):
        product = float(p @ inverse @ q) or 1.0
    p = p / product
    return EigenPair(float(p @ matrix @ q), q, p, float(np.abs(p) @ errors @ np.abs(q)))


def solution_plane(jacobian: np.ndarray, pair: EigenPair) -> np.ndarray:
    """The two directions in which solutions can leave a branch point, (q, 0) and (h, 1), shape (N + 1, 2).

    Parameters
    ----------
    jacobian : ndarray, shape (N, N + 1)
        DF, with F_u nearly singular.
    pair : EigenPair
        Its critical vectors q and p; h solves F_u h = -F_lambda in the complement of q.
    """
    size = len(jacobian)
    q, p = pair.right.real, pair.left.real
    h = bordered_by(jacobian[:, :size], q, p).solve(np.append(-jacobian[:, -1], 0.0))[:size]
    return np.column_stack([np.append(q, 0.0), np.append(h, 1.0)])


def bordered_by(matrix: np.ndarray, q: np.ndarray, p: np.ndarray) -> Factored:
    """A singular (n, n) matrix bordered by its critical vectors, shape (n,), regular if it has no others."""
    return Factored(np.block([[matrix, p[:, None]], [q[None, :], np.zeros((1, 1))]]))


@dataclass(frozen=True)
class Deficiency:
    """Where DF, shape (N, N + 1), is nearest to losing rank.

    `value` and `next` are its smallest singular values against the largest one, rows and columns scaled;
    `left`, shape (N,), belongs to the smallest, and `plane`, shape (N + 1, 2), is what is taken to least.
    """

    value: float
    next: float
    left: np.ndarray
    plane: np.ndarray


def deficiency(jacobian: np.ndarray, weights: np.ndarray) -> Deficiency:
    """The nearest loss of rank of DF, shape (n, n + 1), balanced, the parameter in units of its weight.

    Rows are not scaled each by itself: one that is zero but for rounding would count like any other.
    """
    size = len(jacobian)
    d = balanced(jacobian[:, :size])[1]
    d = d * np.max(weights[:size] / d)
    rows, columns = 1.0 / d, np.append(d, weights[-1])
    u, values, vh = np.linalg.svd(jacobian * rows[:, None] * columns)
    v, w = (np.where(np.abs(x) < 1e-13, 0.0, x) for x in (vh[-2:].T, u[:, -1]))
    least = values[-2] if len(values) > 1 else values[0]
    largest = float(values[0]) or 1.0  # of a matrix of zeros, as where all eigenvalues vanish
    return Deficiency(float(values[-1]) / largest, float(least) / largest, w * rows, v * columns[:, None])

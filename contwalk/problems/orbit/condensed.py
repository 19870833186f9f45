"""Linear systems of an orbit, condensed: the inner legs are eliminated one by one, a small system is left.

A leg's unknowns (the states at the starts of its segments, its duration) meet the equations of its own end
and of its start, and none else; start state of the first leg, drifts and parameter, and further borders, are
common. Elimination with pivots from each leg's rows costs O(legs n^3) where a dense one costs O((legs n)^3),
and stays stable where events graze or legs are unstable: nothing is divided by a guard's rate, and no product
of legs is formed (S. J. Wright, SIAM J. Sci. Stat. Comput. 13, 742, 1992).

Of a forced machine the equations of a leg depend on its starting time, and so on all durations before it.
Starting times are then unknowns of their own, t_i+1 = t_i + T_i, and the matrix is a chain again.
"""

from __future__ import annotations

from functools import cached_property, lru_cache

import numpy as np

from contwalk.flow.compiled.addresses import address
from contwalk.flow.compiled.entry_points import Entry
from contwalk.numerics.linear import Factored, Factorization
from contwalk.problems.orbit.layout import Layout

_LOOPS = "contwalk.problems.orbit.elimination"
ELIMINATE = Entry(_LOOPS, "eliminate", "d", "qqqqqqqq")
FORWARD = Entry(_LOOPS, "forward", "q", "qqqqqqqq")
FORWARD_TRANSPOSED = Entry(_LOOPS, "forward_transposed", "q", "qqqqqqqq")
BACKWARD = Entry(_LOOPS, "backward", "q", "qqqqqq")
BACKWARD_TRANSPOSED = Entry(_LOOPS, "backward_transposed", "q", "qqqqqq")
# Of fewer unknowns dense elimination is as cheap: see benchmarks/linear_algebra.py.
FEW = 100
# Up to this size the bound of the error is computed from the inverse, above it is estimated.
INVERTED = 128
# Products with the inverse after which the estimate of its norm has stopped growing in practice.
PRODUCTS = 5


def warmup() -> None:
    """Compile the loops, or find them compiled."""
    for entry in (ELIMINATE, FORWARD, FORWARD_TRANSPOSED, BACKWARD, BACKWARD_TRANSPOSED):
        _ = entry.address


class Chain:
    """In which order the equations and unknowns of an orbit are eliminated.

    Parameters
    ----------
    layout : Layout
        Of at least two legs.
    size : int
        Of the matrix: that of `layout`, or with borders, which come last.
    """

    def __init__(self, layout: Layout, size: int) -> None:
        self.layout, self.size = layout, size
        later = range(1, layout.legs)
        self.times = list(range(size, size + len(later))) if layout.start is not None else []
        self.width = size + len(self.times)
        columns: list[int] = []
        rows = list(range(layout.matches[0].start, layout.matches[0].stop)) + self.times[:1]
        stages = []
        for i in later:
            columns += [*range(layout.states[i].start, layout.states[i].stop)]
            inner = [place for own in layout.inner[i] for place in range(own.start, own.stop)]
            columns += [*inner, layout.durations.start + i]
            columns += self.times[i - 1 : i]
            rows += [layout.guards + i, *inner, *range(layout.matches[i].start, layout.matches[i].stop)]
            rows += self.times[i : i + 1]
            stages.append([len(columns), len(rows), 0])
        for own, following in zip(stages, [*stages[1:], stages[-1]], strict=True):
            own[2] = following[0]
        self.stages = np.array(stages, dtype=np.int64)
        self.inner = len(columns)
        self.rows = np.array(rows + sorted(set(range(self.width)) - set(rows)))
        self.columns = np.array(columns + sorted(set(range(self.width)) - set(columns)))

    @cached_property
    def real(self) -> np.ndarray:
        """The matrix's own columns among the inner legs'. Shape (k,)."""
        inner = self.columns[: self.inner]
        return inner[inner < self.size]

    @cached_property
    def parity(self) -> float:
        """Sign of the determinant of both permutations."""
        return _parity(self.rows) * _parity(self.columns)

    def extended(self, matrix: np.ndarray) -> np.ndarray:
        """The matrix with the starting times of the inner legs as unknowns; its determinant is the same.

        Both are square, shape (m, m).
        """
        start = self.layout.start
        if start is None:
            return matrix
        result = np.zeros((self.width, self.width), dtype=matrix.dtype)
        result[: self.size, : self.size] = matrix
        first = self.layout.durations.start
        for i, own in enumerate(self.times, 1):
            match = self.layout.matches[i]
            rows = np.append(np.arange(match.start, match.stop), self.layout.guards + i)
            rows = np.append(rows, [np.arange(own.start, own.stop) for own in self.layout.inner[i]]).astype(
                int
            )
            result[rows, own] = matrix[rows, start]
            result[rows, start] = 0.0
            result[rows, first : first + i] = 0.0
            result[own, [own, first + i - 1, start if i == 1 else own - 1]] = 1.0, -1.0, -1.0
        return result

    def weights(self, given: np.ndarray) -> np.ndarray:
        """Units of all unknowns, starting times included. `given` has the shape (m,)."""
        start = self.layout.start
        return given if start is None else np.append(given, np.full(len(self.times), given[start]))


@lru_cache(maxsize=64)
def _chain(layout: Layout, size: int) -> Chain:
    return Chain(layout, size)


def factored(layout: Layout, matrix: np.ndarray, weights: np.ndarray) -> Factorization:
    """A matrix of an orbit's equations and unknowns, and of borders that come last, factored.

    The matrix has the shape (m, m), the weights (m,).

    Raises
    ------
    numpy.linalg.LinAlgError
        If it is exactly singular, here or when it is used.
    """
    if layout.legs == 1 or len(matrix) < FEW:
        return Factored(matrix, weights)
    chain = _chain(layout, len(matrix))
    if np.iscomplexobj(matrix) and np.any(matrix[:, chain.real].imag):
        return Factored(matrix, weights)  # a complex border, as only a torus bifurcation has while located
    return Condensed(matrix, weights, chain)


class Condensed(Factorization):
    """A matrix of an orbit, factored: as `Factored`, by way of the small system that is left.

    Parameters
    ----------
    matrix : ndarray
        Square. It may be complex in the columns that are common to all legs.
    weights : ndarray
        Typical magnitudes of the unknowns.
    chain : Chain

    Raises
    ------
    numpy.linalg.LinAlgError
        If it is exactly singular.
    """

    def __init__(self, matrix: np.ndarray, weights: np.ndarray, chain: Chain) -> None:
        self.chain, self._columns = chain, chain.weights(weights)[chain.columns]
        inner, size = chain.inner, chain.width
        ordered = chain.extended(matrix)[np.ix_(chain.rows, chain.columns)]
        units = self._columns
        if np.iscomplexobj(
            ordered
        ):  # row operations are real: parts of the common columns stand side by side
            ordered = np.hstack([ordered.real, ordered[:, inner:].imag])
            units = np.append(units, units[inner:])
        self._matrix = ordered = np.ascontiguousarray(ordered)
        self._pivots, self._scales = np.empty(size, dtype=np.int64), np.empty(size)
        places = (address(array) for array in (chain.stages, units, self._scales, self._pivots))
        width, count = ordered.shape[1], len(chain.stages)
        self._sign = ELIMINATE(address(ordered), size, width, count, *places)
        if self._sign == 0.0:
            raise np.linalg.LinAlgError("singular matrix")
        common = ordered[:, inner:size]
        if width > size:
            common = common + 1j * ordered[:, size:]
        self._above, self._left = common[:inner], common[inner:]
        self._triangle = address(ordered), width, count, address(chain.stages)
        at = address(chain.stages), address(self._pivots)
        self._operations = address(ordered), size, width, count, *at

    @cached_property
    def _inverse(self) -> np.ndarray:
        """Of the small system."""
        return np.linalg.inv(self._left)

    def solve(self, right: np.ndarray) -> np.ndarray:
        """x with matrix @ x = right, of one right-hand side or of columns of them.

        Both have the shape (m,) or (m, k).
        """
        chain, inner = self.chain, self.chain.inner
        b = _padded(right, chain.width)[chain.rows] * self._scales[:, None]
        b = _in_reals(FORWARD, self._operations, b)
        x = np.empty_like(b, dtype=np.result_type(b, self._left))
        x[inner:] = self._inverse @ b[inner:]
        x[:inner] = _in_reals(BACKWARD, self._triangle, b[:inner] - self._above @ x[inner:])
        result = np.empty_like(x)
        result[chain.columns] = x * self._columns[:, None]
        return result[: chain.size].reshape(right.shape)

    def solve_adjoint(self, right: np.ndarray) -> np.ndarray:
        """y with matrix* @ y = right. Both have the shape (m,) or (m, k)."""
        chain, inner = self.chain, self.chain.inner
        c = _padded(right, chain.width)[chain.columns] * self._columns[:, None]
        y = np.empty_like(c, dtype=np.result_type(c, self._left))
        y[:inner] = _in_reals(BACKWARD_TRANSPOSED, self._triangle, c[:inner])
        y[inner:] = self._inverse.conj().T @ (c[inner:] - self._above.conj().T @ y[:inner])
        y = _in_reals(FORWARD_TRANSPOSED, self._operations, y)
        result = np.empty_like(y)
        result[chain.rows] = y * self._scales[:, None]
        return result[: chain.size].reshape(right.shape)

    def orientation(self) -> float:
        """Sign of the determinant."""
        return float(self.chain.parity * self._sign * np.linalg.slogdet(self._left)[0])

    def error(self, levels: np.ndarray, weights: np.ndarray) -> float:
        """What errors of the first equations do to the solution in the metric, at most.

        Of many unknowns the bound, the norm of an inverse, is that of N. J. Higham's estimator (ACM TOMS 14,
        381, 1988), which is it in nearly all cases and hardly ever below a third of it.
        """
        size, given = self.chain.size, np.zeros(self.chain.size)
        given[: len(levels)] = levels
        try:
            if size <= INVERTED:
                inverse = self.solve(np.eye(size))
                return float(np.max((np.abs(inverse) @ given) / weights))
            return self._estimated(given, weights)
        except np.linalg.LinAlgError:
            return float("inf")

    def _estimated(self, levels: np.ndarray, weights: np.ndarray) -> float:
        """Largest sum of a row of |A^-1| levels, which is the 1-norm of levels A^-T / weights."""
        size, found = len(levels), 0.0
        x = np.full(size, 1.0 / size)
        alternating = np.where(np.arange(size) % 2, -1.0, 1.0) * (1.0 + np.arange(size) / (size - 1.0))
        for _ in range(PRODUCTS):
            y = levels * self.solve_adjoint(x / weights)
            found = max(found, float(np.abs(y).sum()))
            slope = self.solve(levels * np.where(y >= 0.0, 1.0, -1.0)) / weights
            best = int(np.argmax(np.abs(slope)))
            if abs(slope[best]) <= slope @ x:
                break
            x = np.zeros(size)
            x[best] = 1.0
        other = levels * self.solve_adjoint(alternating / weights)
        return max(found, float(2.0 * np.abs(other).sum() / (3.0 * size)))


def _padded(right: np.ndarray, width: int) -> np.ndarray:
    """Columns of right-hand sides, with zeros for starting times."""
    result = np.zeros((width, 1 if right.ndim == 1 else right.shape[1]), dtype=np.result_type(right, 1.0))
    result[: len(right)] = right.reshape(len(right), -1)
    return result


def _in_reals(entry: Entry, places: tuple[int, ...], given: np.ndarray) -> np.ndarray:
    """Compiled loops on a copy of columns, real and imaginary parts side by side."""
    if np.iscomplexobj(given):
        both = _in_reals(entry, places, np.hstack([given.real, given.imag]))
        half = given.shape[1]
        return both[:, :half] + 1j * both[:, half:]
    result = np.array(given, order="C")
    entry(*places, address(result), result.shape[1])
    return result


def _parity(order: np.ndarray) -> float:
    """Sign of a permutation."""
    left, sign = set(order.tolist()), 1.0
    while left:
        first = k = left.pop()
        while (k := int(order[k])) != first:
            left.remove(k)
            sign = -sign
    return sign

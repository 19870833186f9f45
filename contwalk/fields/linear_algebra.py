"""`numpy.linalg` for arrays with stand-ins for numbers.

A system of equations stays one operation of the graph, with derivatives of its own (`linear_rates`) and loops
in machine code (`elimination_code`). A matrix that falls into independent blocks is solved block by block.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from contwalk.errors import UnsupportedOperation
from contwalk.fields.dispatch import symbolic
from contwalk.fields.functions import Number

# A determinant by minors takes this many products at most: 8 full rows. At zero, too, it has all derivatives.
MOST_PRODUCTS = 1024


def solve(a: Any, b: Any) -> np.ndarray:
    """`numpy.linalg.solve` of matrices, shape (.., n, n), with a vector, shape (n,), or columns (n, k)."""
    if not symbolic(a, b):
        return np.linalg.solve(np.asarray(a, dtype=float), np.asarray(b, dtype=float))
    if np.ndim(a) > 2:
        sides = np.asarray(b, dtype=object)
        return _of_stack(a, lambda one, k: solve(one, sides if sides.ndim == 1 else sides[k]))
    matrix, right = square("solve", a), np.array(b, dtype=object)
    if right.ndim not in (1, 2) or len(right) != len(matrix):
        raise UnsupportedOperation(
            f"numpy.linalg.solve gets a matrix of shape {matrix.shape} and a side of shape {right.shape}.",
            "Give as many rows on both sides.",
        )
    solution = np.empty(right.shape, dtype=object)
    for rows, unknowns in _blocks(matrix):
        solution[unknowns] = _solved(matrix[np.ix_(rows, unknowns)], right[rows])
    return solution


def _of_stack(a: Any, function: Callable[[np.ndarray, int], Any]) -> np.ndarray:
    """What a function makes of each of several matrices, and of its number."""
    return np.array([function(one, k) for k, one in enumerate(np.asarray(a, dtype=object))], dtype=object)


def solve_by_scipy(a: Any, b: Any, *, transposed: bool = False, **_: Any) -> np.ndarray:
    """`scipy.linalg.solve`, whatever it is told of the matrix, shape (n, n)."""
    return solve(np.asarray(a, dtype=object).T if transposed else a, b)


def _solved(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    if len(matrix) == 1:
        return right / matrix[0, 0]
    columns = right.reshape(len(right), -1)
    any_number = next(e for e in (*matrix.flat, *columns.flat) if isinstance(e, Number))
    found = any_number.solution(matrix.tolist(), columns.T.tolist())
    return np.array(found, dtype=object).T.reshape(right.shape)


def _blocks(matrix: np.ndarray) -> Iterator[tuple[list[int], list[int]]]:
    """Rows with the unknowns that stand in them and in no others; the whole where that is not square."""
    n = len(matrix)
    rows_left, blocks = set(range(n)), []
    while rows_left:
        rows, unknowns, new = set[int](), set[int](), {min(rows_left)}
        while new:
            rows |= new
            unknowns |= {j for i in new for j in range(n) if not _is_zero(matrix[i, j])}
            new = {i for i in rows_left - rows if any(not _is_zero(matrix[i, j]) for j in unknowns)}
        rows_left -= rows
        blocks.append((sorted(rows), sorted(unknowns)))
    square_ = all(len(rows) == len(unknowns) for rows, unknowns in blocks)
    yield from blocks if square_ else [(list(range(n)), list(range(n)))]


def _is_zero(entry: Any) -> bool:
    if isinstance(entry, Number):
        return entry.is_zero()
    return bool(entry == 0.0)


def inv(a: Any) -> Any:
    """`numpy.linalg.inv` of one matrix; what multiplies it is solved for, without an inverse."""
    if not symbolic(a):
        return np.linalg.inv(np.asarray(a, dtype=float))
    if np.ndim(a) > 2:
        return _of_stack(a, lambda one, _: solve(one, np.eye(len(one))))
    return Inverse(square("inv", a))


class Inverse(np.lib.mixins.NDArrayOperatorsMixin):
    """An inverse that is not formed where it is multiplied with arrays, and else is an array.

    Parameters
    ----------
    matrix : ndarray
    """

    def __init__(self, matrix: np.ndarray) -> None:
        self._matrix = matrix
        self._formed: np.ndarray | None = None

    def formed(self) -> np.ndarray:
        """The array, shape (n, n)."""
        if self._formed is None:
            self._formed = solve(self._matrix, np.eye(len(self._matrix)))
        return self._formed

    def _product(self, a: Any, b: Any) -> Any:
        if isinstance(a, Inverse):
            return solve(a._matrix, b.formed() if isinstance(b, Inverse) else b)
        return solve(b._matrix.T, np.asarray(a, dtype=object).T).T

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        if ufunc is np.matmul and method == "__call__" and not options:
            return self._product(*inputs)
        return getattr(ufunc, method)(*(_formed(each) for each in inputs), **options)

    def __array_function__(self, function: Any, types: Any, arguments: Any, options: Any) -> Any:
        if function is np.dot and all(np.ndim(_formed(each)) for each in arguments):
            return self._product(*arguments)
        return function(*(_formed(each) for each in arguments), **options)

    def __array__(self, *_: Any, **__: Any) -> np.ndarray:
        return self.formed()

    def __getattr__(self, name: str) -> Any:
        return getattr(self.formed(), name)

    def __getitem__(self, index: Any) -> Any:
        return self.formed()[index]

    def __len__(self) -> int:
        return len(self._matrix)

    def dot(self, other: Any) -> Any:
        """`numpy.ndarray.dot`."""
        return np.dot(self, other)


def _formed(value: Any) -> Any:
    """An inverse as an array; lists of them as lists of arrays."""
    if isinstance(value, list | tuple):
        return type(value)(_formed(each) for each in value)
    return value.formed() if isinstance(value, Inverse) else value


def det(a: Any) -> Any:
    """`numpy.linalg.det` of one matrix: by minors, without a division, where these are not too many."""
    if not symbolic(a):
        return np.linalg.det(np.asarray(a, dtype=float))
    if np.ndim(a) > 2:
        return _of_stack(a, lambda one, _: det(one))
    matrix = square("det", a)
    by_minors = _minors(matrix)
    if by_minors is not None:
        return by_minors
    any_number = next(entry for entry in matrix.flat if isinstance(entry, Number))
    return any_number.determinant_of(matrix.tolist())


def _minors(matrix: np.ndarray) -> Any:
    """The determinant by minors of the last rows; None where these are more than `MOST_PRODUCTS`."""
    n, products = len(matrix), 0
    minors: dict[tuple[int, ...], Any] = {(): 1.0}  # by their columns
    for row in reversed(range(n)):
        found: dict[tuple[int, ...], Any] = {}
        used = [j for j in range(n) if not _is_zero(matrix[row, j])]
        for columns, minor in minors.items():
            for column in used:
                if column in columns:
                    continue
                products += 1
                if products > MOST_PRODUCTS:
                    return None
                chosen = tuple(sorted((*columns, column)))
                signed = matrix[row, column] * minor * (-1.0 if chosen.index(column) % 2 else 1.0)
                found[chosen] = found[chosen] + signed if chosen in found else signed
        minors = found
    return minors.get(tuple(range(n)), 0.0)


def square(name: str, a: Any) -> np.ndarray:
    """One square matrix, shape (n, n), of numbers and stand-ins.

    Raises
    ------
    UnsupportedOperation
    """
    matrix = np.array(a, dtype=object)
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1] or not len(matrix):
        raise UnsupportedOperation(
            f"numpy.linalg.{name} gets an array of shape {matrix.shape}.", "Give one square matrix."
        )
    return matrix

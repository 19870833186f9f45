"""Equilibria at all values of two parameters, and their equations at one place, in floats or more digits.

Vectors are NumPy arrays in both arithmetics; with more digits their entries are numbers of `mpmath`, so that
what is computed of a place is written once.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.fields.kernel import Kernel
from contwalk.numerics.linear import EPSILON, Factored
from contwalk.numerics.refine import DIGITS
from contwalk.problems.equilibrium.equilibrium import Equilibrium

# Passes after which a solution with more digits is what it is; each gains what the matrix is conditioned to.
PASSES = 12


class Plane(Equilibrium):
    """Equilibria with two free parameters: z = (x, drifts, second, first), shape (N + 2,).

    There is one equation too few for curves of solutions; a curve's condition is the missing one.
    """

    @cached_property
    def finite(self) -> np.ndarray:
        """E of (F_u - s E) q = 0: which unknowns have rates, as drifts have not, shape (N,)."""
        return np.array([1.0] * self.states + [0.0] * (self.size - self.states))


class Place(ABC):
    """The equations of a plane at one z."""

    def __init__(self, plane: Plane, z: Any) -> None:
        self.plane, self.kernels, self.z = plane, plane.kernels, z

    def padded(self, v: np.ndarray) -> np.ndarray:
        """A direction of the unknowns u, shape (N,), as one of z, where the parameters stand still.

        One of z, shape (N + 2,), is what it is.
        """
        return np.concatenate([v, np.zeros(self.kernels.unknowns + 1 - len(v), dtype=v.dtype)])

    @property
    @abstractmethod
    def residual(self) -> np.ndarray:
        """F, shape (N,)."""

    @property
    @abstractmethod
    def jacobian(self) -> np.ndarray:
        """DF, shape (N, N + 2)."""

    @property
    def matrix(self) -> np.ndarray:
        """F_u, shape (N, N)."""
        return self.jacobian[:, : self.plane.size]

    @abstractmethod
    def along(self, kernel: Kernel, *directions: np.ndarray) -> np.ndarray:
        """A derivative of F along directions of u, shape (N,)."""

    @abstractmethod
    def slopes(self, v: np.ndarray) -> np.ndarray:
        """Derivatives of DF v by z for a constant v, shape (N, N + 2)."""

    @abstractmethod
    def measured(self, name: str) -> tuple[Any, np.ndarray]:
        """The value of a declared observable, and its derivatives by z, shape (N + 2,)."""

    @abstractmethod
    def solver(self, matrix: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """The function that applies the inverse of a matrix, shape (k, k)."""

    @abstractmethod
    def solved(
        self, matrix: np.ndarray, right: np.ndarray, left: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """x and y, shape (k,), with matrix @ x = right and y @ matrix = left; the matrix is real."""

    def second(self, v: np.ndarray, w: np.ndarray) -> np.ndarray:
        """B(v, w), shape (N,)."""
        return self.along(self.kernels.second, v, w)

    def third(self, v: np.ndarray, w: np.ndarray, y: np.ndarray) -> np.ndarray:
        """C(v, w, y), shape (N,)."""
        return self.along(self.kernels.third, v, w, y)

    def several(self, *directions: np.ndarray) -> np.ndarray:
        """The derivative of F along any number of directions, shape (N,)."""
        return self.along(self.kernels.along(len(directions)), *directions)


class FloatPlace(Place):
    """The equations in double precision at z, shape (N + 2,)."""

    def __init__(self, plane: Plane, z: np.ndarray) -> None:
        super().__init__(plane, z)
        self._inputs = plane.inputs(z)
        self.table = plane.kernels.linearization(*self._inputs)

    @property
    def residual(self) -> np.ndarray:
        """F, shape (N,)."""
        return self.table[:, 0]

    @property
    def jacobian(self) -> np.ndarray:
        """DF, shape (N, N + 2)."""
        return self.table[:, 1:]

    def along(self, kernel: Kernel, *directions: np.ndarray) -> np.ndarray:
        """A derivative of F along directions of u, shape (N,)."""
        return kernel(*self._inputs, *map(self.padded, directions))

    def slopes(self, v: np.ndarray) -> np.ndarray:
        """Derivatives of DF v by z for a constant v, shape (N, N + 2)."""
        return self.kernels.jacobian_of_first(*self._inputs, self.padded(v))

    def measured(self, name: str) -> tuple[float, np.ndarray]:
        """The value of a declared observable, and its derivatives by z, shape (N + 2,)."""
        value, gradient = self.plane.observable_kernels(name)
        return float(value(*self._inputs)[0]), gradient(*self._inputs)

    def solver(self, matrix: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """The function that applies the inverse of a matrix, shape (k, k)."""
        return solver_of_floats(matrix)

    def solved(
        self, matrix: np.ndarray, right: np.ndarray, left: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """x and y, shape (k,), with matrix @ x = right and y @ matrix = left: scaled once for both."""
        factored = Factored(matrix)
        return factored.solve(right), factored.solve_adjoint(left)

    @cached_property
    def noise(self) -> np.ndarray:
        """Error bounds of the entries of F_u, shape (N, N)."""
        n = self.plane.states
        bounds = EPSILON * np.abs(self.matrix)
        bounds[:n, :n] += 2.0 * EPSILON * self.kernels.rounding_of_matrix(*self._inputs)
        return bounds


class ExactPlace(Place):
    """The equations with `DIGITS` digits, at a place of numbers of `mpmath`."""

    def __init__(self, plane: Plane, z: Sequence[Any]) -> None:
        super().__init__(plane, list(z))
        self._inputs = plane.exact_inputs(self.z)

    @cached_property
    def residual(self) -> np.ndarray:
        """F, shape (N,)."""
        return np.array(self.kernels.residual.exactly(*self._inputs), dtype=object)

    @cached_property
    def jacobian(self) -> np.ndarray:
        """DF, shape (N, N + 2)."""
        return self._spread(self.kernels.linearization)[:, 1:]

    def _spread(self, kernel: Kernel, *more: list[Any]) -> np.ndarray:
        """The matrix of a kernel that computes only those of its entries that are not always zero."""
        assert kernel.shape is not None
        flat = np.full(int(np.prod(kernel.shape)), 0, dtype=object)
        flat[kernel.where] = kernel.exactly(*self._inputs, *more)
        return flat.reshape(kernel.shape)

    def slopes(self, v: np.ndarray) -> np.ndarray:
        """Derivatives of DF v by z for a constant v, shape (N, N + 2)."""
        return self._spread(self.kernels.jacobian_of_first, self.padded(v).tolist())

    def measured(self, name: str) -> tuple[Any, np.ndarray]:
        """The value of a declared observable, and its derivatives by z, shape (N + 2,)."""
        value, gradient = self.plane.observable_kernels(name)
        slopes = np.array(gradient.exactly(*self._inputs), dtype=object)
        return value.exactly(*self._inputs)[0], slopes

    def along(self, kernel: Kernel, *directions: np.ndarray) -> np.ndarray:
        """A derivative of F along directions of u, shape (N,)."""
        padded = (self.padded(direction).tolist() for direction in directions)
        return np.array(kernel.exactly(*self._inputs, *padded), dtype=object)

    def solver(self, matrix: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """The function that applies the inverse of a matrix, shape (k, k).

        It is that in floats, refined by exact residuals.
        """
        rough = Factored(_floats(matrix)).solve
        return lambda right: _refined(matrix, rough, right)

    def solved(
        self, matrix: np.ndarray, right: np.ndarray, left: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """As of any place, refined like what a `solver` tells: the matrix (k, k), all vectors (k,)."""
        rough = Factored(_floats(matrix))
        return _refined(matrix, rough.solve, right), _refined(matrix.T, rough.solve_adjoint, left)


def _refined(matrix: np.ndarray, rough: Callable[[np.ndarray], np.ndarray], right: np.ndarray) -> np.ndarray:
    """x, (k,), with matrix (k, k) @ x = right by exact residuals; `rough` solves for it in floats."""
    x = np.full(right.shape, 0, dtype=object)
    for _ in range(PASSES):
        rest = right - matrix @ x
        largest = max(abs(r) for r in rest.flat)
        if largest == 0:
            break
        change = rough(_floats(rest / largest))
        x = x + largest * change.astype(object)
        size = max((float(abs(v)) for v in x.flat), default=0.0)
        if float(largest) * float(np.max(np.abs(change))) <= 10.0**-DIGITS * size:
            break
    return x


def solver_of_floats(matrix: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """The function that applies the inverse of a matrix of floats, shape (k, k)."""
    return Factored(matrix).solve


def _floats(values: np.ndarray) -> np.ndarray:
    """Numbers of `mpmath` as floats, complex where one of them is."""
    converted = [complex(v) for v in values.flat]
    array = np.array(converted).reshape(values.shape)
    return array if np.any(array.imag) else array.real

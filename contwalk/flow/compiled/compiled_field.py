"""What an integrator sees of a field: addresses of machine code, and the pattern of the Jacobian."""

from __future__ import annotations

import ctypes
from abc import ABC, abstractmethod
from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.fields.llvm import Code
from contwalk.flow.compiled.addresses import address
from contwalk.flow.compiled.batched import BatchedJacobian
from contwalk.flow.compiled.entry_points import Entry

_POINTER = ctypes.c_void_p
EACH = Entry("contwalk.flow.compiled.each_driver", "each", "q", "qqqqqqqq")


class CompiledField(ABC):
    """dx/dt = f(t, x, p) as machine code.

    Attributes
    ----------
    n, k, m : int
        Numbers of states, of columns (parameters by which derivatives are wanted), and of outputs.
    row_ptr, col : ndarray of int64
        Entries of the Jacobian that can be nonzero, row by row: those of row i are in columns
        ``col[row_ptr[i]:row_ptr[i + 1]]`` of the n + k.
    """

    n: int
    k: int
    m: int
    row_ptr: np.ndarray
    col: np.ndarray
    _rhs: Code
    _rhs_jac: Code
    _product: Code
    _variation: Code

    def __init__(self, parameter_count: int) -> None:
        self.parameter_count = parameter_count

    @cached_property
    def forms(self) -> dict[tuple[str, int], Any]:
        """What calls of a method with so many tangents have in common; `explicit` keeps it here."""
        return {}

    @property
    @abstractmethod
    def constant_count(self) -> int:
        """Length of c."""

    @abstractmethod
    def constants(self, p: Sequence[float] | np.ndarray) -> np.ndarray:
        """Everything that depends on the parameters only; passed on as `c`.

        Raises
        ------
        ValueError
            If `p` has another length than the parameters.
        """

    # -- machine code ------------------------------------------------------------------------------------

    @property
    def rhs_address(self) -> int:
        """Address of ``rhs(double t, double* x, double* c, double* out)``; compiled when first asked for."""
        return self._rhs.addresses["rhs"]

    @property
    def rhs_jac_address(self) -> int:
        """Address of ``rhs_jac(t, x, c, out)``: `out` is f, then the entries of the Jacobian."""
        return self._rhs_jac.addresses["rhs_jac"]

    @property
    def product_address(self) -> int:
        """Address of the product of the Jacobian with several tangents; see `products`."""
        return self._product.addresses["product"]

    @property
    def batched(self) -> BatchedJacobian | None:
        """Its Jacobian for many stages at once; None where the field is no straight line of operations."""
        return None

    @property
    def variation_address(self) -> int:
        """Address of ``variation(t, x, p, out)``, which takes the parameters themselves; `out` is (2 m,).

        How far rounding of its own operations carries each rate, in units of the machine epsilon, then the
        rates' derivatives by time.
        """
        return self._variation.addresses["variation"]

    # -- calls from Python -------------------------------------------------------------------------------

    def __call__(self, t: float, x: Sequence[float] | np.ndarray, c: np.ndarray) -> np.ndarray:
        """f, shape (m,); NaN throughout where one entry does not exist."""
        out = self._called(self._rhs_function, t, x, c, self.m)
        return out if np.isfinite(out).all() else np.full(self.m, np.nan)

    def along(self, times: np.ndarray, states: np.ndarray, c: np.ndarray) -> np.ndarray:
        """f at many instants: times (k,), states (k, n) -> (k, m)."""
        times = np.ascontiguousarray(times, dtype=float)
        states = np.ascontiguousarray(states, dtype=float)
        if states.shape != (len(times), self.n) or c.shape != (max(self.constant_count, 1),):
            raise ValueError(f"states {states.shape} and {c.shape} constants for {len(times)} times")
        out = np.empty((len(times), self.m))
        given = address(times), address(states), self.n, address(c), address(out), self.m
        EACH(self.rhs_address, len(times), *given)
        return out

    def jacobian(self, t: float, x: Sequence[float] | np.ndarray, c: np.ndarray) -> np.ndarray:
        """Exact derivatives by the states and the columns, shape (m, n + k); NaN where they do not exist."""
        return self.linearized(t, x, c)[1]

    def linearized(
        self, t: float, x: Sequence[float] | np.ndarray, c: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """f, shape (m,), and `jacobian`, shape (m, n + k), from one evaluation."""
        out = self._called(self._rhs_jac_function, t, x, c, self.m + len(self.col))
        f, width = out[: self.m], self.n + self.k
        if not np.isfinite(out).all():
            f = f if np.isfinite(f).all() else np.full(self.m, np.nan)
            return f, np.full((self.m, width), np.nan)
        dense = np.zeros(self.m * width)
        dense[self._entries_at] = out[self.m :]
        return f, dense.reshape(self.m, width)

    @cached_property
    def _entries_at(self) -> np.ndarray:
        """Positions of the entries in the dense Jacobian, row by row."""
        return np.repeat(np.arange(self.m), np.diff(self.row_ptr)) * (self.n + self.k) + self.col

    @cached_property
    def _rhs_function(self) -> Any:
        return self._rhs.function("rhs", None, ctypes.c_double, _POINTER, _POINTER, _POINTER)

    @cached_property
    def _rhs_jac_function(self) -> Any:
        return self._rhs_jac.function("rhs_jac", None, ctypes.c_double, _POINTER, _POINTER, _POINTER)

    def _called(
        self, call: Any, t: float, x: Sequence[float] | np.ndarray, c: np.ndarray, m: int
    ) -> np.ndarray:
        state, out = np.ascontiguousarray(x, dtype=float), np.empty(m)
        if state.shape != (self.n,) or c.shape != (max(self.constant_count, 1),):
            raise ValueError(f"a state of shape {state.shape} and {c.shape} constants for {self.n} states")
        call(t, address(state), address(c), address(out))
        return out

"""A vector field as machine code: its value, its exact Jacobian, and what both take from the parameters."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from functools import cached_property
from threading import RLock
from typing import Any

import numpy as np

from contwalk.fields.derivative import jacobian
from contwalk.fields.hoisting import hoisted
from contwalk.fields.llvm import Code, code_of
from contwalk.fields.machine_code import Input, function, module
from contwalk.fields.trace import Outputs, Program, roots
from contwalk.flow.products import product_text

_POINTER = ctypes.c_void_p
# A solve asks for those of the same parameters many times.
_MOST_CONSTANTS = 64


class Field:
    """dx/dt = f(t, x, p), compiled.

    Parameters
    ----------
    program : Program
        f, with as many outputs as there are states, or as many as `outputs` says.
    states : sequence of (group, index)
        Inputs of the program that are the states, in the order of x.
    parameters : mapping
        Groups of parameters with their lengths; they are concatenated, in this order, to p.
    columns : sequence of (group, index)
        Parameters by which derivatives are wanted.
    time : (group, index), optional
        The input that is the time, if f depends on it.
    differentiable : bool
        Whether its Jacobian may be asked for: what is prepared for it has a price.
    outputs : int, optional
        Of a map of the state that is no vector field: a reset with its guard, a condition.

    Attributes
    ----------
    n, k, m : int
        Numbers of states, of columns, and of outputs.
    row_ptr, col : ndarray of int64
        Entries of the Jacobian that can be nonzero, row by row: those of row i are in columns
        ``col[row_ptr[i]:row_ptr[i + 1]]`` of the n + k.

    Raises
    ------
    ValueError
        If the program reads an input that is neither a state nor a parameter nor the time, or has another
        number of outputs than states.
    """

    def __init__(
        self,
        program: Program,
        states: Sequence[Input],
        parameters: Mapping[str, int],
        columns: Sequence[Input] = (),
        time: Input | None = None,
        differentiable: bool = True,
        outputs: int | None = None,
    ) -> None:
        self.n, self.k = len(states), len(columns)
        self.m = self.n if outputs is None else outputs
        self.parameter_count = sum(parameters.values())
        self._program = program
        graph = program.graph
        self._states = {graph.input(*state): ("x", i) for i, state in enumerate(states)}
        places = [(group, i) for group, length in parameters.items() for i in range(length)]
        self._parameters = {graph.input(*place): ("p", i) for i, place in enumerate(places)}
        self._time = {} if time is None else {graph.input(*time): ("t", 0)}
        self._along = [*self._states, *(graph.input(*column) for column in columns)]
        self._lock = RLock()
        self._known_constants: dict[bytes, np.ndarray] = {}
        self._differentiable = differentiable
        self._check(columns, places)

    def _check(self, columns: Sequence[Input], places: Sequence[Input]) -> None:
        known = {*self._states, *self._parameters, *self._time}
        graph = self._program.graph
        lengths = {len(leaf.nodes) for leaf in self._program.leaves() if isinstance(leaf, Outputs)}
        if lengths - {self.m}:
            raise ValueError(f"a program of {max(lengths)} outputs where {self.m} are wanted")
        for column in columns:
            if column not in places:
                raise ValueError(f"the column {column} is no parameter")
        stack, seen = roots(self._program.tree), set[int]()
        while stack:
            node = stack.pop()
            if node in seen:
                continue
            seen.add(node)
            key = graph.nodes[node]
            if key[0] == "input" and node not in known:
                raise ValueError(f"the program reads {key[1:]}, which is no state, parameter or time")
            if key[0] not in ("const", "input"):
                stack.extend(key[1:])

    # -- the Jacobian ------------------------------------------------------------------------------------

    @cached_property
    def _rows(self) -> list[list[int]]:
        """For each row the columns of the entries that are nonzero on some path."""
        rows = [set[int]() for _ in range(self.m)]
        for leaf in self._program.leaves():
            if isinstance(leaf, Outputs):
                for row, entries in zip(rows, self._derivatives(leaf.nodes), strict=True):
                    row.update(entries)
        return [sorted(row) for row in rows]

    def _derivatives(self, outputs: Sequence[int]) -> list[dict[int, int]]:
        return jacobian(self._program.graph, outputs, self._along)

    @cached_property
    def row_ptr(self) -> np.ndarray:
        """Positions of the rows' first entries in `col`, and their number; (m + 1,)."""
        return np.cumsum([0, *(len(row) for row in self._rows)], dtype=np.int64)

    @cached_property
    def col(self) -> np.ndarray:
        """Columns of the entries."""
        return np.array([k for row in self._rows for k in row], dtype=np.int64)

    @cached_property
    def _linearization(self) -> Program:
        """f, then the entries of its Jacobian."""
        zero = self._program.graph.zero

        def change(outputs: tuple[int, ...]) -> list[int]:
            derivatives = self._derivatives(outputs)
            pairs = [(i, k) for i, row in enumerate(self._rows) for k in row]
            return [*outputs, *(derivatives[i].get(k, zero) for i, k in pairs)]

        return self._program.transformed(change)

    # -- machine code ------------------------------------------------------------------------------------

    @cached_property
    def _hoisted(self) -> list[int]:
        nodes = [*roots(self._program.tree)]
        if self._differentiable:
            nodes += roots(self._linearization.tree)
        return hoisted(self._program.graph, nodes, self._parameters.keys())

    @cached_property
    def constant_count(self) -> int:
        """Length of c."""
        return len(self._hoisted)

    def _compiled(self, name: str, program: Program) -> Code:
        inputs = {**self._states, **self._time, **{node: ("c", i) for i, node in enumerate(self._hoisted)}}
        return code_of(module([function(name, program, ("x", "c"), inputs, time=True)]), (name,))

    @cached_property
    def _rhs(self) -> Code:
        with self._lock:
            return self._compiled("rhs", self._program)

    @cached_property
    def _rhs_jac(self) -> Code:
        with self._lock:
            return self._compiled("rhs_jac", self._linearization)

    @cached_property
    def _constants(self) -> Any:
        program = Program(self._program.graph, Outputs(tuple(self._hoisted)))
        text = module([function("constants", program, ("p",), self._parameters, time=False)])
        with self._lock:
            return code_of(text, ("constants",)).function("constants", None, _POINTER, _POINTER)

    @property
    def rhs_address(self) -> int:
        """Address of ``rhs(double t, double* x, double* c, double* out)``; compiled when first asked for."""
        return self._rhs.addresses["rhs"]

    @property
    def rhs_jac_address(self) -> int:
        """Address of ``rhs_jac(t, x, c, out)``: `out` is f, then the entries of the Jacobian."""
        return self._rhs_jac.addresses["rhs_jac"]

    @cached_property
    def _product(self) -> Code:
        leaves = [leaf.nodes[self.n :] for leaf in self._linearization.leaves() if isinstance(leaf, Outputs)]
        one = self._program.graph.one
        ones = [i for i in range(len(self.col)) if all(leaf[i] == one for leaf in leaves)]
        with self._lock:
            return code_of(product_text(self._rows, self.n, ones), ("product",))

    @property
    def product_address(self) -> int:
        """Address of the product of the Jacobian with several tangents; see `products`."""
        return self._product.addresses["product"]

    # -- calls from Python -------------------------------------------------------------------------------

    def constants(self, p: Sequence[float] | np.ndarray) -> np.ndarray:
        """Everything that depends on the parameters only; passed on as `c`.

        Raises
        ------
        ValueError
            If `p` has another length than the parameters.
        """
        values = np.ascontiguousarray(p, dtype=float)
        if values.shape != (self.parameter_count,):
            raise ValueError(f"{values.shape} values for {self.parameter_count} parameters")
        key = values.tobytes()
        known = self._known_constants.get(key)
        if known is None:
            known = np.empty(max(self.constant_count, 1))
            self._constants(values.ctypes.data, known.ctypes.data)
            known.flags.writeable = False
            if len(self._known_constants) >= _MOST_CONSTANTS:
                self._known_constants.clear()
            self._known_constants[key] = known
        return known

    def __call__(self, t: float, x: Sequence[float] | np.ndarray, c: np.ndarray) -> np.ndarray:
        """f, shape (m,); NaN throughout where one entry does not exist."""
        return self._called(self._rhs_function, t, x, c, self.m)

    def along(self, times: np.ndarray, states: np.ndarray, c: np.ndarray) -> np.ndarray:
        """f at many instants: times (k,), states (k, n) -> (k, m)."""
        times = np.asarray(times, dtype=float)
        states = np.ascontiguousarray(states, dtype=float)
        if states.shape != (len(times), self.n) or c.shape != (max(self.constant_count, 1),):
            raise ValueError(f"states {states.shape} and {c.shape} constants for {len(times)} times")
        out, call, given = np.empty((len(times), self.m)), self._rhs_function, c.ctypes.data
        state, result, width, size = states.ctypes.data, out.ctypes.data, 8 * self.n, 8 * self.m
        for k, t in enumerate(times.tolist()):
            call(t, state + k * width, given, result + k * size)
        return out

    def jacobian(self, t: float, x: Sequence[float] | np.ndarray, c: np.ndarray) -> np.ndarray:
        """Exact derivatives by the states and the columns, shape (m, n + k); NaN where they do not exist."""
        out = self._called(self._rhs_jac_function, t, x, c, self.m + len(self.col))
        dense = np.zeros((self.m, self.n + self.k))
        dense[np.repeat(np.arange(self.m), np.diff(self.row_ptr)), self.col] = out[self.m :]
        return dense if np.isfinite(out[0]) else np.full_like(dense, np.nan)

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
        call(t, state.ctypes.data, c.ctypes.data, out.ctypes.data)
        return out if np.isfinite(out).all() else np.full(m, np.nan)

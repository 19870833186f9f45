"""A vector field as machine code: its value, its exact Jacobian, and what both take from the parameters."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from functools import cached_property
from threading import RLock
from typing import Any

import numpy as np

from contwalk.fields.derivative import directional, jacobian
from contwalk.fields.hoisting import hoisted, places_of, width_of
from contwalk.fields.kernel import refuse_raising
from contwalk.fields.lanes import has_lanes
from contwalk.fields.llvm import Code, code_of
from contwalk.fields.machine_code import Input, function, module
from contwalk.fields.rounding import error_bounds
from contwalk.fields.trace import Outputs, Program, roots
from contwalk.flow.compiled.addresses import address
from contwalk.flow.compiled.batched import BatchedJacobian, batched_product, jacobians_in_lanes
from contwalk.flow.compiled.compiled_field import CompiledField
from contwalk.flow.compiled.derived import Derived, derived
from contwalk.flow.compiled.products import product_text

_POINTER = ctypes.c_void_p
# A solve asks for those of the same parameters many times.
_MOST_CONSTANTS = 64


class Field(CompiledField):
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
        super().__init__(sum(parameters.values()))
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
        # What the graph is now decides all that is derived from it; later it grows by what is derived.
        self._described = (
            *(len(graph.nodes), len(graph.tables), self.m, self.n, differentiable),
            *(self._states, self._parameters, self._time, self._along),
        )
        self._check(columns, places)

    def _check(self, columns: Sequence[Input], places: Sequence[Input]) -> None:
        known = {*self._states, *self._parameters, *self._time}
        graph = self._program.graph
        refuse_raising(self._program)
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
    def _derived(self) -> Derived:
        """The pattern and the texts, which an earlier process may have kept."""
        graph, (nodes, tables, *rest) = self._program.graph, self._described
        described = graph.nodes[:nodes], graph.tables[:tables], self._program.tree, *rest
        with self._lock:
            return derived(described, self._derive)

    def _derive(self) -> Derived:
        own = self._program, *([self._linearization] if self._differentiable else [])
        texts = [self._text(name, program) for name, program in zip(("rhs", "rhs_jac"), own, strict=False)]
        rows, ones = (self._rows, self._always_one) if self._differentiable else ([], [])
        count = sum(width_of(self._program.graph, node) for node in self._hoisted)
        return Derived(rows, ones, count, texts[0], texts[1] if texts[1:] else "", self._constants_text)

    @cached_property
    def _rows(self) -> list[list[int]]:
        rows = [set[int]() for _ in range(self.m)]
        for leaf in self._program.leaves():
            if isinstance(leaf, Outputs):
                for row, entries in zip(rows, self._derivatives(leaf.nodes), strict=True):
                    row.update(entries)
        return [sorted(row) for row in rows]

    def _derivatives(self, outputs: Sequence[int]) -> list[dict[int, int]]:
        return jacobian(self._program.graph, outputs, self._along)

    @cached_property
    def row_ptr(self) -> np.ndarray:  # type: ignore[override]
        """Positions of the rows' first entries in `col`, and their number; (m + 1,)."""
        return np.cumsum([0, *(len(row) for row in self._derived.rows)], dtype=np.int64)

    @cached_property
    def col(self) -> np.ndarray:  # type: ignore[override]
        """Columns of the entries, one after the other: shape (number of entries,)."""
        return np.array([k for row in self._derived.rows for k in row], dtype=np.int64)

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
        return self._derived.constant_count

    def _text(self, name: str, program: Program) -> str:
        places = places_of(self._program.graph, self._hoisted).items()
        inputs = {**self._states, **self._time, **{node: ("c", place) for node, place in places}}
        return module([function(name, program, ("x", "c"), inputs, time=True)])

    @cached_property
    def rhs_text(self) -> str:
        """Its LLVM IR."""
        return self._derived.rhs

    @cached_property
    def rhs_jac_text(self) -> str:
        """LLVM IR of the field with its Jacobian."""
        return self._derived.rhs_jac

    @cached_property
    def _rhs(self) -> Code:  # type: ignore[override]
        with self._lock:
            return code_of(self.rhs_text, ("rhs",))

    @cached_property
    def _rhs_jac(self) -> Code:  # type: ignore[override]
        with self._lock:
            return code_of(self.rhs_jac_text, ("rhs_jac",))

    @cached_property
    def variation_text(self) -> str:
        """LLVM IR of what rounding and time do to the field."""
        graph = self._program.graph
        moving = dict.fromkeys(self._time, graph.one)

        def change(outputs: tuple[int, ...]) -> list[int]:
            return [*error_bounds(graph, outputs), *directional(graph, outputs, moving)]

        inputs = {**self._states, **self._time, **self._parameters}
        program = self._program.transformed(change)
        return module([function("variation", program, ("x", "p"), inputs, time=True)])

    @cached_property
    def _variation(self) -> Code:  # type: ignore[override]
        with self._lock:
            return code_of(self.variation_text, ("variation",))

    @property
    def _constants_text(self) -> str:
        program = Program(self._program.graph, Outputs(tuple(self._hoisted)))
        return module([function("constants", program, ("p",), self._parameters, time=False)])

    @cached_property
    def _constants(self) -> Any:
        with self._lock:
            code = code_of(self._derived.constants, ("constants",))
        return code.function("constants", None, _POINTER, _POINTER)

    @property
    def ones(self) -> list[int]:
        """Positions of the entries of the Jacobian that are always 1."""
        return self._derived.ones

    @property
    def _always_one(self) -> list[int]:
        leaves = [leaf.nodes[self.m :] for leaf in self._linearization.leaves() if isinstance(leaf, Outputs)]
        one = self._program.graph.one
        entries = sum(len(row) for row in self._rows)
        return [i for i in range(entries) if all(leaf[i] == one for leaf in leaves)]

    @cached_property
    def _product(self) -> Code:  # type: ignore[override]
        with self._lock:
            return code_of(product_text(self._derived.rows, self.n, self.ones), ("product",))

    @cached_property
    def batched(self) -> BatchedJacobian | None:
        """Its Jacobian for many stages at once; None where the field is no straight line of operations."""
        if not (self._differentiable and self.m == self.n and has_lanes(self.rhs_jac_text)):
            return None
        with self._lock:
            return BatchedJacobian(
                jacobians_in_lanes(self.rhs_jac_text, self.n, self.m),
                batched_product(self._derived.rows, self.n, self.ones),
                self.n,
                len(self.col),
                np.arange(self.n, dtype=np.int64),
            )

    # -- calls from Python -------------------------------------------------------------------------------

    def constants(self, p: Sequence[float] | np.ndarray) -> np.ndarray:
        """Everything that depends on the parameters only; passed on as `c`, and not to be written to.

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
            self._constants(address(values), address(known))
            if len(self._known_constants) >= _MOST_CONSTANTS:
                self._known_constants.clear()
            self._known_constants[key] = known
        return known

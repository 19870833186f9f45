"""A field of which some states exist only: the same machine code, called from a thin shell.

Modes of a machine may differ in nothing but numbers and in which states exist: a foot that touches the ground
or does not. What is compiled for one of them then serves all; a shell fills in zeros for the states that do
not exist, and leaves out what does not concern the others.
"""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Sequence
from functools import cached_property

import numpy as np

from contwalk.fields.llvm import Code, code_of, known_to_the_linker
from contwalk.flow.compiled.batched import BatchedJacobian, batched_product
from contwalk.flow.compiled.compiled_field import CompiledField
from contwalk.flow.compiled.field import Field
from contwalk.flow.compiled.products import product_text


class Restricted(CompiledField):
    """The part of a field that concerns some of its states, at fixed values of its first parameters.

    Parameters
    ----------
    whole : Field
    places : sequence of int
        Which of its states exist; those that do not are zero.
    head : sequence of float
        Values of its first parameters; `constants` is asked for with the others.
    """

    def __init__(self, whole: Field, places: Sequence[int], head: Sequence[float]) -> None:
        self.whole, self.places = whole, tuple(places)
        self.n = self.m = len(self.places)
        self.k = whole.k
        self._head = np.array(head, dtype=float)
        super().__init__(whole.parameter_count - len(self._head))

    @property
    def constant_count(self) -> int:
        """Length of c."""
        return self.whole.constant_count

    def constants(self, p: Sequence[float] | np.ndarray) -> np.ndarray:
        """Everything that depends on the parameters only; passed on as `c`."""
        values = np.ascontiguousarray(p, dtype=float)
        if values.shape != (self.parameter_count,):
            raise ValueError(f"{values.shape} values for {self.parameter_count} parameters")
        return self.whole.constants(np.concatenate([self._head, values]))

    @cached_property
    def _entries(self) -> list[tuple[int, int, int]]:
        """Row, column and position in the whole of each entry of the Jacobian that is left."""
        whole, column = self.whole, {place: j for j, place in enumerate(self.places)}
        column |= {whole.n + j: self.n + j for j in range(whole.k)}
        found = []
        for i, place in enumerate(self.places):
            for position in range(whole.row_ptr[place], whole.row_ptr[place + 1]):
                if int(whole.col[position]) in column:
                    found.append((i, column[int(whole.col[position])], position))
        return found

    @cached_property
    def row_ptr(self) -> np.ndarray:  # type: ignore[override]
        """Positions of the rows' first entries in `col`, and their number; (m + 1,)."""
        counts = np.bincount([i for i, _, _ in self._entries], minlength=self.m)
        return np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)

    @cached_property
    def col(self) -> np.ndarray:  # type: ignore[override]
        """Columns of the entries, one after the other: shape (number of entries,)."""
        return np.array([j for _, j, _ in self._entries], dtype=np.int64)

    @cached_property
    def _rhs(self) -> Code:  # type: ignore[override]
        return self._shell(
            "rhs", self.whole.rhs_text, self.whole.rhs_address, list(self.places), self.whole.m
        )

    @cached_property
    def _rhs_jac(self) -> Code:  # type: ignore[override]
        whole = self.whole
        kept = [*self.places, *(whole.m + position for _, _, position in self._entries)]
        address = whole.rhs_jac_address
        return self._shell("rhs_jac", whole.rhs_jac_text, address, kept, whole.m + len(whole.col))

    @cached_property
    def _variation(self) -> Code:  # type: ignore[override]
        whole = self.whole
        kept = [*self.places, *(whole.m + place for place in self.places)]
        given = self._numbers()
        return self._shell(
            "variation", whole.variation_text, whole.variation_address, kept, 2 * whole.m, given
        )

    def _numbers(self) -> list[str]:
        """Statements that put the first parameters before those that are given: %c becomes %numbers."""
        lines = [f"  %numbers = alloca [{max(self.whole.parameter_count, 1)} x double], align 32"]
        for k in range(self.whole.parameter_count):
            value = f"%p{k}"
            if k < len(self._head):
                value = f"0x{struct.unpack('<Q', struct.pack('<d', self._head[k]))[0]:016X}"
            else:
                lines.append(f"  %p{k}_at = getelementptr double, ptr %c, i64 {k - len(self._head)}")
                lines.append(f"  %p{k} = load double, ptr %p{k}_at")
            lines.append(f"  %number{k}_at = getelementptr double, ptr %numbers, i64 {k}")
            lines.append(f"  store double {value}, ptr %number{k}_at")
        return lines

    def _shell(
        self,
        name: str,
        text: str,
        address: int,
        kept: Sequence[int],
        outputs: int,
        numbers: Sequence[str] = (),
    ) -> Code:
        """`name(t, x, c, out)`, which calls the whole and keeps some of its outputs.

        With statements `numbers` the whole is given %numbers instead of `c`.
        """
        symbol = f"contwalk_{hashlib.sha256(text.encode()).hexdigest()[:32]}"
        known_to_the_linker(symbol, address)
        exists = {place: j for j, place in enumerate(self.places)}
        lines = [
            f"declare void @{symbol}(double, ptr, ptr, ptr)",
            f"define void @{name}(double %t, ptr noalias nocapture readonly %x, ptr %c, "
            "ptr noalias nocapture writeonly %out) nounwind {",
            f"  %all = alloca [{self.whole.n} x double], align 32",
            f"  %found = alloca [{outputs} x double], align 32",
        ]
        for i in range(self.whole.n):
            value = "0.0"
            if i in exists:
                lines.append(f"  %x{i}_at = getelementptr double, ptr %x, i64 {exists[i]}")
                lines.append(f"  %x{i} = load double, ptr %x{i}_at")
                value = f"%x{i}"
            lines.append(f"  %all{i}_at = getelementptr double, ptr %all, i64 {i}")
            lines.append(f"  store double {value}, ptr %all{i}_at")
        lines += numbers
        given = "numbers" if numbers else "c"
        lines.append(f"  call void @{symbol}(double %t, ptr %all, ptr %{given}, ptr %found)")
        for i, position in enumerate(kept):
            lines.append(f"  %f{i}_at = getelementptr double, ptr %found, i64 {position}")
            lines.append(f"  %f{i} = load double, ptr %f{i}_at")
            lines.append(f"  %o{i}_at = getelementptr double, ptr %out, i64 {i}")
            lines.append(f"  store double %f{i}, ptr %o{i}_at")
        return code_of("\n".join([*lines, "  ret void", "}", ""]), (name,))

    @cached_property
    def _pattern(self) -> tuple[list[list[int]], list[int]]:
        """Columns of each row's entries, and positions of the entries that are always 1."""
        rows: list[list[int]] = [[] for _ in range(self.m)]
        for i, column, _ in self._entries:
            rows[i].append(column)
        always_one = frozenset(self.whole.ones)
        return rows, [k for k, (_, _, position) in enumerate(self._entries) if position in always_one]

    @cached_property
    def _product(self) -> Code:  # type: ignore[override]
        rows, ones = self._pattern
        return code_of(product_text(rows, self.n, ones), ("product",))

    @cached_property
    def batched(self) -> BatchedJacobian | None:
        """The Jacobian of the whole for many stages at once: what does not concern it is passed over."""
        whole = self.whole.batched
        if whole is None:
            return None
        rows, ones = self._pattern
        product = batched_product(rows, self.n, ones, [position for _, _, position in self._entries])
        places = np.array(self.places, dtype=np.int64)
        return BatchedJacobian(whole.jacobians, product, whole.rows, whole.entries, places)

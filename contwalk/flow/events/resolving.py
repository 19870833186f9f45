"""A field with watched numbers as further states: control of their errors resolves them too.

The field and the numbers are compiled already; a thin shell calls them one after the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from contwalk.fields.llvm import Code, code_of, linked_code
from contwalk.flow.compiled.compiled_field import CompiledField
from contwalk.flow.compiled.products import product_text
from contwalk.flow.events.guard_code import OUTPUTS, GuardCode


class Resolving(CompiledField):
    """dx/dt of a mode, then dh/dt of the watched numbers; they depend on x alone.

    Its constants are those of the field, then the parameters.

    Parameters
    ----------
    field : CompiledField
    guards : sequence of GuardCode
        Of the same mode.
    """

    def __init__(self, field: CompiledField, guards: Sequence[GuardCode]) -> None:
        self.field, self.guards = field, tuple(guards)
        self.n = self.m = field.n + len(self.guards)
        self.k = 0
        super().__init__(field.parameter_count)

    @property
    def _own(self) -> int:
        """Length of the field's constants."""
        return max(self.field.constant_count, 1)

    @property
    def constant_count(self) -> int:
        """Length of c."""
        return self._own + self.parameter_count

    def constants(self, p: Sequence[float] | np.ndarray) -> np.ndarray:
        """Everything that depends on the parameters only; passed on as `c`."""
        return np.concatenate([self.field.constants(p), np.asarray(p, dtype=float)])

    @cached_property
    def _rows(self) -> list[list[int]]:
        field = self.field
        own = [field.col[field.row_ptr[i] : field.row_ptr[i + 1]].tolist() for i in range(field.n)]
        return [*own, *(list(range(field.n)) for _ in self.guards)]

    @cached_property
    def row_ptr(self) -> np.ndarray:  # type: ignore[override]
        """Positions of the rows' first entries in `col`, and their number; (m + 1,)."""
        return np.cumsum([0, *(len(row) for row in self._rows)], dtype=np.int64)

    @cached_property
    def col(self) -> np.ndarray:  # type: ignore[override]
        """Columns of the entries, one after the other: shape (number of entries,)."""
        return np.array([j for row in self._rows for j in row], dtype=np.int64)

    # -- machine code ------------------------------------------------------------------------------------

    @cached_property
    def _rhs(self) -> Code:  # type: ignore[override]
        lines = ["  call void @contwalk_whole(double %t, ptr %x, ptr %c, ptr %out)"]
        lines.append("  %rate = getelementptr double, ptr %scratch, i64 1")
        for j in range(len(self.guards)):
            lines.append(f"  call void @contwalk_guard{j}(double %t, ptr %x, ptr %out, ptr %p, ptr %scratch)")
            lines.append(f"  %rate{j} = load double, ptr %rate")
            lines.append(f"  %to{j} = getelementptr double, ptr %out, i64 {self.field.n + j}")
            lines.append(f"  store double %rate{j}, ptr %to{j}")
        addresses = [guard.address for guard in self.guards]
        return self._shell("rhs", lines, self.field.rhs_address, addresses, OUTPUTS)

    @cached_property
    def _rhs_jac(self) -> Code:  # type: ignore[override]
        n, entries = self.field.n, len(self.field.col)
        lines = [
            "  call void @contwalk_whole(double %t, ptr %x, ptr %c, ptr %all)",
            f"  %j = {_at('%all', n)}",
        ]
        lines += [
            f"  %out_j = {_at('%out', self.m)}",
            _copy("%out", "%all", n),
            _copy("%out_j", "%j", entries),
        ]
        for j in range(len(self.guards)):
            lines.append(f"  call void @contwalk_guard{j}(double %t, ptr %x, ptr %all, ptr %p, ptr %scratch)")
            lines.append(f"  %rate{j} = {_at('%out', n + j)}")
            lines.append(f"  %row{j} = {_at('%out', self.m + entries + j * n)}")
            lines.append(f"  call void @chained(ptr %scratch, ptr %all, ptr %rate{j}, ptr %row{j})")
        addresses = [guard.slopes_address for guard in self.guards]
        more = [_chained(self._rows[:n]), "declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)"]
        return self._shell("rhs_jac", lines, self.field.rhs_jac_address, addresses, 4 + 2 * n, more)

    def _shell(
        self,
        name: str,
        lines: Sequence[str],
        whole: int,
        guards: Sequence[int],
        room: int,
        more: Sequence[str] = (),
    ) -> Code:
        """`name(t, x, c, out)`; `whole` and `guards` are addresses of what it calls."""
        text = [
            "declare void @contwalk_whole(double, ptr, ptr, ptr)",
            *(f"declare void @contwalk_guard{j}(double, ptr, ptr, ptr, ptr)" for j in range(len(guards))),
            *more,
            f"define void @{name}(double %t, ptr %x, ptr %c, ptr %out) nounwind {{",
            f"  %all = alloca [{self.field.n + len(self.field.col)} x double], align 32",
            f"  %scratch = alloca [{room} x double], align 32",
            f"  %p = {_at('%c', self._own)}",
            *lines,
            "  ret void",
            "}",
            "",
        ]
        called = {
            "contwalk_whole": whole,
            **{f"contwalk_guard{j}": address for j, address in enumerate(guards)},
        }
        return linked_code("\n".join(text), (name,), called)

    @cached_property
    def _product(self) -> Code:  # type: ignore[override]
        return code_of(product_text(self._rows, self.n, []), ("product",))


def _at(array: str, position: int) -> str:
    return f"getelementptr double, ptr {array}, i64 {position}"


def _copy(target: str, source: str, length: int) -> str:
    return f"  call void @llvm.memcpy.p0.p0.i64(ptr {target}, ptr {source}, i64 {8 * length}, i1 false)"


def _chained(rows: Sequence[Sequence[int]]) -> str:
    """IR of `chained(slopes, all, rate, row)`: h_t + h_x f, and its derivatives by the states.

    These are what changes of the slopes of h along f, and h_x times the field's Jacobian, where h_x is not 0.
    """
    n, position = len(rows), len(rows)
    lines = ["define internal void @chained(ptr %slopes, ptr %all, ptr %rate, ptr %row) nounwind {"]
    lines += [f"  %time_at = {_at('%slopes', 2)}", "  %s0 = load double, ptr %time_at"]
    totals = []
    for i in range(n):
        lines += [f"  %g{i}_at = {_at('%slopes', 3 + i)}", f"  %g{i} = load double, ptr %g{i}_at"]
        lines += [f"  %f{i}_at = {_at('%all', i)}", f"  %f{i} = load double, ptr %f{i}_at"]
        lines += [f"  %z{i} = fcmp oeq double %g{i}, 0.0", f"  %gf{i} = fmul double %g{i}, %f{i}"]
        lines += [f"  %term{i} = select i1 %z{i}, double 0.0, double %gf{i}"]
        lines += [f"  %s{i + 1} = fadd double %s{i}, %term{i}"]
        lines += [f"  %c{i}_at = {_at('%slopes', 4 + n + i)}", f"  %c{i} = load double, ptr %c{i}_at"]
        totals.append(f"%c{i}")
    for i, row in enumerate(rows):
        for j in row:
            e = position
            lines += [f"  %e{e}_at = {_at('%all', e)}", f"  %e{e} = load double, ptr %e{e}_at"]
            lines += [f"  %ge{e} = fmul double %g{i}, %e{e}"]
            lines += [f"  %part{e} = select i1 %z{i}, double 0.0, double %ge{e}"]
            lines += [f"  %t{e} = fadd double {totals[j]}, %part{e}"]
            totals[j] = f"%t{e}"
            position += 1
    lines.append(f"  store double %s{n}, ptr %rate")
    for i, total in enumerate(totals):
        lines += [f"  %o{i}_at = {_at('%row', i)}", f"  store double {total}, ptr %o{i}_at"]
    return "\n".join([*lines, "  ret void", "}"])

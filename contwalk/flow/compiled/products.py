"""The product of a sparse Jacobian with several tangents at once, as LLVM IR.

The pattern is part of the code: nothing is looked up, and entries that are zero cost nothing.
"""

from __future__ import annotations

from collections.abc import Sequence

# Columns of tangents that are moved at once: the doubles of one register. Arrays of them are padded to it.
WIDTH = 4
_VECTOR = f"<{WIDTH} x double>"


def product_text(
    rows: Sequence[Sequence[int]],
    states: int,
    ones: Sequence[int],
    places: Sequence[int] | None = None,
    apart: int = 1,
) -> str:
    """IR of `void product(i64 blocks, double* x, double* sources, double* entries, double* out)`.

    Row i of `out` is the sum, over the entries of row i of the Jacobian, of the entry times a row of `x`, or,
    for the columns of parameters, of `sources`. All rows have `blocks` times four columns.

    Parameters
    ----------
    rows : sequence of sequences of int
        For each row the columns of its entries.
    states : int
        Columns from here on are those of parameters.
    ones : sequence of int
        Positions of the entries that are always 1.
    places : sequence of int, optional
        Where in `entries` each entry stands; one after the other by default.
    apart : int
        How many doubles they are apart there.
    """
    always_one = frozenset(ones)
    lines = [
        "define void @product(i64 %blocks, ptr noalias readonly %x, ptr noalias readonly %sources, "
        "ptr noalias readonly %entries, ptr noalias writeonly %out) nounwind {",
        "entry:",
        f"  %width = mul i64 %blocks, {WIDTH}",
        "  br label %loop",
        "loop:",
        "  %i = phi i64 [ 0, %entry ], [ %i_next, %loop ]",
    ]
    for column in sorted({column for row in rows for column in row}):
        array, own = ("x", column) if column < states else ("sources", column - states)
        lines += _address(f"x{column}", array, own)
        lines.append(f"  %x{column} = load {_VECTOR}, ptr %x{column}_at, align 8")
    position = 0
    for i, row in enumerate(rows):
        total = "zeroinitializer"
        for column in row:
            place = apart * (position if places is None else places[position])
            term, statements = _term(position, column, place, position in always_one)
            lines += statements
            if total != "zeroinitializer":
                lines.append(f"  %s{position} = fadd {_VECTOR} {total}, {term}")
                term = f"%s{position}"
            total = term
            position += 1
        lines += _address(f"out{i}", "out", i)
        lines.append(f"  store {_VECTOR} {total}, ptr %out{i}_at, align 8")
    lines += [
        f"  %i_next = add i64 %i, {WIDTH}",
        "  %more = icmp ult i64 %i_next, %width",
        "  br i1 %more, label %loop, label %done",
        "done:",
        "  ret void",
        "}",
    ]
    return "\n".join([*lines, ""])


def _address(name: str, array: str, row: int) -> list[str]:
    return [
        f"  %{name}_row = mul i64 %width, {row}",
        f"  %{name}_place = add i64 %{name}_row, %i",
        f"  %{name}_at = getelementptr double, ptr %{array}, i64 %{name}_place",
    ]


def _term(position: int, column: int, place: int, one: bool) -> tuple[str, list[str]]:
    """An entry times a row."""
    if one:
        return f"%x{column}", []
    vector = f"{_VECTOR} %e{position}_0"
    return f"%p{position}", [
        f"  %e{position}_at = getelementptr double, ptr %entries, i64 {place}",
        f"  %e{position} = load double, ptr %e{position}_at",
        f"  %e{position}_0 = insertelement {_VECTOR} poison, double %e{position}, i64 0",
        f"  %v{position} = shufflevector {vector}, {_VECTOR} poison, <{WIDTH} x i32> zeroinitializer",
        f"  %p{position} = fmul {_VECTOR} %v{position}, %x{column}",
    ]

"""Of a singular matrix the rows that are exchanged exist: what was left in memory chose them."""

from __future__ import annotations

import ctypes

import numpy as np
import pytest

from contwalk.fields.elimination_code import factor_width, texts
from contwalk.fields.llvm import code_of

CALL = "define void @made({0}) {{\n  call void @{1}({0})\n  ret void\n}}\n"
ROWS = 6


def made_ready(kind: str, matrix: np.ndarray) -> np.ndarray:
    """The factor of a matrix, shape (n, n), in memory that was full of other numbers."""
    name = f"contwalk_{kind}"
    declared = "declare double @llvm.fabs.f64(double)\n"
    text = declared + "\n".join(texts({name})) + CALL.format("i64 %n, ptr %a", name)
    code = code_of(text, ["made"])
    factor = np.full(factor_width(len(matrix)), 1e6)
    factor[: matrix.size] = matrix.T.ravel()
    code.function("made", None, ctypes.c_int64, ctypes.c_void_p)(len(matrix), factor.ctypes.data)
    return factor


@pytest.mark.parametrize("kind", ["factor", "factor_symmetric"])
@pytest.mark.parametrize("zero", [0, 2, ROWS - 1])
@pytest.mark.parametrize("value", [0.0, np.nan])
def test_rows_to_exchange_are_rows(kind, zero, value):
    """A matrix with a row and a column of zeros, or without a value: elimination ends at that pivot."""
    matrix = np.diag(np.arange(1.0, ROWS + 1.0))
    matrix[zero, zero] = value
    factor = made_ready(kind, matrix)
    rows = factor[ROWS * ROWS : ROWS * ROWS + ROWS]
    assert np.all((rows >= np.arange(ROWS)) & (rows < ROWS))
    assert np.isnan(factor[: ROWS * ROWS].reshape(ROWS, ROWS).diagonal()).all()


def test_a_regular_one_exchanges_what_it_chose():
    matrix = np.diag(np.arange(1.0, ROWS + 1.0))[[1, 0, 2, 3, 5, 4]]
    rows = made_ready("factor", matrix)[ROWS * ROWS : ROWS * ROWS + ROWS]
    np.testing.assert_array_equal(rows, [1, 1, 2, 3, 5, 5])

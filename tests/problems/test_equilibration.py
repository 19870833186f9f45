"""Row and column factors of badly scaled matrices."""

from __future__ import annotations

import numpy as np
import pytest

from contwalk.numerics.linear import equilibration


@pytest.mark.parametrize("seed", range(20))
def test_the_largest_entry_of_each_row_and_column_is_about_one(seed):
    rng = np.random.default_rng(seed)
    size = int(rng.integers(2, 6))
    units = np.exp2(rng.integers(-40, 40, (2, size)))
    matrix = rng.uniform(0.5, 1.0, (size, size)) * (rng.random((size, size)) < 0.6) + np.eye(size)
    matrix *= units[0][:, None] * units[1]
    rows, columns = equilibration(matrix)
    scaled = matrix * rows[:, None] * columns
    # Columns are passed within two powers of two; what brings the rows to one moves them by two more.
    assert np.all(np.abs(np.log2(scaled.max(axis=0))) <= 4.0)
    assert np.all(np.abs(np.log2(scaled.max(axis=1))) <= 1.0)
    assert np.all(np.frexp(rows)[0] == 0.5)
    assert np.all(np.frexp(columns)[0] == 0.5)

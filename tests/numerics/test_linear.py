"""Linear systems that are scaled before they are solved."""

from __future__ import annotations

import numpy as np

from contwalk.numerics.linear import Factored, balanced


def test_a_row_below_the_smallest_normal_float_is_zero() -> None:
    """The inverse of its largest entry overflows: as on an invariant face, where an equation dies away."""
    factored = Factored(np.array([[1e-320, 0.0], [0.0, 2.0]]), np.ones(2))
    assert np.all(np.isfinite(factored.rows))
    assert factored.rows[1] == 0.5


def test_a_coupling_that_nothing_answers_is_balanced_with_the_diagonal() -> None:
    """One state drives the other, in units 1e16 apart: in them the eigenvalues -0.3 and 0 are one."""
    matrix = np.array([[0.0, 1e16], [0.0, -0.3]])
    scaled, d = balanced(matrix, one_way=True)
    np.testing.assert_array_equal(scaled, matrix / d[:, None] * d)
    assert np.abs(scaled).max() < 4.0 * 0.3  # powers of two


def test_couplings_no_larger_than_the_diagonal_are_left() -> None:
    matrix = np.array([[1.0, 2.0], [0.0, -1.0]])
    np.testing.assert_array_equal(balanced(matrix, one_way=True)[0], matrix)


def test_the_coupling_of_a_double_zero_is_left_where_ranks_are_judged() -> None:
    matrix = np.array([[1e-17, 2.0], [0.0, -1e-17]])
    np.testing.assert_array_equal(balanced(matrix)[0], matrix)

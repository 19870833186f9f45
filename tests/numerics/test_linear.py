"""Linear systems that are scaled before they are solved."""

from __future__ import annotations

import numpy as np

from contwalk.numerics.linear import Factored


def test_a_row_below_the_smallest_normal_float_is_zero() -> None:
    """The inverse of its largest entry overflows: as on an invariant face, where an equation dies away."""
    factored = Factored(np.array([[1e-320, 0.0], [0.0, 2.0]]), np.ones(2))
    assert np.all(np.isfinite(factored.rows))
    assert factored.rows[1] == 0.5

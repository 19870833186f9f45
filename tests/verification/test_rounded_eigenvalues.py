"""How exactly eigenvalues of a recomputed matrix are known, where their vectors meet."""

from __future__ import annotations

import numpy as np
import pytest

from contwalk.verification.solving import rounded_eigenvalues

EPSILON = float(np.finfo(float).eps)


@pytest.mark.parametrize("other", [0.0, 5e-324, -3e-292, 1e-20])
def test_eigenvalues_with_one_vector_are_known_to_the_root_of_a_rounding(other: float):
    errors = rounded_eigenvalues(np.array([[0.0, 1.0], [0.0, other]]))
    np.testing.assert_allclose(errors, EPSILON**0.5, rtol=1e-12)


def test_eigenvalues_of_a_symmetric_matrix_are_known_to_a_rounding_of_it():
    errors = rounded_eigenvalues(np.array([[2.0, 1.0], [1.0, 2.0]]))
    np.testing.assert_allclose(errors, 3.0 * EPSILON, rtol=1e-12)


def test_no_eigenvalues_have_no_errors():
    assert rounded_eigenvalues(np.zeros((0, 0))).shape == (0,)

"""Eigenvalues with errors and rates, against closed forms."""

import numpy as np
import pytest

from contwalk.numerics.spectrum import EPSILON, spectrum


def test_rates_of_a_triangular_matrix_are_those_of_its_diagonal():
    """Eigenvalues of a triangular matrix stand on its diagonal, their rates on that of a triangular rate."""
    random = np.random.default_rng(3)
    n = 6
    matrix = np.triu(random.normal(size=(n, n)), 1) + np.diag(np.arange(n, 0.0, -1.0))
    rate = np.triu(random.normal(size=(n, n)))
    found = spectrum(matrix, rate, EPSILON * np.abs(matrix))
    assert found.values.imag == pytest.approx(np.zeros(n))
    assert np.all(np.abs(found.values.real - np.arange(n, 0.0, -1.0)) <= found.errors)
    # left and right vectors of well separated eigenvalues: good to some hundred roundings
    assert found.rates == pytest.approx(np.diag(rate), rel=1e-12, abs=1e-12)


def test_a_pair_turns_and_grows_at_its_own_rates():
    """a +- i w, of a matrix seen in another basis; the rate moves a by 2 and w by 5: the real part's is 2."""
    basis = np.array([[2.0, 1.0], [0.5, -3.0]])
    inverse = np.linalg.inv(basis)
    matrix = basis @ np.array([[0.25, -7.0], [7.0, 0.25]]) @ inverse
    rate = basis @ np.array([[2.0, -5.0], [5.0, 2.0]]) @ inverse
    found = spectrum(matrix, rate, EPSILON * np.abs(matrix))
    assert np.all(np.abs(found.values - np.array([0.25 + 7.0j, 0.25 - 7.0j])) <= found.errors)
    assert found.rates == pytest.approx([2.0, 2.0], rel=1e-13)


def test_neutral_directions_are_left_out():
    """diag(0, -1, 2) in another basis: the direction with eigenvalue zero is given, or counted."""
    basis = np.array([[1.0, 0.3, 0.0], [0.2, 1.0, -0.4], [0.0, 0.7, 1.0]])
    matrix = basis @ np.diag([0.0, -1.0, 2.0]) @ np.linalg.inv(basis)
    rounding = 8.0 * EPSILON * np.ones((3, 3))
    rate = np.zeros((3, 3))
    for found in (spectrum(matrix, rate, rounding, basis[:, :1]), spectrum(matrix, rate, rounding, zeros=1)):
        assert found.values == pytest.approx([2.0, -1.0], rel=1e-14)


def test_the_error_of_a_small_eigenvalue_is_its_own_where_the_others_are_far():
    """Of a diagonal matrix the entries are the eigenvalues: each is known to its own rounding."""
    values = np.array([1e8, 1e-8])
    found = spectrum(np.diag(values), np.zeros((2, 2)), EPSILON * np.diag(values))
    assert found.values.real.tolist() == values.tolist()
    # Its entry's error, four roundings of its products, and the square of what the algorithm leaves behind.
    assert np.all(found.errors <= 10.0 * EPSILON * values)


@pytest.mark.parametrize(
    "similar", [np.eye(2), np.array([[1.0, 0.3], [-0.7, 1.9]])], ids=["as it is", "mixed"]
)
@pytest.mark.parametrize("rate", [1.0, -3.0])
def test_the_sign_of_two_that_are_one_with_their_vectors_is_known(similar, rate):
    """x'' = 2 a x' - a^2 x: a twice, with one vector. First order knew nothing, and neither did anyone."""
    block, back = np.array([[0.0, 1.0], [-(rate**2), 2.0 * rate]]), np.linalg.inv(similar)
    matrix = similar @ block @ back
    # Two products of two terms each, and an inverse of as much again: so far entries are from that block's.
    entries = 8.0 * EPSILON * np.abs(similar) @ np.abs(block) @ np.abs(back)
    found = spectrum(matrix, np.zeros((2, 2)), entries)
    assert np.all(np.abs(found.values - rate) <= found.errors)
    assert np.all(found.errors <= 1e-6 * abs(rate))
    assert found.unstable(None) == (2 if rate > 0.0 else 0)
    # Entries that are off by their rounding move them by the root of it, and by less than is claimed.
    draw = np.random.default_rng(1)
    for _ in range(20):
        moved = matrix + entries * draw.uniform(-1.0, 1.0, matrix.shape)
        assert np.abs(np.linalg.eigvals(moved) - rate).max() <= found.errors.min()

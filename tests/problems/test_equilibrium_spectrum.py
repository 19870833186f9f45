"""Eigenvalues of matrices that are known: errors, rates, quotients, and counts where a sign is doubtful."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from small_systems import small_system

from contwalk.numerics.spectrum import complement, spectrum
from contwalk.problems.equilibrium.equilibrium import Equilibrium

NO_ROUNDING = np.zeros((3, 3))


def turned(matrix, seed=5):
    """The matrix in other coordinates, badly enough conditioned to matter a little."""
    rng = np.random.default_rng(seed)
    basis = rng.normal(size=matrix.shape) + 2.0 * np.eye(len(matrix))
    return basis @ matrix @ np.linalg.inv(basis), basis


def test_eigenvalues_come_by_descending_real_part_with_exact_conjugates():
    block = np.array([[0.3, -2.0, 0.0], [2.0, 0.3, 0.0], [0.0, 0.0, -1.0]])
    found = spectrum(turned(block)[0], np.zeros((3, 3)), NO_ROUNDING)
    assert found.values == pytest.approx([0.3 + 2j, 0.3 - 2j, -1.0], abs=1e-14)
    assert found.values[0] == np.conj(found.values[1])
    assert found.values[2].imag == 0.0


@pytest.mark.parametrize("seed", range(6))
def test_errors_cover_what_rounded_entries_do(seed):
    """Against 40 digits: the entries as they are, and moved by as much as `rounding` says."""
    rng = np.random.default_rng(seed)
    matrix = rng.normal(size=(4, 4)) * 10.0 ** rng.uniform(-3.0, 3.0, size=(4, 1))
    rounding = 1e-12 * np.abs(matrix)
    found = spectrum(matrix, np.zeros((4, 4)), rounding)
    for moved in (np.zeros((4, 4)), rounding, rounding * np.sign(rng.normal(size=(4, 4)))):
        with mpmath.workdps(40):
            entries = mpmath.matrix((matrix + moved).tolist())
            exact = np.array([complex(v) for v in mpmath.eig(entries, left=False, right=False)])
        for value, error in zip(found.values, found.errors, strict=True):
            assert np.min(np.abs(exact - value)) <= error
    # And they are no more than tenfold what the moved entries can do to a well conditioned spectrum.
    assert found.errors.max() <= 1e-7 * np.abs(found.values).max()


def test_a_defective_matrix_has_no_certain_eigenvalues():
    """A Jordan block of three moves its eigenvalue by the cube root of what its entries are off by."""
    block = np.array([[-1e-3, 1.0, 0.0], [0.0, -1e-3, 1.0], [0.0, 0.0, -1e-3]])
    found = spectrum(turned(block)[0], np.zeros((3, 3)), NO_ROUNDING)
    assert np.all(found.errors >= np.abs(found.values + 1e-3))


def test_rates_are_those_of_the_real_parts():
    """diag(t, -1 - 2 t) and a pair 0.5 t +- i, all turned by one fixed basis."""
    base = np.diag([0.0, -1.0, 0.0, 0.0])
    base[2, 3], base[3, 2] = -1.0, 1.0
    rate = np.diag([1.0, -2.0, 0.5, 0.5])
    matrix, basis = turned(base + 0.1 * rate)
    moved = basis @ rate @ np.linalg.inv(basis)
    found = spectrum(matrix, moved, np.zeros((4, 4)))
    assert found.values.real == pytest.approx([0.1, 0.05, 0.05, -1.2], abs=1e-13)
    assert found.rates == pytest.approx([1.0, 0.5, 0.5, -2.0], abs=1e-12)


def test_neutral_directions_are_left_out_and_nothing_else():
    """The quotient has the others, even where one is nearer to zero than the rounded neutral one."""
    matrix, basis = turned(np.diag([0.0, 1e-14, -1.0]))
    found = spectrum(matrix, np.zeros((3, 3)), NO_ROUNDING, generators=basis[:, :1])
    assert len(found.values) == 2
    assert found.values.real == pytest.approx([0.0, -1.0], abs=1e-13)
    q = complement(basis[:, :1])
    assert q.T @ q == pytest.approx(np.eye(2), abs=1e-15)
    assert basis[:, 0] @ q == pytest.approx([0.0, 0.0], abs=1e-15)


def test_without_a_generator_the_smallest_eigenvalues_are_left_out():
    found = spectrum(np.diag([2.0, -1e-17, -3.0]), np.zeros((3, 3)), NO_ROUNDING, zeros=1)
    assert found.values.real.tolist() == [2.0, -3.0]


def test_all_directions_neutral_leaves_nothing():
    found = spectrum(np.zeros((2, 2)), np.zeros((2, 2)), np.zeros((2, 2)), generators=np.eye(2))
    assert len(found.values) == 0
    assert found.unstable(None) == 0


def test_noise_in_the_place_of_zeros_does_not_mislead():
    """Entries below their own rounding are zeros: left in, they would couple what is not coupled."""
    matrix = np.array([[-1.0, 1e-17, 0.0], [1e8, -2.0, 0.0], [0.0, 0.0, -3.0]])
    rounding = np.array([[0.0, 1e-17, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    assert spectrum(matrix, np.zeros((3, 3)), rounding).values.real.tolist() == [-1.0, -2.0, -3.0]


@pytest.mark.parametrize(("before", "expected"), [(None, 1), (0, 1), (1, 1), (2, 2), (3, 3), (4, 3)])
def test_a_doubtful_eigenvalue_counts_as_at_the_neighbour(before, expected):
    """Real parts 1, 1e-14, -1e-14, -1, the middle two within their errors of 1e-12.

    Without a neighbour only what is certain counts; with one, the doubtful ones do as far as they did there;
    the certain ones never depend on it.
    """
    matrix = np.diag([1.0, 1e-14, -1e-14, -1.0])
    rounding = np.diag([0.0, 1e-12, 1e-12, 0.0])
    # Entries below their rounding are zeros, and stay doubtful.
    assert spectrum(matrix, np.zeros((4, 4)), rounding).unstable(before) == expected


def test_the_error_of_an_equilibrium_is_that_of_its_equations():
    """-x + lambda = 0 near (1, 1) and 3 y = 0: a solution is known to some roundings of its terms."""

    def field(t, x, p, dx):
        dx[0] = p.lam - x[0]
        dx[1] = -3.0 * x[1]

    problem = Equilibrium(small_system(field, "xy", {"lam": 1.0}), {"lam": 1.0}, "lam")
    z, tangent = np.array([1.0, 0.0, 1.0]), np.array([1.0, 0.0, 1.0])
    sample = problem.examine(z, tangent, np.ones(3), problem.linearize(z), None)
    assert 0.0 < sample.error < 1e-14

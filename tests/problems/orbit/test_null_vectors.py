"""Null vectors by bordering against singular vectors."""

import numpy as np
import pytest

from contwalk.numerics.linear import Factored
from contwalk.problems.orbit.null_vectors import critical_vectors, null_vectors


class Dense:
    """As much of an orbit as null vectors ask for."""

    def factored(self, matrix, weights):
        return Factored(matrix, weights)


def _matrix(smallest, kind=float, second=0.3):
    rng = np.random.default_rng(3)
    n = 9
    parts = [rng.standard_normal((n, n)) + (1j * rng.standard_normal((n, n)) if kind is complex else 0.0)]
    u, _, vh = np.linalg.svd(parts[0])
    sizes = np.linspace(1.0, 0.5, n)
    sizes[-2:] = second, smallest
    return (u * sizes) @ vh, u[:, -1], vh[-1].conj()


def _same_line(a, b, within):
    assert abs(abs(np.vdot(a, b)) - np.linalg.norm(a) * np.linalg.norm(b)) <= within


class TestNullVectors:
    @pytest.mark.parametrize("kind", [float, complex])
    @pytest.mark.parametrize("smallest", [0.0, 1e-13, 1e-4])
    def test_are_the_critical_singular_vectors(self, kind, smallest):
        matrix, left, right = _matrix(smallest, kind)
        b, c = critical_vectors(Dense(), matrix)
        assert [np.linalg.norm(b), np.linalg.norm(c)] == pytest.approx([1.0, 1.0])
        _same_line(b, left, 1e-12)
        _same_line(c, right, 1e-12)

    def test_in_units(self):
        matrix, left, right = _matrix(0.0)
        rows, columns = np.logspace(-3.0, 3.0, 9), np.logspace(2.0, -2.0, 9)
        v, psi = null_vectors(Dense(), matrix * rows[:, None] / columns, rows, columns)
        _same_line(v / columns, right, 1e-12)
        _same_line(psi * rows, left, 1e-12)

    def test_of_a_null_space_of_two_dimensions(self):
        matrix, _, _ = _matrix(0.0, second=0.0)
        b, c = critical_vectors(Dense(), matrix)
        assert np.linalg.norm(matrix @ c) < 1e-12
        assert np.linalg.norm(b @ matrix) < 1e-12

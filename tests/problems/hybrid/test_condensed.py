"""Condensed linear systems against dense ones."""

import numpy as np
import pytest
from chains import random_matrix

from contwalk.numerics.linear import Factored
from contwalk.problems.orbit.condensed import FEW, Chain, Condensed, factored
from contwalk.problems.orbit.layout import Layout

SHAPES = [
    ((4, 4), False, 0, 1),
    ((4, 3, 5), False, 0, 2),
    ((4, 3, 5, 2), False, 2, 1),
    ((3, 3), True, 0, 0),
    ((4, 3, 5, 2), True, 1, 1),
    ((2,) * 12, True, 2, 2),
    ((6,) * 30, False, 1, 1),
]


def _condensed(layout, matrix, weights):
    return Condensed(matrix, weights, Chain(layout, len(matrix)))


def _near(found, expected):
    # Random matrices of some hundred rows have conditions of up to 1e5.
    assert np.linalg.norm(found - expected) <= 1e-10 * np.linalg.norm(expected)


@pytest.fixture(params=SHAPES, ids=str)
def case(request):
    sizes, forced, pins, borders = request.param
    rng = np.random.default_rng(7)
    layout = Layout(sizes, forced, pins)
    matrix = random_matrix(layout, borders, rng)
    return layout, matrix, np.exp(rng.standard_normal(len(matrix))), rng


class TestCondensed:
    def test_solves_as_a_dense_factorization(self, case):
        layout, matrix, weights, rng = case
        found = _condensed(layout, matrix, weights)
        for right in (rng.standard_normal(len(matrix)), rng.standard_normal((len(matrix), 3))):
            for either in (found, Factored(matrix, weights)):
                _near(either.solve(right), np.linalg.solve(matrix, right))
                _near(either.solve_adjoint(right), np.linalg.solve(matrix.T, right))

    def test_a_complex_closure(self, case):
        layout, matrix, weights, rng = case
        matrix = matrix.astype(complex)
        n = layout.sizes[0]
        matrix[layout.matches[-1], layout.states[0]] += (1.0 - np.exp(0.7j)) * np.eye(n)
        found = _condensed(layout, matrix, weights)
        right = rng.standard_normal(len(matrix)) + 1j * rng.standard_normal(len(matrix))
        _near(found.solve(right), np.linalg.solve(matrix, right))
        _near(found.solve_adjoint(right), np.linalg.solve(matrix.conj().T, right))

    def test_orientation_is_the_sign_of_the_determinant(self, case):
        layout, matrix, weights, _ = case
        for row in range(3):
            matrix[-1 - row] *= -1.0
            assert _condensed(layout, matrix, weights).orientation() == np.linalg.slogdet(matrix)[0]

    def test_a_guard_without_rate_is_no_pivot(self, case):
        layout, matrix, weights, rng = case
        for i in range(1, layout.legs):
            matrix[layout.guards + i, layout.durations.start + i] = 0.0
        right = rng.standard_normal(len(matrix))
        _near(_condensed(layout, matrix, weights).solve(right), np.linalg.solve(matrix, right))

    def test_the_error_bound(self, case):
        layout, matrix, weights, rng = case
        levels = np.abs(rng.standard_normal(layout.size))
        bound = Factored(matrix, weights).error(levels, weights)
        found = _condensed(layout, matrix, weights).error(levels, weights)
        # Of many unknowns it is estimated, from below.
        assert bound / 3.0 <= found <= bound * (1.0 + 1e-9)

    def test_a_singular_matrix_is_refused(self):
        layout = Layout((3, 3), False, 0)
        matrix = random_matrix(layout, 1, np.random.default_rng(7))
        matrix[:, layout.durations.start + 1] = 0.0
        with pytest.raises(np.linalg.LinAlgError):
            _condensed(layout, matrix, np.ones(len(matrix)))

    def test_where_it_is_used(self, case):
        layout, matrix, weights, _ = case
        assert isinstance(factored(layout, matrix, weights), Condensed) == (len(matrix) >= FEW)
        if len(matrix) >= FEW:  # a border that is complex on inner legs is not condensed
            border = matrix.astype(complex)
            border[-1] *= 1j
            assert isinstance(factored(layout, border, weights), Factored)

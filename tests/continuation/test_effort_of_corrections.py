"""The effort of a correction is a real number: near the count of iterations, and free of last bits."""

from __future__ import annotations

import numpy as np
import pytest
from made_up import MadeUp, circle

from contwalk.continuation.correction import CHORDS, Correction
from contwalk.continuation.newton import correct

EPS = float(np.finfo(float).eps)


def made(sizes: tuple[float, ...], iterations: int = 9, chords: bool = False) -> Correction:
    return Correction(circle(), np.zeros(2), None, iterations, sizes=sizes, chords=chords)


@pytest.mark.parametrize("first", [1e-1, 1e-3, 1e-6])
@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_quadratic_sequences_take_the_count_that_they_need(first, count):
    """Sizes d q^(2^k - 1), with q such that the one after `count` corrections is the rounding unit."""
    factor = (EPS / first) ** (1.0 / (2**count - 1))
    assert made((first, first * factor)).effort == pytest.approx(count)


def test_linear_sequences_by_one_jacobian_take_a_part_of_a_correction_each():
    assert made((EPS**0.4, EPS**0.5), chords=True).effort == pytest.approx(6.0 / (1.0 + CHORDS))


def test_last_bits_hardly_move_it():
    before = made((1e-2, 3e-4)).effort
    assert abs(made((1e-2 * (1 + 4 * EPS), 3e-4 * (1 - 4 * EPS))).effort - before) < 100 * EPS


def test_it_is_never_more_than_the_count():
    assert made((1e-2, 9e-3), iterations=2).effort == 2.0
    # The second is noise: one led to the solution.
    assert made((1e-6, 2e-10), iterations=1).effort == 1.0
    assert made((1e-6,), iterations=0).effort == 0.0
    assert made((), iterations=0).effort == 0.0


def test_where_corrections_do_not_shrink_they_are_counted():
    assert made((1e-3, 2e-3), iterations=6).effort == 6.0


def test_on_a_circle_it_is_the_count_but_for_the_last_that_rounding_decides():
    for offset in (1e-1, 1e-2, 1e-3, 1e-5):
        found = correct(circle(), np.array([1.0 + offset, 0.0]), np.array([0.0, 1.0]), np.ones(2))
        assert abs(found.effort - found.iterations) <= 1.0


def test_the_exact_solution_takes_none():
    found = correct(
        MadeUp(lambda z: [z[0]], lambda z: [[1.0, 0.0]]), np.zeros(2), np.array([0.0, 1.0]), np.ones(2)
    )
    assert found.effort == 0.0

"""Factors between quotient spaces: against decompositions by LAPACK, in whichever bases."""

from __future__ import annotations

import numpy as np
import pytest

from contwalk.problems.orbit.quotients import between


def lapack(factors, begin, end):
    """Singular values of each factor between the complements, which no choice of bases changes."""
    k, found = begin.shape[2], []
    for j, factor in enumerate(factors):
        here, there = (np.linalg.qr(begin[i], mode="complete")[0][:, k:] for i in (j, (j + 1) % len(factors)))
        along = np.linalg.qr(end[j])[0]
        moved = factor @ here
        found.append(np.linalg.svd(there.T @ (moved - along @ (along.T @ moved)), compute_uv=False))
    return np.array(found)


@pytest.mark.parametrize("segments", [1, 2, 7])
@pytest.mark.parametrize(("n", "k"), [(2, 1), (4, 1), (5, 2), (6, 5), (40, 3)])
def test_they_are_those_of_lapack(segments, n, k):
    random = np.random.default_rng(100 * n + 10 * k + segments)
    factors = random.standard_normal((segments, n, n))
    begin, end = random.standard_normal((2, segments, n, k))
    carried = np.concatenate([factors @ begin[:, :, :1], end[:, :, 1:]], axis=2)
    found, others = between(factors, begin, end, 1)
    for own, arriving in ((found, end), (others, carried)):
        values = np.linalg.svd(own, compute_uv=False)
        # Some roundings of the factor's norm, which is below two roots of n and the tail.
        np.testing.assert_allclose(values, lapack(factors, begin, arriving), rtol=0, atol=1e-13 * n)


def test_directions_of_any_size_are_left_out():
    """Velocities of 1e-200 and 1e200: only their directions matter."""
    random = np.random.default_rng(4)
    factors, begin = random.standard_normal((2, 3, 3)), random.standard_normal((2, 3, 1))
    end = random.standard_normal((2, 3, 1))
    found, others = between(factors, begin, end, 1)
    for size in (1e-200, 1e200):
        scaled, carried = between(factors, size * begin, size * end, 1)
        # Signs of basis vectors depend on no size.
        np.testing.assert_allclose(scaled, found, rtol=0, atol=1e-14)
        np.testing.assert_allclose(carried, others, rtol=0, atol=1e-14)


def test_what_is_carried_to_nothing_tells_no_other_quotient():
    begin = np.array([[[1.0], [0.0]]])
    assert between(np.diag([0.0, 2.0])[None], begin, begin, 1)[1] is None
    assert between(np.diag([3.0, 2.0])[None], begin, begin, 0)[1] is None
    found, others = between(np.diag([3.0, 2.0])[None], begin, begin, 1)
    assert np.abs(found).item() == np.abs(others).item() == 2.0


def test_a_direction_that_vanishes_is_any():
    """Where an orbit is at rest nothing moves: the first state stands for its flow, as LAPACK has it."""
    begin, end = np.array([[[0.0], [1.0]]]), np.zeros((1, 2, 1))
    found, _ = between(np.array([[[5.0, 0.0], [7.0, 1.0]]]), begin, end, 0)
    np.testing.assert_array_equal(
        np.abs(found), lapack(np.array([[[5.0, 0.0], [7.0, 1.0]]]), begin, end)[:, None]
    )

"""Radau IIA: its numbers, its order, stiff problems, the frozen grid."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from small_flows import field_of

from contwalk.flow import Field, adaptive, along, dense, errors_on
from contwalk.flow.tableaus.radau import RADAU5, RADAU9, Collocation

METHODS = ("radau5", "radau9")


def van_der_pol() -> Field:
    return field_of(lambda t, x, p: [x[1], p[0] * (1.0 - x[0] ** 2) * x[1] - x[0]], 2, 1, [0])


@pytest.mark.parametrize("tableau", [RADAU5, RADAU9])
def test_numbers_follow_from_the_definition(tableau: Collocation) -> None:
    """Nodes by their polynomial, A by its quadrature conditions, modes as eigenvectors: all in 40 digits."""
    s = tableau.stages
    with mpmath.workdps(40):
        node = [mpmath.mpf(c) for c in tableau.nodes]
        for c in node[:-1]:
            # the (s-1)-th derivative of x^(s-1) (x-1)^s changes sign within two ulps of the node
            values = [
                mpmath.diff(lambda x: x ** (s - 1) * (x - 1) ** s, c + d, s - 1) for d in (-2.3e-16, 2.3e-16)
            ]
            assert values[0] * values[1] < 0
    c, a = np.array(tableau.nodes), np.array(tableau.matrix)
    for q in range(s):
        # a sum of s products of numbers below 1: a few roundings
        np.testing.assert_allclose(a @ c**q, c ** (q + 1) / (q + 1), atol=4e-16)
    inverse = np.linalg.inv(a)
    for mode in (tableau.real, *tableau.pairs):
        right, left = np.array(mode.right), np.array(mode.left)
        # entries of the inverse reach 30 and its condition 100: 1e-13 is some ten roundings
        np.testing.assert_allclose(inverse @ right, mode.eigenvalue * right, atol=1e-13)
        np.testing.assert_allclose(left @ inverse, mode.eigenvalue * left, atol=2e-12)
        np.testing.assert_allclose(left @ right, 1.0, atol=1e-13)


@pytest.mark.parametrize(("method", "order", "counts"), [("radau5", 5, (16, 32)), ("radau9", 9, (2, 4))])
def test_order_on_a_smooth_nonlinear_problem(method: str, order: int, counts: tuple[int, int]) -> None:
    """x' = -2 t x^2 has the solution 1 / (1 + t^2)."""
    field = field_of(lambda t, x, p: [-2.0 * t * x[0] ** 2 * p[0]], 1, 1)
    c = field.constants([1.0])
    errors = [abs(along(field, c, np.linspace(0.0, 2.0, n + 1), [1.0], method)[-1, 0] - 0.2) for n in counts]
    assert errors[1] > 1e-14  # above rounding, so that the order can be seen
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.7)  # the next term of the expansion


@pytest.mark.parametrize(("method", "stages"), [("radau5", 3), ("radau9", 5)])
def test_stiff_order_is_at_least_the_stage_order(method: str, stages: int) -> None:
    """Prothero and Robinson: x' = -1e7 (x - cos t) - sin t from x = 1."""
    field = field_of(lambda t, x, p: [-p[0] * (x[0] - np.cos(t)) - np.sin(t)], 1, 1)
    c = field.constants([1e7])
    worst = []
    for steps in (8, 16):  # fewer do not resolve the cosine
        times = np.linspace(0.0, 6.0, steps + 1)
        worst.append(np.abs(along(field, c, times, [1.0], method)[:, 0] - np.cos(times)).max())
    assert worst[1] > 1e-15
    assert np.log2(worst[0] / worst[1]) > stages - 0.5


@pytest.mark.parametrize("tolerance", [1e-6, 1e-10])
@pytest.mark.parametrize("method", METHODS)
def test_van_der_pol_over_a_relaxation_cycle(method: str, tolerance: float) -> None:
    """The reference at t = 2000 is that of Hairer and Wanner's test set (mu = 1000)."""
    field = van_der_pol()
    path = adaptive(field, field.constants([1e3]), 0.0, [2.0, 0.0], 2000.0, tolerance, [2.0, 1500.0], method)
    assert path.status == "ok"
    assert path.times[-1] == 2000.0
    # a jump shifts the phase by what the error of its steps is; afterwards errors die out along the slow branch
    np.testing.assert_allclose(
        path.states[-1], [1.706167732170483, -0.8928097010247975e-3], rtol=100.0 * tolerance
    )


def test_steps_of_a_path_are_taken_again_bitwise() -> None:
    field = van_der_pol()
    c = field.constants([50.0])
    for method in METHODS:
        path = adaptive(field, c, 0.0, [2.0, 0.0], 60.0, 1e-8, [2.0, 75.0], method)
        assert path.rejected > 0
        assert np.array_equal(along(field, c, path.times, [2.0, 0.0], method), path.states)
        errors = errors_on(field, c, path.times, [2.0, 0.0], method, [2.0, 75.0])
        assert errors.shape == (len(path.times) - 1,)
        assert np.median(errors) < 1e-8
        assert np.array_equal(dense(field, c, path.times, path.states, path.times, method), path.states)

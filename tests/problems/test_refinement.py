"""Defining systems in closed form: Newton's method, refinement beyond floats, and errors that cover."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest

from contwalk.numerics.refine import DefiningSystem, newton, refine
from contwalk.problems.equilibrium.defining_systems import solve
from contwalk.problems.located import Located


def root_of_two(offset: float = 0.0, **rest) -> DefiningSystem:
    """u^2 = 2 and v = 3 u."""
    return DefiningSystem(
        np.ones(2),
        lambda u: np.array([u[0] ** 2 - 2.0, u[1] - 3.0 * u[0]]),
        lambda u: np.array([[2.0 * u[0] + offset, 0.0], [-3.0, 1.0]]),
        lambda u: [u[0] ** 2 - 2, u[1] - 3 * u[0]],
        **rest,
    )


def exact_root():
    with mpmath.workdps(50):
        return [mpmath.sqrt(2), 3 * mpmath.sqrt(2)]


def test_newton_ends_at_rounding():
    assert newton(root_of_two(), np.array([1.0, 1.0])) == pytest.approx(
        [math.sqrt(2.0), 3.0 * math.sqrt(2.0)], abs=1e-15
    )


@pytest.mark.parametrize(
    "system",
    [
        DefiningSystem(
            np.ones(1), lambda u: u**2 + 1.0, lambda u: np.array([[2.0 * u[0]]]), lambda u: [u[0] ** 2 + 1]
        ),
        DefiningSystem(np.ones(1), lambda u: u * 0.0 + 1.0, lambda u: np.zeros((1, 1)), lambda u: [1]),
        DefiningSystem(
            np.ones(1), lambda u: np.log(u - 5.0), lambda u: 1.0 / (u[:, None] - 5.0), lambda u: [u[0]]
        ),
    ],
    ids=["no zero", "singular", "not finite"],
)
def test_newton_says_where_it_does_not_get_there(system):
    with np.errstate(all="ignore"):
        assert newton(system, np.array([1.3])) is None


def test_refinement_knows_more_digits_than_floats_hold():
    system = root_of_two()
    found = refine(system, newton(system, np.array([1.0, 1.0])))
    assert found.refined
    with mpmath.workdps(50):
        for value, exact, error, truth in zip(
            found.values, found.exact, found.errors, exact_root(), strict=True
        ):
            assert abs(exact - truth) <= mpmath.mpf(10) ** -30
            assert value == float(truth)
            assert abs(mpmath.mpf(float(value)) - truth) <= error
            # Half an ulp is what a float is off by at most; twice that at the most is claimed.
            assert error <= 4.5e-16 * abs(value)


@pytest.mark.parametrize("offset", [1e-3, 0.3])
def test_a_float_jacobian_that_is_off_only_costs_passes(offset):
    system = root_of_two(offset)
    found = refine(system, np.array([1.41421356, 4.2426406]))
    assert found.refined
    assert found.values.tolist() == [float(v) for v in exact_root()]


def test_what_does_not_converge_says_so_and_keeps_the_floats():
    """A Jacobian of the wrong sign doubles the distance each time."""
    right = root_of_two()
    wrong = DefiningSystem(right.scale, right.residual, lambda u: -right.jacobian(u), right.exactly)
    start = np.array([1.41421356, 4.2426406])
    found = refine(wrong, start)
    assert not found.refined


def test_a_singular_jacobian_is_no_crash():
    system = DefiningSystem(np.ones(1), lambda u: u, lambda u: np.zeros((1, 1)), lambda u: [u[0]])
    found = refine(system, np.array([1e-9]))
    assert not found.refined
    assert found.values.tolist() == [1e-9]


def test_a_zero_is_exactly_zero_and_its_error_says_what_was_left():
    system = DefiningSystem(
        np.array([1.0, 1.0]),
        lambda u: np.array([u[0] ** 3 + u[0], u[1] - 1.0 / 3.0]),
        lambda u: np.array([[3.0 * u[0] ** 2 + 1.0, 0.0], [0.0, 1.0]]),
        lambda u: [u[0] ** 3 + u[0], u[1] - mpmath.mpf(1) / 3],
    )
    found = refine(system, np.array([1e-9, 0.3333]))
    assert found.values[0] == 0.0
    assert 0.0 <= found.errors[0] <= 1e-24
    assert found.values[1] == 1.0 / 3.0


def test_a_deficient_system_is_solved_in_the_least_squares_sense():
    """u + v = 1 twice: any point of the line, here the one nearest to the start."""
    ones = np.ones((2, 2))
    system = DefiningSystem(
        np.ones(2),
        lambda u: np.full(2, u.sum() - 1.0),
        lambda u: ones,
        lambda u: [u[0] + u[1] - 1] * 2,
        deficient=True,
    )
    found = newton(system, np.array([2.0, 1.0]))
    assert found == pytest.approx([1.0, 0.0], abs=1e-15)


def multiple_root(order: int, exactly=None) -> DefiningSystem:
    """(u - 1/3)^order = 0, summed up from its powers, as a residual is: rounding hides the root."""
    powers = [math.comb(order, k) * (-1.0 / 3.0) ** (order - k) for k in range(order + 1)]
    third = mpmath.mpf(1.0 / 3.0)
    return DefiningSystem(
        np.ones(1),
        lambda u: np.array([np.polyval(powers[::-1], u[0])]),
        lambda u: np.array([[np.polyval(np.polyder(powers[::-1]), u[0])]]),
        exactly or (lambda u: [(u[0] - third) ** order]),
    )


def test_a_double_root_is_not_claimed_to_be_known_better_than_it_is():
    found = solve(multiple_root(2), np.array([0.5]), lambda s: Located(s.values, float(s.errors[0])))
    assert found is not None
    settled = found.settled()
    assert settled is not None
    off = abs(float(settled.z[0]) - 1.0 / 3.0)
    assert off <= settled.error < 1e-10  # in more digits Newton's method halves its way far beyond sqrt(eps)


def test_two_roots_that_floats_do_not_tell_apart_are_refined():
    """(u - 1/3)^2 = 1e-20: between them the residual in floats is rounding."""
    third, apart = 1.0 / 3.0, 1e-10
    system = multiple_root(2, lambda u: [(u[0] - third) ** 2 - mpmath.mpf(apart) ** 2])
    for side in (-1.0, 1.0):
        found = refine(system, np.array([third + side * 1e-6]), 40, 0.75)
        assert found.refined
        assert float(found.exact[0] - third) == pytest.approx(side * apart, rel=1e-12)


def test_what_cannot_be_refined_at_all_is_no_point():
    def nothing(u):
        raise ZeroDivisionError

    found = solve(multiple_root(1, nothing), np.array([0.5]), lambda s: Located(s.values, float(s.errors[0])))
    assert found is not None
    assert found.settled() is None

"""Rates of multipliers and observables along a branch against closed forms and differences."""

import math

import numpy as np
import pytest
from small_systems import small_system

import contwalk as cw
from contwalk.problems.orbit import rates
from contwalk.problems.parameter_line import ParameterLine
from contwalk.system import Observable


def samples(problem, start, low, high, period):
    """Solutions with their problems, along one direction."""
    return [p.state.sample for p in cw.points(problem, start, (low, high), period=period, max_points=12)]


def test_the_rate_of_a_modulus_is_that_of_its_closed_form():
    """|mu| = exp(-4 pi lam / (2 + lam / 2)) of the Stuart-Landau cycle."""

    def field(t, x, p, dx):
        s = x[0] ** 2 + x[1] ** 2
        w = 2.0 + 0.5 * s
        dx[0] = (p.lam - s) * x[0] - w * x[1]
        dx[1] = w * x[0] + (p.lam - s) * x[1]

    system = small_system(
        field,
        "xy",
        {"lam": 0.02},
        observables=(Observable("size", lambda t, x, p: float(np.max(np.hypot(x[:, 0], x[:, 1])))),),
    )
    from contwalk.problems.initial.orbit_from_state import orbit_at

    start = np.array([math.sqrt(0.02), 0.0])
    chosen = cw.Discretization(accuracy=1e-11)
    problem, z = orbit_at(
        system,
        ParameterLine.of(system, system.defaults(), "lam"),
        None,
        start,
        2 * math.pi / 2.01,
        discretization=chosen,
    )
    linearization = problem.linearize(z)
    # The tangent in closed form: x, y, T, lam.
    tangent = np.array([0.5 / math.sqrt(0.02), 0.0, -2 * math.pi * 0.5 / 2.01**2, 1.0])
    found = problem.multipliers(z, linearization.jacobian)
    value = complex(found.values[0])
    rate = rates.measured(value, rates.of_multiplier(problem, z, tangent, value))

    def modulus(lam):
        return math.exp(-4.0 * math.pi * lam / (2.0 + 0.5 * lam))

    exact = (modulus(0.02 + 1e-5) - modulus(0.02 - 1e-5)) / 2e-5  # off by 1e-10 of a third derivative
    assert rate == pytest.approx(exact, rel=1e-6)
    assert abs(float(np.linalg.norm(linearization.residual))) < 1e-8
    assert np.max(np.abs(linearization.jacobian @ tangent)) < 1e-6


@pytest.mark.parametrize("lam", [0.97, 0.8])
def test_rates_far_from_the_circle_and_at_one_are_not_computed(lam):
    """Of a real positive multiplier other tests see the crossing; far ones cannot hide one. Half way to the
    centre is not far: a long step takes a pair from there over the circle and back.
    """

    def field(t, x, p, dx):
        s = x[0] ** 2 + x[1] ** 2
        dx[0] = (1.0 - s) * x[0] - 2.0 * x[1]
        dx[1] = 2.0 * x[0] + (1.0 - s) * x[1]
        dx[2] = (p.lam - 1.0) * x[2] - 0.3 * x[3]
        dx[3] = 0.3 * x[2] + (p.lam - 1.0) * x[3]

    system = small_system(field, "xyzw", {"lam": lam})
    problem = cw.PeriodicOrbit(system, system.defaults(), "lam")
    first, *_ = cw.points(problem, [1.0, 0.0, 0.0, 0.0], (0.7, 1.1), period=math.pi, max_points=3)
    sample = first.state.sample
    near = np.abs(np.abs(sample.eigenvalues) - 1.0) < 0.5
    complex_ones = sample.eigenvalues.imag != 0.0
    rates = np.array([*sample.rates])
    assert np.array_equal(np.isfinite(rates), near & complex_ones)
    # |mu| = exp(pi (lam - 1)), and the tangent's own share of lam.
    exact = math.pi * math.exp(math.pi * (lam - 1.0)) * sample.tangent[-1]
    np.testing.assert_allclose(rates[:2], exact, rtol=1e-6)

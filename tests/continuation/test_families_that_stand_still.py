"""Families of cycles at one value of the parameter, zero, at which a machine conserves what it does not else.

The parameter is rounding along them. Whatever it does there is no fold, and no end.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.special import ellipk
from small_systems import small_problem

import contwalk as cw

RANGE = (-0.5, 0.5)


def spring(t, x, p, dx):
    """x'' + x + x^3 = mu x'."""
    dx[0] = x[1]
    dx[1] = p.mu * x[1] - x[0] - x[0] ** 3


def pendulum(t, x, p, dx):
    """Its motions come to rest at the top as their period grows."""
    dx[0] = x[1]
    dx[1] = p.mu * x[1] - math.sin(x[0])


def predator(t, x, p, dx):
    """Lotka and Volterra's equations, with a growth that is lost at mu = 0."""
    dx[0] = x[0] * (1.0 - x[1]) + p.mu * x[0] * (x[0] - 1.0)
    dx[1] = x[1] * (x[0] - 1.0)


def of_spring(x, v):
    """Period of x'' + x + x^3 = 0 through a state, by its elliptic integral."""
    energy = 0.5 * v**2 + 0.5 * x**2 + 0.25 * x**4
    square = math.sqrt(1.0 + 4.0 * energy) - 1.0  # of the amplitude
    return 4.0 / math.sqrt(1.0 + square) * ellipk(0.5 * square / (1.0 + square))


def of_pendulum(x, v):
    """Period of x'' + sin x = 0 through a state."""
    return 4.0 * ellipk(0.25 * v**2 + math.sin(0.5 * x) ** 2)


def family(field, states, rest, points):
    """The cycles born at mu = 0, at the rest of the machine."""
    problem = small_problem(field, states, {"mu": -0.2}, "mu")
    equilibria = cw.continue_branch(problem, rest, RANGE)
    return cw.switch_branch(problem, equilibria, "HB1", RANGE, max_points=points)


def nothing_but_the_family(cycles, points):
    """No special point, no end: as many orbits as were asked for, none of which counts as unstable."""
    assert cycles.outcome.reason == "max_points", cycles.outcome
    assert [point.label for point in cycles.special_points] == ["EP"]
    assert len(cycles) >= points
    assert not cycles["unstable"].any()
    assert np.abs(cycles["mu"]).max() < 1e-6  # of errors of the steps: 1e-6 of what an orbit moves


@pytest.mark.drawn(1)
@pytest.mark.parametrize(
    ("field", "period", "points", "reached"),
    [(spring, of_spring, 60, 0.2), (pendulum, of_pendulum, 75, 2.0)],
    ids=["spring", "pendulum"],
)
def test_oscillations_without_losses_are_followed(field, period, points, reached):
    cycles = family(field, "xv", [0.0, 0.0], points)
    nothing_but_the_family(cycles, points)
    known = np.array([period(*state) for state in cycles["state"]])
    np.testing.assert_allclose(cycles["period"], known, rtol=1e-5)
    assert abs(math.log(cycles["period"][-1] / cycles["period"][0])) > math.log(1.0 + reached)


def test_predator_and_prey_are_followed():
    """Each cycle keeps x - log x + y - log y, by which their period grows."""
    cycles = family(predator, "xy", [1.0, 1.0], 50)
    nothing_but_the_family(cycles, 50)
    kept = (cycles["state"] - np.log(cycles["state"])).sum(axis=1)
    assert np.all(np.diff(kept) > 0.0)
    assert np.all(np.diff(cycles["period"]) > 0.0)
    assert cycles["period"][-1] > 10.0

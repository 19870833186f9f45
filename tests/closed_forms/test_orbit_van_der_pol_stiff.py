"""Relaxation oscillations: found by simulation, and continued over three decades of van der Pol's mu.

References: periods for mu = 10, 100, 1000 by SciPy's Radau and LSODA with relative tolerances of 3e-12
and 1e-12 (which
agree with each other to 3e-10), between two passages of x = 3/2. For large mu

    T = (3 - 2 log 2) mu + 3 alpha mu^(-1/3) - 2/3 log(mu) / mu + O(1 / mu),

-alpha the first zero of Airy's function (A. A. Dorodnitsyn, 1947; J. A. Zonneveld, 1966).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from small_systems import small_system

import contwalk as cw
from contwalk.system import System

PERIODS = {10.0: 19.07836956694, 100.0: 162.8370710924, 1000.0: 1614.401125815}
AIRY = 2.338107410459767


def asymptotic(mu: float) -> float:
    """The period but for O(1 / mu)."""
    return (3.0 - 2.0 * math.log(2.0)) * mu + 3.0 * AIRY / mu ** (1.0 / 3.0) - 2.0 / 3.0 * math.log(mu) / mu


def van_der_pol(mu: float) -> System:
    """x'' - mu (1 - x^2) x' + x = 0."""

    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = p.mu * (1.0 - x[0] ** 2) * x[1] - x[0]

    return small_system(field, "xy", {"mu": mu})


def lienard(eps: float) -> System:
    """The same in Lienard's plane, in slow time: eps x' = y - x^3 / 3 + x, y' = -x, eps = 1 / mu^2."""

    def field(t, x, p, dx):
        dx[0] = (x[1] - x[0] ** 3 / 3.0 + x[0]) / p.eps
        dx[1] = -x[0]

    return small_system(field, "xy", {"eps": eps})


def continued(system: System, free: str, bounds: tuple[float, float]) -> Any:
    problem = cw.PeriodicOrbit(
        system, system.defaults(), free, discretization=cw.Discretization(accuracy=1e-8)
    )
    return cw.continue_branch(problem, [2.0, 0.0], range=bounds, until="settled")


@pytest.mark.long
@pytest.mark.parametrize("mu", PERIODS)
def test_orbits_that_a_simulation_settles_on(mu: float) -> None:
    branch = continued(van_der_pol(mu), "mu", (mu, 1.002 * mu))
    assert branch.outcome.status == "complete"
    # the walk integrates to a local error of 1e-6; the phase forgets errors of all steps but those before a
    # jump
    assert branch.points[0]["period"] == pytest.approx(PERIODS[mu], rel=2e-8)


def test_three_decades_of_stiffness_in_one_branch() -> None:
    branch = continued(van_der_pol(1.0), "mu", (1.0, 1000.0))
    assert branch.outcome.status == "complete"
    mu, periods = branch.points["free"][:, 0], branch.points["period"]
    assert (mu[0], mu[-1]) == (1.0, 1000.0)
    assert periods[-1] == pytest.approx(PERIODS[1000.0], rel=2e-8)
    assert np.all(np.diff(periods) > 0.0)
    for value, period in zip(mu, periods, strict=True):
        if value > 10.0:
            # the next terms are -1.32 / mu, and powers mu^(-5/3) of coefficients near 1
            assert abs(period - asymptotic(value)) < 2.0 / value
    assert {point.label for point in branch.special_points} == {"EP"}
    # the orbit attracts: its multiplier is exp of an integral near -mu T / 2, but for the error of the steps
    assert np.all(branch.points["unstable"] == 0)
    assert np.all(np.abs(branch.points["spectrum"]) < 1e-3)
    # and no flow turns a plane over, however its steps let deviations decay
    assert np.all(branch.points["spectrum"].real >= 0.0)


@pytest.mark.long
def test_down_again() -> None:
    """From mu = 1000 to 1, past the change from the implicit to the explicit method."""
    branch = continued(van_der_pol(1000.0), "mu", (1.0, 1000.0))
    assert branch.outcome.status == "complete"
    mu, periods = branch.points["free"][:, 0], branch.points["period"]
    assert mu.min() == 1.0
    # known to all these digits from any table of van der Pol's oscillator
    assert periods[np.argmin(mu)] == pytest.approx(6.663286859, rel=1e-7)


@pytest.mark.long
def test_rates_of_eight_decades() -> None:
    """mu = 1e4: rates of 3e4 along the slow branch, which lasts 8e3: 2.4e8 of one in units of the other."""
    branch = continued(van_der_pol(1e4), "mu", (1e4, 1.005e4))
    assert branch.outcome.status == "complete"
    for row in branch.points:
        mu = float(row["free"][0])
        # -1.32 / mu, and the error of the steps: 2e-8 of the period
        assert abs(row["period"] - asymptotic(mu)) < 2.0 / mu + 2e-8 * row["period"]


@pytest.mark.long
def test_time_scales_of_ratio_1e7() -> None:
    eps = 1e-7
    branch = continued(lienard(eps), "eps", (eps, 1.2 * eps))
    assert branch.outcome.status == "complete"
    for row in branch.points:
        mu = float(row["free"][0]) ** -0.5
        # time in units of mu; -1.32 / mu^2 is 1.3e-7
        assert row["period"] == pytest.approx(asymptotic(mu) / mu, abs=2.0 / mu**2)

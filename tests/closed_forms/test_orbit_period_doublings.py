"""Period doublings in a Moebius band: place, normal form and doubled orbit in closed form."""

import math

import numpy as np
import pytest
from invariants import check_orbit_branch
from orbit_systems import ACCURACY, assert_met, moebius, orbits, period_of
from small_systems import labelled

import contwalk as cw

COEFFICIENT = 1e-6
WALKED = 100.0 * ACCURACY
T = period_of(2.0)


def exact_multipliers(lam, sigma, beta, kappa):
    """Of the doubled orbit: (r^2, a) obey an autonomous field that rests on it."""
    square = (1.0 - lam) / (sigma + beta * kappa)
    a, u = math.sqrt(square), 1.0 + kappa * square
    j = np.array([[-2.0 * u, 4.0 * u * kappa * a], [beta * a, 2.0 * sigma * square]])
    values = [*np.exp(2.0 * T * np.linalg.eigvals(j).astype(complex)), math.exp(-T)]
    return sorted(values, key=abs, reverse=True)


@pytest.mark.drawn(1)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("sigma", "beta", "kappa"), [(-1.0, 0.0, 0.0), (0.7, 0.0, 0.0), (-1.0, 3.0, 0.5), (1.0, -3.0, 0.5)]
)
def test_the_doubled_orbit_is_where_its_normal_form_says(sigma, beta, kappa):
    problem = orbits(moebius(sigma, beta, kappa), "lam")
    branch = cw.continue_branch(problem, [1.0, 0.0, 0.0, 0.0], (0.5, 1.4), period=T)
    check_orbit_branch(branch, problem)
    (point,) = labelled(branch, "PD", "LP", "BP", "NS")
    assert point.label == "PD"
    assert_met(point, "lam", 1.0)
    assert point.period == pytest.approx(T, rel=10 * ACCURACY)
    assert (point.unstable_before, point.unstable_after) == (0, 1)
    exact = [-1.0, -math.exp(-T / 2.0), math.exp(-2.0 * T)]
    np.testing.assert_allclose(point.spectrum, exact, rtol=0, atol=3 * ACCURACY)
    total = sigma + beta * kappa
    assert point.coefficients["c"] == pytest.approx(-T * total, rel=COEFFICIENT)
    assert abs(point.coefficients["c"] + T * total) <= point.coefficients["c_error"] + 1e-12
    assert point.criticality == ("supercritical" if total < 0 else "subcritical")
    doubled = cw.switch_branch(problem, branch, point, (0.6, 1.2))
    check_orbit_branch(doubled, problem)
    # One branch leaves, on the side and with the stability that c says.
    end = 1.2 if total < 0 else 0.6
    assert doubled["lam"][-1] == end
    assert doubled["s"][0] == 0.0
    for row in doubled.points[1:]:
        lam = float(row["free"][0])
        assert (1.0 - lam) / total > -10.0 * WALKED
        assert row["period"] == pytest.approx(2.0 * T, rel=30.0 * WALKED)
        if abs(lam - 1.0) < 1e-4:
            continue
        exact = exact_multipliers(lam, sigma, beta, kappa)
        # |lam - 1| is known to some errors of the walk, and the multiplier is 1 - 4 T (lam - 1).
        size = abs(exact[0])
        np.testing.assert_allclose(np.abs(row["spectrum"]), np.abs(exact), rtol=0, atol=30.0 * WALKED * size)
        r2 = 1.0 + kappa * (1.0 - lam) / total
        assert row["state"][:2] @ row["state"][:2] == pytest.approx(r2, rel=30.0 * WALKED)
        across = row["state"][2:] @ row["state"][2:]
        assert across == pytest.approx((1.0 - lam) / total, abs=30.0 * WALKED)


@pytest.mark.long
def test_without_a_declared_scale():
    """States that are zero on the whole branch have their size from nothing but the motion across it."""
    problem = orbits(moebius(-1.0, scale=None), "lam")
    branch = cw.continue_branch(problem, [1.0, 0.0, 0.0, 0.0], (0.5, 1.4), period=T)
    (point,) = labelled(branch, "PD", "LP", "BP", "NS")
    assert_met(point, "lam", 1.0)
    assert point.criticality == "supercritical"
    doubled = cw.switch_branch(problem, branch, point, (0.6, 1.2))
    check_orbit_branch(doubled, problem)
    assert doubled["lam"][-1] == 1.2


def test_a_range_round_the_point_that_is_switched_at():
    """The range of a switch need not contain where the parent began."""
    problem = orbits(moebius(-1.0), "lam")
    branch = cw.continue_branch(problem, [1.0, 0.0, 0.0, 0.0], (0.5, 1.4), period=T)
    doubled = cw.switch_branch(problem, branch, "PD1", (0.9, 1.2))
    assert doubled["lam"][-1] == 1.2


@pytest.mark.long
def test_the_doubled_orbit_of_a_doubled_orbit_is_not_invented():
    """The doubled orbit of the simplest band has positive multipliers: nothing happens on it."""
    problem = orbits(moebius(-1.0), "lam")
    branch = cw.continue_branch(problem, [1.0, 0.0, 0.0, 0.0], (0.5, 1.4), period=T)
    doubled = cw.switch_branch(problem, branch, "PD1", (0.5, 2.0))
    check_orbit_branch(doubled, problem)
    assert not labelled(doubled, "PD", "LP", "BP", "NS")
    assert doubled["lam"][-1] == 2.0

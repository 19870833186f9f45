"""Neimark-Sacker points with rotation number and normal form in closed form."""

import math

import pytest
from invariants import check_orbit_branch
from orbit_systems import ACCURACY, assert_met, orbits, period_of, torus
from small_systems import labelled

import contwalk as cw

pytestmark = pytest.mark.slow

# Normal forms are derivatives of third order of the integrator's map, on steps made for the located point.
COEFFICIENT = 1e-6


def walked(system, **settings):
    problem = orbits(system, "lam")
    branch = cw.continue_branch(
        problem, [1.0, 0.0, 0.0, 0.0], (0.5, 1.5), period=period_of(problem.parameters["omega"]), **settings
    )
    check_orbit_branch(branch, problem)
    return branch


def folded(turns):
    """The rotation number of a conjugate pair, 0..1/2."""
    part = turns % 1.0
    return min(part, 1.0 - part)


# Rotation numbers off the strong resonances, from less than one turn a round to several.
@pytest.mark.drawn(2)
@pytest.mark.parametrize("turns", [0.05, 0.3819660112501051, 0.7, 3.2])
@pytest.mark.parametrize(
    ("sigma", "beta", "kappa"), [(-1.0, 0.0, 0.0), (0.8, 0.0, 0.0), (-1.0, 3.0, 0.5), (1.0, -3.0, 0.5)]
)
def test_rotation_number_and_criticality(turns, sigma, beta, kappa):
    omega = 1.5
    branch = walked(torus(turns * omega, sigma, beta, kappa, omega))
    (point,) = labelled(branch, "NS", "PD", "LP", "BP")
    assert point.label == "NS"
    assert_met(point, "lam", 1.0)
    assert (point.unstable_before, point.unstable_after) == (0, 2)
    assert point.coefficients["rotation_number"] == pytest.approx(folded(turns), rel=10 * ACCURACY)
    assert point.coefficients["theta"] == pytest.approx(2 * math.pi * folded(turns), rel=10 * ACCURACY)
    total = sigma + beta * kappa  # the second pair of cases turns the sign of sigma
    d = 2.0 * period_of(omega) * total
    assert point.coefficients["d"] == pytest.approx(d, rel=COEFFICIENT)
    assert abs(point.coefficients["d"] - d) <= point.coefficients["d_error"] + 1e-12
    assert point.criticality == ("supercritical" if total < 0 else "subcritical")
    assert point.period == pytest.approx(period_of(omega), rel=10 * ACCURACY)


@pytest.mark.drawn(1)
@pytest.mark.parametrize(("accuracy", "beta"), [(1e-6, 0.5), (1e-6, 20.0), (1e-7, 20.0)])
def test_a_coefficient_that_is_zero_to_its_error_has_no_criticality(accuracy, beta):
    """sigma + beta kappa = 0: the torus is neither above nor below, and d is what the steps leave of it."""
    problem = orbits(torus(0.7, 0.5 * beta, beta, -0.5), "lam", accuracy)
    branch = cw.continue_branch(problem, [1.0, 0.0, 0.0, 0.0], (0.5, 1.3), period=period_of(1.5))
    (point,) = labelled(branch, "NS")
    assert point.criticality is None
    assert "zero to its error" in point.note
    assert abs(point.coefficients["d"]) <= point.coefficients["d_error"] < accuracy


@pytest.mark.drawn(1)
@pytest.mark.parametrize("excess", [1e-6, -1e-6])
def test_a_small_coefficient_that_is_known_has_one(excess):
    problem = orbits(torus(0.7, 0.25 + excess, 0.5, -0.5), "lam", 1e-6)
    branch = cw.continue_branch(problem, [1.0, 0.0, 0.0, 0.0], (0.5, 1.3), period=period_of(1.5))
    (point,) = labelled(branch, "NS")
    assert point.criticality == ("supercritical" if excess < 0 else "subcritical")


@pytest.mark.drawn(2)
@pytest.mark.parametrize(("q", "turns"), [(4, 0.25), (4, 0.75), (3, 1.0 / 3.0), (3, 5.0 / 3.0)])
def test_strong_resonances_are_named(q, turns):
    omega = 1.5
    branch = walked(torus(turns * omega, -1.0, omega=omega))
    (point,) = labelled(branch, "NS")
    assert_met(point, "lam", 1.0)
    assert f"1:{q}" in point.note
    assert point.criticality is None
    assert point.coefficients["rotation_number"] == pytest.approx(1.0 / q, rel=10 * ACCURACY)


def test_a_weak_resonance_is_none():
    """At one fifth of a turn the normal form is that of any other angle."""
    branch = walked(torus(0.3, -1.0, omega=1.5))
    (point,) = labelled(branch, "NS")
    assert point.note is None
    assert point.criticality == "supercritical"


@pytest.mark.long
def test_two_tori_from_one_cycle():
    """Passing back: the growth is a parabola of the parameter, and both crossings are found."""
    from small_systems import small_system

    def field(t, x, p, dx):
        s = x[0] ** 2 + x[1] ** 2
        dx[0] = (1.0 - s) * x[0] - 2.0 * x[1]
        dx[1] = 2.0 * x[0] + (1.0 - s) * x[1]
        a = 0.25 - (p.lam - 1.0) ** 2
        dx[2] = a * x[2] - 0.6 * x[3]
        dx[3] = 0.6 * x[2] + a * x[3] - x[3] ** 3

    problem = orbits(small_system(field, "xyuv", {"lam": 0.1}), "lam")
    branch = cw.continue_branch(problem, [1.0, 0.0, 0.0, 0.0], (0.0, 2.0), period=math.pi)
    check_orbit_branch(branch, problem)
    first, second = labelled(branch, "NS", "PD", "LP", "BP")
    assert_met(first, "lam", 0.5)
    assert_met(second, "lam", 1.5)
    assert (first.unstable_before, first.unstable_after) == (0, 2)
    assert (second.unstable_before, second.unstable_after) == (2, 0)

"""The double-well Duffing oscillator x'' + 0.3 x' - x + x^3 = F cos t: symmetry breaking, then period
doubling.
"""

import math

import numpy as np
import pytest
from independent_flow import passed
from invariants import check_orbit_branch
from orbit_systems import ACCURACY, assert_met
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.system import Symmetry

# By Newton's method on the (half) stroboscopic map with scipy's DOP853 at rtol 2.3e-14 and 1e-12, which
# agree to
# 3e-13, and Brent's method on det(M + 1): where a multiplier of the half map, then of the whole one, is -1.
BREAKING = 2.247962733915481
BREAKING_STATE = (1.977091844247455, 1.6097755530373672)
DOUBLING = 2.8345639957877022
DOUBLING_STATE = (0.7900570653208513, 2.312574767533642)
DOUBLING_SPECTRUM = (-1.0, -0.1518358)
# Stable symmetric orbit at F = 1.5, from a simulation.
START = (1.67967, 1.64822011)


def duffing(symmetric=True):
    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -p.d * x[1] + x[0] - x[0] * x[0] * x[0] + p.F * np.cos(t)

    def mirrored(t, x, p, image):
        image[0] = -x[0]
        image[1] = -x[1]

    symmetries = (Symmetry("mirror", "spatial", mirrored),) if symmetric else ()
    return small_system(
        field, ["x", "v"], {"d": 0.3, "F": 1.5}, period=lambda p: 2.0 * math.pi, symmetries=symmetries
    )


def problem_of(system):
    return cw.PeriodicOrbit(
        system, system.defaults(), "F", discretization=cw.Discretization(accuracy=ACCURACY)
    )


@pytest.fixture(scope="module")
def symmetric():
    problem = problem_of(duffing())
    return problem, cw.continue_branch(problem, START, (1.0, 3.0), direction="forward")


@pytest.fixture(scope="module")
def broken(symmetric):
    problem, branch = symmetric
    return cw.switch_branch(problem, branch, "BP1", (1.0, 3.0))


def test_the_symmetric_orbit_closes_up_to_its_image(symmetric):
    problem, branch = symmetric
    check_orbit_branch(branch, problem)
    assert branch.info.closure == "mirror"
    assert branch.info.settings["fold"] == 2
    np.testing.assert_allclose(branch["period"], math.pi, rtol=1e-14)
    point = labelled(branch, "BP", "PD", "LP", "NS")[0]
    assert (point.label, point.kind) == ("BP", "symmetry-breaking")
    assert_met(point, "F", BREAKING)
    np.testing.assert_allclose(list(point.state.values()), BREAKING_STATE, rtol=0, atol=3 * ACCURACY)
    assert point.period_full == pytest.approx(2.0 * math.pi, rel=1e-14)
    # Liouville: the half map's multipliers have the product exp(-0.3 pi).
    np.testing.assert_allclose(point.spectrum, [-1.0, -math.exp(-0.3 * math.pi)], rtol=0, atol=3 * ACCURACY)
    np.testing.assert_allclose(
        point.spectrum_full, [1.0, math.exp(-0.6 * math.pi)], rtol=0, atol=3 * ACCURACY
    )
    assert (point.unstable_before, point.unstable_after) == (0, 1)
    assert point.criticality == "supercritical"  # the simulation finds stable broken orbits beyond


def test_the_broken_orbit_doubles_its_period(symmetric, broken):
    problem, _ = symmetric
    check_orbit_branch(broken, problem)
    assert broken.info.closure == "full"
    np.testing.assert_allclose(broken["period"], 2.0 * math.pi, rtol=1e-14)
    assert np.all(broken["F"] >= BREAKING - 1e-9)
    points = labelled(broken, "BP", "PD", "LP", "NS")
    doublings = [p for p in points if p.label == "PD"]
    assert doublings
    first = min(doublings, key=lambda p: p.parameters["F"])
    assert_met(first, "F", DOUBLING)
    np.testing.assert_allclose(first.spectrum, DOUBLING_SPECTRUM, rtol=0, atol=1e-7)  # digits given
    # Of the broken orbit and its image half a period later, either may have been followed.
    own = np.array(list(first.state.values()))
    image = -passed(
        problem.system, first.parameters, np.array(DOUBLING_STATE), 0.0, math.pi, np.ones(2)
    ).states[-1]
    gap = min(np.abs(own - DOUBLING_STATE).max(), np.abs(own - image).max())
    assert gap < 30 * ACCURACY
    doubled = cw.switch_branch(problem, broken, first, (1.0, 2.9))
    check_orbit_branch(doubled, problem)
    np.testing.assert_allclose(doubled["period"], 4.0 * math.pi, rtol=1e-14)
    side = np.sign(doubled["F"][3] - DOUBLING)
    assert side == (1.0 if first.criticality == "supercritical" else -1.0)
    assert doubled["unstable"][3] == (0 if first.criticality == "supercritical" else 1)


@pytest.mark.long
def test_without_the_declaration_the_same_point_is_a_pitchfork():
    problem = problem_of(duffing(symmetric=False))
    branch = cw.continue_branch(problem, START, (1.0, 2.6), direction="forward")
    check_orbit_branch(branch, problem)
    assert branch.info.closure == "full"
    np.testing.assert_allclose(branch["period"], 2.0 * math.pi, rtol=1e-14)
    point = labelled(branch, "BP", "PD", "LP", "NS")[0]
    assert (point.label, point.kind, point.criticality) == ("BP", "pitchfork", "supercritical")
    assert_met(point, "F", BREAKING)
    other = cw.switch_branch(problem, branch, point, (1.0, 2.6))
    check_orbit_branch(other, problem)
    assert other["F"][0] == other["F"][-1] == 2.6

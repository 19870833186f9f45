"""The Brusselator with A = 1: the cycle that is born at B = 2."""

import math

import pytest
from invariants import check_branch, check_orbit_branch
from orbit_systems import ACCURACY
from small_systems import labelled, small_system

import contwalk as cw


def brusselator(t, x, p, dx):
    dx[0] = p.A - (p.B + 1.0) * x[0] + x[0] * x[0] * x[1]
    dx[1] = p.B * x[0] - x[0] * x[0] * x[1]


# Period and logarithm of the multiplier (the integral of the divergence), by the return to x = A with
# scipy's DOP853 at
# rtol 2.3e-14, after 40 rounds.
REFERENCE = {3.0: (7.15691992117987, -8.287520680265528), 2.5: (6.577284341905899, -3.4451574857356317)}


def test_the_cycle_from_its_birth():
    system = small_system(brusselator, "XY", {"A": 1.0, "B": 1.5})
    problem = cw.Equilibrium(
        system, system.defaults(), "B", discretization=cw.Discretization(accuracy=ACCURACY)
    )
    rest = cw.continue_branch(problem, [1.0, 1.5], (1.0, 3.0))
    check_branch(rest, problem)
    (hopf,) = labelled(rest, "HB", "LP", "BP")
    assert hopf.parameters["B"] == pytest.approx(2.0, rel=1e-14)
    branch = cw.switch_branch(problem, rest, "HB1", (1.0, 3.0), marks={"B": [2.5]})
    check_orbit_branch(branch, problem)
    assert branch.outcome.reason == "bound"
    assert branch["B"][0] == pytest.approx(2.0, rel=1e-12)
    assert branch["period"][0] == pytest.approx(2.0 * math.pi, rel=1e-10)
    assert not branch["unstable"].any()
    (mark,) = labelled(branch, "UZ")
    period, log = REFERENCE[2.5]
    assert mark.period == pytest.approx(period, rel=ACCURACY)
    assert mark.spectrum[0].real == pytest.approx(math.exp(log), rel=1e-6)
    end = branch.points[-1]
    period, log = REFERENCE[3.0]
    # A row of the walk: its local errors are 100 times the accuracy of a located point.
    assert end["free"][0] == 3.0
    assert end["period"] == pytest.approx(period, rel=300.0 * ACCURACY)
    assert end["spectrum"][0].real == pytest.approx(math.exp(log), abs=300.0 * ACCURACY)

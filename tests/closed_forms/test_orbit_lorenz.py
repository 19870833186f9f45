"""The Lorenz equations with sigma = 10, b = 8/3: the cycle born at rho = 470/19, down to its
homoclinic end.
"""

import math
import re

import numpy as np
import pytest
from invariants import check_branch, check_orbit_branch
from orbit_systems import ACCURACY
from scipy.integrate import solve_ivp
from small_systems import labelled, small_system

import contwalk as cw

# rho = sigma (sigma + b + 3) / (sigma - b - 1); there the pair has omega^2 = 2 sigma (sigma + 1) b / (sigma
# - b - 1).
HOPF = 470.0 / 19.0
# The homoclinic orbit of the origin, r = 13.926... in C. Sparrow, The Lorenz Equations (1982); further
# digits by
# the test below, which shoots along the origin's unstable manifold with scipy.
HOMOCLINIC = 13.9265574


def lorenz():
    def field(t, x, p, dx):
        dx[0] = p.sigma * (x[1] - x[0])
        dx[1] = x[0] * (p.rho - x[2]) - x[1]
        dx[2] = x[0] * x[1] - p.b * x[2]

    return small_system(field, "xyz", {"sigma": 10.0, "rho": 20.0, "b": 8.0 / 3.0})


@pytest.fixture(scope="module")
def equilibria():
    system = lorenz()
    problem = cw.Equilibrium(
        system, system.defaults(), "rho", discretization=cw.Discretization(accuracy=ACCURACY)
    )
    side = math.sqrt(8.0 / 3.0 * 19.0)
    return problem, cw.continue_branch(problem, [side, side, 19.0], (5.0, 30.0))


@pytest.fixture(scope="module")
def cycle(equilibria):
    problem, rest = equilibria
    return cw.switch_branch(problem, rest, "HB1", (5.0, 30.0))


def test_the_hopf_point(equilibria):
    problem, rest = equilibria
    check_branch(rest, problem)
    (hopf,) = labelled(rest, "HB", "LP", "BP")
    assert hopf.parameters["rho"] == pytest.approx(HOPF, rel=1e-14)
    assert hopf.criticality == "subcritical"
    omega = math.sqrt(20.0 * 11.0 * (8.0 / 3.0) / (10.0 - 8.0 / 3.0 - 1.0))
    assert hopf.coefficients["omega"] == pytest.approx(omega, rel=1e-13)


def test_the_cycle_is_unstable_all_the_way_down(equilibria, cycle):
    problem, _ = equilibria
    check_orbit_branch(cycle, problem, every=10)
    rho = cycle["rho"]
    # At the homoclinic end rho stands still to the local errors of the walk.
    assert np.all(np.diff(rho) < 100.0 * ACCURACY * HOMOCLINIC)
    assert np.all(cycle["unstable"][1:] == 1)
    assert np.all(np.diff(cycle["period"]) > 0.0)
    assert not labelled(cycle, "LP", "PD", "NS", "BP")
    # Liouville: the divergence is constant, so the multipliers' product is exp(-(sigma + 1 + b) T).
    for row in cycle.points[1::10]:
        if row["period"] < 1.5:
            total = float(np.sum(np.log(np.abs(row["spectrum"]))))
            assert total == pytest.approx(-(11.0 + 8.0 / 3.0) * row["period"], rel=1e-3)


def test_the_cycle_ends_at_the_homoclinic_orbit(cycle):
    assert cycle.outcome.reason == "homoclinic"
    assert cycle.outcome.status in ("complete", "stopped")
    (limit,) = re.findall(r"orbit at rho = ([0-9.]+[0-9])", cycle.outcome.message)
    # Extrapolated from local errors of the walk; HOMOCLINIC itself is known to 1e-7.
    assert float(limit) == pytest.approx(HOMOCLINIC, abs=1e-7 + 100.0 * ACCURACY)
    # T grows like -log(rho - rho_0) / lambda_u (the origin's one, 8.1 at rho = 13.93): a period of a few is
    # within 1e-6 of the end.
    assert cycle["rho"][-1] == pytest.approx(HOMOCLINIC, abs=1e-6)
    assert cycle["period"][-1] > 3.0


def test_the_homoclinic_orbit_itself():
    """Below it the origin's unstable manifold returns on its own side, above it crosses to the other one."""

    def turns_over(rho):
        rate = 0.5 * (-11.0 + math.sqrt(121.0 + 40.0 * (rho - 1.0)))
        start = 1e-8 * np.array([10.0, 10.0 + rate, 0.0])

        def right(t, x):
            return [10.0 * (x[1] - x[0]), x[0] * (rho - x[2]) - x[1], x[0] * x[1] - 8.0 / 3.0 * x[2]]

        def crosses(t, x):
            return x[0]

        def turns(t, x):  # dx/dt rises through zero: the motion is back and goes away again
            return x[1] - x[0]

        crosses.terminal, turns.terminal, turns.direction = True, True, 1.0
        found = solve_ivp(
            right, (0.0, 50.0), start, method="DOP853", rtol=1e-12, atol=1e-16, events=(crosses, turns)
        )
        return len(found.t_events[0]) > 0

    low, high = 13.0, 15.0
    assert not turns_over(low)
    assert turns_over(high)
    for _ in range(32):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if turns_over(middle) else (middle, high)
    assert low == pytest.approx(HOMOCLINIC, abs=1e-7)

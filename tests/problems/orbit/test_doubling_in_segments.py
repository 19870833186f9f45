"""Doubled orbits beside which deviations grow by more than one integration can carry."""

import math

import numpy as np
import pytest
from moebius import band
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.problems.initial.orbit_from_state import orbit_at
from contwalk.problems.orbit.transport import carried_to
from contwalk.problems.parameter_line import ParameterLine
from contwalk.system import State

RATE, LOW, HIGH = 12.0, 0.99, 1.04


def growing(t, x, p, dx):
    """The band, and a state that grows by exp(12 pi) = 2e16 in a round; cos(phi / 2) a drives it."""
    band(t, x, p, dx)
    s = x[0] ** 2 + x[1] ** 2
    r = s**0.5
    cos, sin = x[0] / r, x[1] / r
    dx[4] = RATE * x[4] - 0.5 * ((1.0 + cos) * x[2] + sin * x[3])


# The first as many as the growth asks for, the second as in a run file.
@pytest.mark.drawn(1)
@pytest.mark.parametrize("segments", [None, 20])
def test_a_doubled_orbit_is_never_integrated_in_one_piece(segments):
    states = ("x", "y", *(State(name, scale=1.0) for name in "zwu"))
    system = small_system(growing, states, {"lam": LOW})
    given = cw.Discretization(accuracy=1e-8, segments=segments)
    problem = cw.PeriodicOrbit(system, system.defaults(), "lam", discretization=given)
    branch = cw.continue_branch(problem, [1.0, 0.0, 0.0, 0.0, 0.0], (LOW, HIGH), period=math.pi)
    (point,) = labelled(branch, "PD")
    doubled = cw.switch_branch(problem, branch, point, (LOW, HIGH))
    assert doubled.outcome.reason == "bound"
    last = doubled.points[-1]
    # Local errors of 1e-6, a hundred times.
    assert last["period"] == pytest.approx(2.0 * math.pi, rel=1e-4)
    amplitude = np.max([doubled["max:z"][-1], -doubled["min:z"][-1]])
    assert amplitude == pytest.approx(math.sqrt(HIGH - 1.0), rel=1e-4)  # a, where phi = 0
    # Of a' = (lam - 1 - a^2) a over two rounds, and the growing state's.
    assert last["spectrum"][1].real == pytest.approx(math.exp(-4.0 * math.pi * (HIGH - 1.0)), rel=1e-4)
    assert math.log(abs(last["spectrum"][0])) == pytest.approx(2.0 * math.pi * RATE, rel=1e-5)


def test_a_normal_form_that_is_lost_beside_what_grows_is_no_degenerate_one():
    """Beside exp(20 pi) = 2e27 the coefficient, which is pi, was 4e-20 with an error of 2e-21."""

    def faster(t, x, p, dx):
        growing(t, x, p, dx)
        dx[4] += (20.0 - RATE) * x[4]

    states = ("x", "y", *(State(name, scale=1.0) for name in "zwu"))
    system = small_system(faster, states, {"lam": LOW})
    problem = cw.PeriodicOrbit(system, system.defaults(), "lam")
    branch = cw.continue_branch(problem, [1.0, 0.0, 0.0, 0.0, 0.0], (LOW, HIGH), period=math.pi)
    (point,) = labelled(branch, "PD")
    assert point.parameters["lam"] == pytest.approx(1.0, rel=1e-8)
    assert point.criticality is None
    assert "c" not in point.coefficients
    assert "degenerate" not in point.note
    assert "deviations grow by" in point.note


# Of the cycle at its period doubling, where y rises through zero.
START, PERIOD = (5.108149175136917, 0.0, 1.638400688937966), 5.76982001651013


def rossler(t, x, p, dx):
    dx[0] = -x[1] - x[2]
    dx[1] = x[0] + 0.2 * x[1]
    dx[2] = 0.2 + x[2] * (x[0] - p.c)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("cuts", [[0.0, 0.17, 0.5, 0.61], [0.0, 0.25, 0.5, 0.75]])
def test_a_doubled_orbit_is_begun_along_its_own_equations_wherever_it_is_cut(cuts):
    """The critical deviation of Rossler's cycle changes its period, that of the doubled orbit does not."""
    doubling = 2.832445027863
    system = small_system(rossler, "xyz", {"c": doubling})
    line = ParameterLine.of(system, system.defaults(), "c")
    given = cw.Discretization(scheme="collocation")
    problem, z = orbit_at(system, line, doubling, np.array(START), PERIOD, discretization=given)
    begun = [carried_to(problem, z, np.zeros(len(z)), cut)[0] for cut in cuts]
    z = problem.layout.joined(np.array(begun), problem.scalars(z), np.array(cuts))
    weights = problem.layout.joined(np.full((4, 3), 8.0), np.array([6.0, 3.0]), 1.0)
    problem = problem.adapted_to(z, weights, 1e-10)
    for _ in range(4):
        here = problem.linearize(z)
        z = z - np.append(np.linalg.solve(here.jacobian[:, :-1], here.residual), 0.0)
    (seed,) = problem.doubled_from(z)
    along = seed.tangent / np.linalg.norm(seed.tangent)
    assert np.abs(seed.problem.linearize(seed.z).jacobian @ along).max() < 1e-4

"""Orbits by collocation at Gauss points, in segments of equal growth."""

from __future__ import annotations

import numpy as np
import pytest
from small_systems import labelled, small_problem, small_system

import contwalk as cw
from contwalk.branch import Branch
from contwalk.diagram.reopening import reopened
from contwalk.problems.initial.orbit_from_state import orbit_at
from contwalk.problems.orbit.cutting import cuts_for
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.orbit.shooting import Mesh
from contwalk.problems.orbit.transport import closed, recut
from contwalk.problems.parameter_line import ParameterLine
from contwalk.verification.points import checked_point

COLLOCATION = Discretization(scheme="collocation")


def rotor(t, x, p, dx):
    """The circle of radius 1, on which the angle goes with the speed 1 / (1 + x / 2); it attracts."""
    radial, speed = p.k * (1.0 - x[0] ** 2 - x[1] ** 2), 1.0 / (1.0 + 0.5 * x[0])
    dx[0] = radial * x[0] - speed * x[1]
    dx[1] = radial * x[1] + speed * x[0]


def explosive(t, x, p, dx):
    """Beside the unit circle, gone round in 2 pi, deviations go as exp(c t + 17.3 sin t)."""
    r = np.sqrt(x[0] ** 2 + x[1] ** 2)
    rate = (p.c + 0.5 * np.log(1e15) * x[0] / r) * (r - 1.0)
    dx[0] = rate * x[0] / r - x[1]
    dx[1] = rate * x[1] / r + x[0]


def orbit_of(field, name, value, discretization):
    system = small_system(field, "xy", {name: value})
    line = ParameterLine.of(system, system.defaults(), name)
    return orbit_at(system, line, value, np.array([1.0, 0.0]), 2.0 * np.pi, discretization=discretization)


EVEN = np.linspace(0.0, 1.0, 17)[:-1]


def explosive_orbit(c, tolerance, cuts=EVEN):
    """The unit circle, cut at times that suit it."""
    problem, rough = orbit_of(explosive, "c", c, COLLOCATION)
    states = np.column_stack([np.cos(2.0 * np.pi * cuts), np.sin(2.0 * np.pi * cuts)])
    z = problem.layout.joined(states, problem.scalars(rough), cuts)
    weights = problem.layout.joined(np.full(states.shape, 4.0), np.array([6.0, 0.1]), 1.0)
    problem = problem.adapted_to(z, weights, tolerance)
    return problem, solved(problem, z)


def solved(problem, z):
    """Newton's method on a problem's own steps, the parameter held."""
    for _ in range(12):
        here = problem.linearize(z)
        z = z - np.append(np.linalg.solve(here.jacobian[:, :-1], here.residual), 0.0)
    return z


# Steps per round that show the order: above rounding, and few enough for errors to be seen.
STEPS = {2: (48, 96), 3: (24, 48), 4: (20, 32), 5: (28, 44), 6: (22, 30), 7: (14, 22)}


@pytest.mark.parametrize("degree", range(2, 8))
def test_periods_converge_with_twice_the_degree(degree):
    """One round takes 2 pi; on so many even steps the discretised orbit's period is off by h^(2 m)."""
    problem, z = orbit_of(rotor, "k", 0.2, COLLOCATION)
    errors = []
    for count in STEPS[degree]:
        mesh = problem.mesh
        steps = (np.linspace(0.0, 1.0, count + 1),)
        own = Mesh(steps, f"gauss{2 * degree}", 1e-8, mesh.variation, mesh.magnitudes)
        start = problem.layout.joined(problem.starts(z)[:1], problem.scalars(z))
        errors.append(abs(solved(problem.on(own, problem.section), start)[2] - 2.0 * np.pi))
    assert errors[1] > 3e-14
    coarse, fine = STEPS[degree]
    measured = np.log(errors[0] / errors[1]) / np.log(fine / coarse)
    assert measured == pytest.approx(2 * degree, rel=0.08)


@pytest.mark.parametrize("c", [-0.3, 0.1])
def test_multipliers_of_an_orbit_along_which_deviations_grow_by_1e15(c):
    found, z = explosive_orbit(c, 1e-12)
    assert found.duration(z) == pytest.approx(2.0 * np.pi, rel=1e-10)
    # Within the round they have grown by 1e15, and are back.
    product, grown, m = np.eye(2), 1.0, found.mesh.segments
    jacobian = found.linearize(z).jacobian
    for i in np.roll(np.arange(m), m // 4)[: m // 2]:
        product = jacobian[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] @ product
        grown = max(grown, float(np.linalg.norm(product, 2)))
    assert grown > 1e14
    (multiplier,) = found.multipliers(z, found.linearize(z).jacobian).values
    assert multiplier == pytest.approx(np.exp(2.0 * np.pi * c), rel=1e-8)


def test_multipliers_come_through_a_decay_by_1e15():
    """Segments are not parted where deviations decay: what is left of them is not what rounding leaves."""
    even, z = explosive_orbit(0.1, 1e-12)
    cuts = cuts_for(even, z, 64)
    assert np.diff(cuts).max() > 0.3
    found, z = explosive_orbit(0.1, 1e-12, cuts)
    (multiplier,) = found.multipliers(z, found.linearize(z).jacobian).values
    assert multiplier == pytest.approx(np.exp(0.2 * np.pi), rel=1e-8)


def test_cuts_stand_among_the_unknowns_and_stay():
    problem, z = explosive_orbit(0.1, 1e-6)
    m = problem.mesh.segments
    assert len(z) == 2 * m + (m - 1) + 2
    assert np.array_equal(problem.fitting(z).layout.begins, problem.mesh.cuts)
    again = problem.adapted_to(z, problem.beginnings(z))
    assert np.array_equal(again.mesh.cuts, problem.mesh.cuts)
    jacobian = problem.linearize(z).jacobian
    h = 1e-6
    for column in range(len(z)):  # the Jacobian is that of the equations, cuts included
        aside = np.zeros(len(z))
        aside[column] = h * max(abs(z[column]), 1e-2)
        change = problem.linearize(z + aside).residual - problem.linearize(z - aside).residual
        # over a segment deviations grow by up to a thousand, their second derivatives by more
        np.testing.assert_allclose(jacobian[:, column], change / (2.0 * aside[column]), rtol=1e-4, atol=1e-2)


def test_an_orbit_cut_anew_is_the_same():
    problem, z = explosive_orbit(0.1, 1e-9)
    there = problem.linearize(z)
    weights = problem.beginnings(z)
    sample = problem.examine(
        z, there.tangent(np.append(np.zeros(len(z) - 1), 1.0), weights), weights, there, None
    )
    cuts = cuts_for(problem, z, 64)
    assert len(cuts) < problem.mesh.segments
    assert np.ptp(np.diff(np.append(cuts, 1.0))) > 0.05  # growth is anything but even
    finer, again = closed(*recut(problem, sample, cuts))
    assert np.array_equal(finer.mesh.cuts, cuts)
    assert finer.duration(again.z) == pytest.approx(problem.duration(z), abs=1e-5)
    assert again.eigenvalues[0] == pytest.approx(sample.eigenvalues[0], rel=1e-4)


def morris_lecar(t, x, p, dx):
    v, w = x
    steady = 0.5 * (1.0 + np.tanh((v + 1.2) / 18.0))
    dx[0] = (p.I - 4.4 * steady * (v - 120.0) - 8.0 * w * (v + 84.0) - 2.0 * (v + 60.0)) / 20.0
    dx[1] = 0.04 * np.cosh((v - 2.0) / 60.0) * (0.5 * (1.0 + np.tanh((v - 2.0) / 30.0)) - w)


def cycles(discretization) -> tuple[Branch, object]:
    system = small_problem(morris_lecar, "vw", {"I": 0.0}, "I").system
    problem = cw.Equilibrium(system, system.defaults(), "I", discretization=discretization)
    equilibria = cw.continue_branch(problem, [-60.0, 0.01], (0.0, 300.0))
    return cw.switch_branch(problem, equilibria, "HB1", (0.0, 300.0)), system


@pytest.mark.long
def test_both_discretisations_find_the_same_folds():
    shot, _ = cycles(Discretization())
    collocated, system = cycles(COLLOCATION)
    assert collocated.outcome.reason == shot.outcome.reason == "shrunk"
    for a, b in zip(labelled(shot, "LP"), labelled(collocated, "LP"), strict=True):
        assert b.status == "located"
        assert abs(a.parameters["I"] - b.parameters["I"]) <= a.error + b.error
        assert b.error <= 1e-8 * b.parameters["I"]
    # A stored branch is taken up as what it is, whatever is asked of orbits now.
    fold = labelled(collocated, "LP")[0]
    problem, sample = reopened(system, collocated, fold, Discretization())
    assert problem.uneven
    assert len(sample.z) == len(fold.unknowns)
    assert checked_point(system, collocated, fold).verdict == "AGREES"


def nerve(t, x, p, dx):
    dx[0] = x[0] - x[0] ** 3 / 3.0 - x[1] + p.I
    dx[1] = 0.01 * (x[0] + 0.7 - 0.8 * x[1])


@pytest.mark.long
def test_an_explosion_in_which_the_parameter_stands_still_is_gone_through():
    """FitzHugh-Nagumo along its canards: the period grows, the parameter keeps all its digits, and nothing
    grows without bound."""
    system = small_problem(nerve, "vw", {"I": 0.0}, "I").system
    problem = cw.Equilibrium(system, system.defaults(), "I", discretization=COLLOCATION)
    equilibria = cw.continue_branch(problem, [-1.2, -0.6], (0.0, 2.0))
    cycle = cw.switch_branch(problem, equilibria, "HB1", (0.0, 2.0), max_points=106)
    assert cycle.outcome.reason == "max_points"
    rows = cycle.points[-10:]
    assert np.all(np.diff(rows["period"]) > 0.1)
    assert np.ptp(rows["free"]) < 1e-12
    assert abs(rows["spectrum"][-1][0]) > 1e3
    lengths = np.sum(np.isfinite(cycle.points["unknowns"]), axis=1)
    assert lengths[-1] > 20 > lengths[0]

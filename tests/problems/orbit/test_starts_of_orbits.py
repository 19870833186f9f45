"""Starts: neutral directions are held, given problems used, and multiples of a period reduced."""

import numpy as np
import pytest
from small_systems import circle, labelled, small_system

import contwalk as cw
from contwalk.problems.initial.orbit_from_state import orbit_at
from contwalk.problems.orbit.switching import _at
from contwalk.problems.parameter_line import ParameterLine
from contwalk.system import Neutral


def along(t, x, p, v):
    v[0] = v[1] = 0.0
    v[2] = 1.0


def drifting(t, x, p, dx):
    """A cycle of radius sqrt(mu), and a place that moves by the first state and by mu / 2 a second."""
    growth = p.mu - x[0] ** 2 - x[1] ** 2
    dx[0] = growth * x[0] - x[1]
    dx[1] = x[0] + growth * x[1]
    dx[2] = x[0] + x[1] ** 2


def test_a_declared_neutral_direction_is_held():
    system = small_system(drifting, "xyz", {"mu": 0.5}, neutral=(Neutral("along", along),))
    problem = cw.PeriodicOrbit(system, system.defaults(), "mu")
    start = [np.sqrt(0.5), 0.0, 3.0]
    branch = cw.continue_branch(problem, start, (0.1, 1.0), period=2.0 * np.pi)
    assert {p.kind for p in labelled(branch, "EP")} == {"bound"}
    assert [p.label for p in branch.special_points] == ["EP", "EP"]
    assert branch.info.settings["pins"] == ["along"]
    mu = branch["mu"]
    assert branch["period"] == pytest.approx(2.0 * np.pi, rel=1e-5)  # on steps of 1e-6
    # Only the cycle's own multiplier is left: neither the flow's nor that of the place.
    assert branch.points["spectrum"].shape[1] == 1
    assert branch.points["spectrum"][:, 0].real == pytest.approx(np.exp(-4.0 * np.pi * mu), abs=1e-4)


def test_whether_a_direction_is_neutral_is_asked_near_the_start():
    """The field does not exist from mu = 0.6 on; at the start, and beside it, the direction is neutral."""

    def field(t, x, p, dx):
        drifting(t, x, p, dx)
        dx[2] += np.sqrt(0.6 - p.mu)

    system = small_system(field, "xyz", {"mu": 0.5}, neutral=(Neutral("along", along),))
    start = np.array([np.sqrt(0.5), 0.0, 3.0])
    problem, _ = orbit_at(system, ParameterLine.of(system, system.defaults(), "mu"), None, start, 2.0 * np.pi)
    assert [pin.name for pin in problem.pins] == ["along"]


def test_pins_of_the_given_problem_are_used():
    """Nobody declared the direction: whoever makes the problem holds it."""
    system = small_system(drifting, "xyz", {"mu": 0.5})
    pins, start = (Neutral("along", along),), np.array([np.sqrt(0.5), 0.0, 3.0])
    problem = cw.PeriodicOrbit(system, system.defaults(), "mu", pins=pins, reference=start)
    branch = cw.continue_branch(problem, start, (0.4, 0.6), period=2.0 * np.pi)
    assert branch.info.settings["pins"] == ["along"]
    assert {p.kind for p in labelled(branch, "EP")} == {"bound"}


def shaken(t, x, p, dx):
    """x'' + 0.1 x' + (1 + h cos 2 t) x + x^3 = 0: above h = 0.2 it swings with half the frequency."""
    dx[0] = x[1]
    dx[1] = -0.1 * x[1] - (1.0 + p.h * np.cos(2.0 * t)) * x[0] - x[0] ** 3


def forced_orbits(subharmonic):
    system = small_system(shaken, "xv", {"h": 0.5}, period=lambda p: np.pi)
    return cw.PeriodicOrbit(system, system.defaults(), "h", subharmonic=subharmonic)


def test_the_subharmonic_of_the_given_problem_is_used():
    settled = cw.continue_branch(forced_orbits(1), [0.5, 0.0], (0.45, 0.55), until="settled")
    assert settled.info.subharmonic == 2
    state = settled.points["state"][int(np.argmin(np.abs(settled["h"] - 0.5)))]
    branch = cw.continue_branch(forced_orbits(2), state, (0.45, 0.55))
    assert branch.info.subharmonic == 2
    assert branch["period"] == pytest.approx(2.0 * np.pi, rel=1e-15)


@pytest.mark.parametrize("times", [2, 3, 6])
def test_a_forced_orbit_is_told_with_its_least_period(times):
    """At rest below the threshold: the multipliers are those of one period of the forcing."""
    system = small_system(shaken, "xv", {"h": 0.1}, period=lambda p: np.pi)
    problem = cw.PeriodicOrbit(system, system.defaults(), "h")
    branch = cw.continue_branch(problem, [0.0, 0.0], (0.05, 0.15), period=times * np.pi)
    assert branch.info.subharmonic == 1
    # Liouville: the determinant is exp(-0.1 pi).
    found = np.prod(branch.points["spectrum"], axis=1)
    assert found == pytest.approx(np.exp(-0.1 * np.pi), rel=1e-4)  # on steps of 1e-6


def test_an_autonomous_orbit_is_told_with_its_least_period():
    def cycle(t, x, p, dx):
        growth = p.mu - x[0] ** 2 - x[1] ** 2
        dx[0] = growth * x[0] - x[1]
        dx[1] = x[0] + growth * x[1]

    system = small_system(cycle, "xy", {"mu": 0.1})
    problem = cw.PeriodicOrbit(system, system.defaults(), "mu")
    branch = cw.continue_branch(problem, [np.sqrt(0.1), 0.0], (0.05, 0.2), period=6.0 * np.pi)
    assert branch["period"] == pytest.approx(2.0 * np.pi, rel=1e-5)


@pytest.mark.parametrize(
    ("time", "place", "sign"),
    [(0.25, 0.25, 1.0), (0.999, 0.999, 1.0), (1.0, 0.0, -1.0), (1.0 - 1e-13, 0.0, -1.0), (1.75, 0.75, -1.0)],
)
def test_doubled_orbits_begin_with_deviations_that_change_their_sign_each_round(time, place, sign):
    """Of the circle, where what is off outwards turns with it and dies out like exp(-2 mu t)."""
    system = small_system(circle, "xy", {"mu": 0.1})
    size = np.sqrt(0.1)
    problem, z = orbit_at(
        system, ParameterLine.of(system, system.defaults(), "mu"), None, np.array([size, 0.0]), 2.0 * np.pi
    )
    x, v = _at(problem, z, np.array([1.0, 0.0, 0.0, 0.0]), time)
    angle = 2.0 * np.pi * place
    way = np.array([np.cos(angle), np.sin(angle)])
    # On steps of 1e-6.
    assert x == pytest.approx(size * way, abs=1e-5)
    assert v == pytest.approx(sign * np.exp(-0.2 * angle) * way, abs=1e-5)

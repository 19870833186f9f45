"""Orbits displaced by a mode, as they are played."""

from __future__ import annotations

import math

import numpy as np
import pytest
from contwalk_systems.bouncing_ball import SYSTEM as BALL
from hybrid_runs import branch_of
from small_systems import circle, small_system

import contwalk as cw
from contwalk.errors import ContwalkError
from contwalk.workflow.stored.orbit_modes import displaced_along
from contwalk.workflow.stored.orbit_motions import motion_along
from contwalk.workflow.stored.orbits import orbit_at

# Pictures are drawn of orbits that are integrated to 1e-7.
PICTURED = 1e-5


@pytest.fixture(scope="module")
def circles():
    """Circles of radius sqrt(mu): a deviation across one decays as exp(-2 mu t)."""
    system = small_system(circle, ("x", "y"), {"mu": 0.1})
    problem = cw.PeriodicOrbit(system, system.defaults(), "mu")
    return system, cw.continue_branch(problem, [0.3, 0.0], range=(0.05, 0.15), period=2.0 * np.pi)


def test_a_circle_that_is_displaced_comes_back(circles):
    system, branch = circles
    orbit = orbit_at(system, branch, 1)
    mu, radius = orbit.parameters["mu"], np.sqrt(orbit.parameters["mu"])
    motion = motion_along(system, orbit, 2)
    shown = displaced_along(system, branch, 1, orbit, motion.states, 1, 0.3)
    assert shown.multiplier == pytest.approx(np.exp(-4.0 * np.pi * mu), rel=PICTURED)
    assert shown.words.startswith("mode 1: multiplier 0.")
    away = shown.states - motion.states
    # The largest part of the start is a state's 0.3 of half its range, to the positive side.
    largest = np.argmax(np.abs(away[0]))
    assert away[0, largest] == pytest.approx(0.3 * radius, rel=1e-3)
    outward = np.sum(away * motion.states, axis=1) / radius
    expected = outward[0] * np.exp(-2.0 * mu * (motion.times - motion.times[0]))
    np.testing.assert_allclose(outward, expected, atol=PICTURED * radius)
    along = away - outward[:, None] * motion.states / radius
    np.testing.assert_allclose(along, 0.0, atol=PICTURED * radius)


def test_a_ball_that_bounces_once_in_a_period_of_the_table():
    """Gravity is the same beside the orbit, so deviations go straight between bounces. Those after bounces
    obey the recurrence of a matrix of determinant e^2 and of a trace that is known.
    """
    amplitude, e, g, omega = 0.0095, 0.5, 9.81, 35.0
    speed = math.pi * g / omega
    phase = math.acos(speed * (1.0 - e) / ((1.0 + e) * amplitude * omega))
    passed = (2.0 * math.pi - phase) / omega
    state = [amplitude * math.sin(phase) + speed * passed - 0.5 * g * passed**2, speed - g * passed]
    given = {"A": amplitude, "e": e, "omega": omega, "g": g}
    branch = branch_of(BALL, "A", (0.009, 0.0096), state, given, max_points=2, direction="up")
    orbit = orbit_at(BALL, branch, 0)
    motion = motion_along(BALL, orbit, 3)
    shown = displaced_along(BALL, branch, 0, orbit, motion.states, 1, 0.1)
    away, jumps = shown.states - motion.states, np.flatnonzero(np.diff(motion.times) == 0.0) + 1
    size, starts = np.abs(away[0]).max(), []
    for flight in np.split(np.column_stack([motion.times, away]), jumps):
        t, y, v = flight.T
        np.testing.assert_allclose(v, v[0], atol=PICTURED * size)
        np.testing.assert_allclose(y - y[0], v[0] * (t - t[0]), atol=PICTURED * size)
        starts.append(flight[0, 1:])
    trace = 1.0 + e**2 - (1.0 + e) ** 2 * amplitude * omega**2 * math.sin(phase) / g
    expected = trace * starts[1] - e**2 * starts[0]
    np.testing.assert_allclose(starts[2], expected, atol=PICTURED * size)


@pytest.mark.parametrize(
    ("number", "amplitude", "said"),
    [
        (2, 0.3, "There is no mode 2: the orbit has 1 multiplier. Name mode 1."),
        (1, 0.0, "The amplitude 0 shows no displacement. Give a positive number."),
        (1, float("nan"), "The amplitude nan shows no displacement."),
    ],
)
def test_what_has_no_mode(circles, number, amplitude, said):
    system, branch = circles
    orbit = orbit_at(system, branch, 0)
    with pytest.raises(ContwalkError, match=said):
        displaced_along(system, branch, 0, orbit, orbit.states, number, amplitude)

"""Instants of a stored orbit: they are counted from the state that the database tells of it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hybrid_runs import branch_of, machine
from small_systems import small_system

import contwalk as cw
from contwalk.studies.margins.solution import magnitudes_of, solution_at
from contwalk.system import Transition

ZETA = 0.2


def damped(t, x, p, dx):
    dx[0], dx[1] = x[1], -x[0] - 2.0 * ZETA * x[1]


def kick(t, x, p, after):
    after[0], after[1] = x[0], x[1] + p.k


# A clock: a damped mass on a spring gets a kick each time it passes its middle upwards.
CLOCK = machine(
    ["x", "v"],
    {"k": 1.0},
    {"swings": damped},
    [Transition("tick", "swings", "swings", lambda t, x, p: -x[0], reset=kick)],
)
OMEGA = math.sqrt(1.0 - ZETA**2)
PERIOD = 2.0 * math.pi / OMEGA
SPEED = 1.0 / (1.0 - math.exp(-ZETA * PERIOD))  # after the kick


def swung(time):
    """State of the clock so long after its kick."""
    low = math.exp(-ZETA * time) * SPEED / OMEGA
    x, slope = low * math.sin(OMEGA * time), low * OMEGA * math.cos(OMEGA * time)
    return x, slope - ZETA * x


@pytest.mark.parametrize("side", ["before", "after"])
def test_an_orbit_told_at_an_event_begins_right_after_it(side):
    branch = branch_of(
        CLOCK, "k", (1.0, 1.1), swung(1.0), until=30.0, report_event=("tick", side), max_points=2
    )
    instants = solution_at(CLOCK, branch, 0, (0.0, 0.3)).instants
    assert instants[0].last == "tick"
    for instant in instants:
        np.testing.assert_allclose(instant.state, swung(instant.fraction * PERIOD), atol=1e-7)


def circling(t, x, p, dx):
    r2 = x[0] ** 2 + x[1] ** 2
    dx[0] = (p.mu - r2) * x[0] - x[1]
    dx[1] = x[0] + (p.mu - r2) * x[1]


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_an_orbit_told_at_a_section_begins_there(way):
    system = small_system(circling, ("x", "y"), {"mu": 1.0})
    steps = cw.Discretization(accuracy=1e-8, report_at=(0, 0.6, way))
    problem = cw.PeriodicOrbit(system, system.defaults(), "mu", discretization=steps)
    branch = cw.continue_branch(problem, [1.0, 0.0], range=(1.0, 1.1), period=2.0 * np.pi, max_points=2)
    begin = math.atan2(-way * 0.8, 0.6)
    for instant in solution_at(system, branch, 0, (0.0, 0.25)).instants:
        angle = begin + instant.fraction * 2.0 * math.pi
        np.testing.assert_allclose(instant.state, [math.cos(angle), math.sin(angle)], atol=1e-7)


def test_a_state_that_is_zero_but_for_rounding_has_the_magnitude_one():
    """Its own would be 1e-18, and no push would be looked for beyond 1e-15."""
    nan = float("nan")
    states = np.array([[3.0, 1e-18, 0.0, 5e-12, 0.2, nan], [1.0, -1e-18, 0.0, 5e-12, 0.2, nan]])
    np.testing.assert_allclose(
        magnitudes_of([None, None, None, None, 7.0, None], states), [1.0, 1.0, 1.0, 5e-12, 7.0, 1.0]
    )

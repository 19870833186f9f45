"""Starts of machines that conserve something: refused in a sentence where nothing can be followed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from conserved_machines import BALL, PENDULUM

import contwalk as cw
from contwalk.branch import Outcome
from contwalk.continuation.settings import Settings
from contwalk.errors import StartError
from contwalk.studies.opening import opened
from contwalk.studies.opening_orbits import opened_orbit
from contwalk.system import Conserved, Mode, Parameter, State, System


def test_an_equilibrium_is_not_continued_along_its_energy():
    outcome = opened(PENDULUM, PENDULUM.defaults(), "energy", np.zeros(2), Settings(range=(0.0, 1.0)))
    assert isinstance(outcome, Outcome)
    assert outcome.reason == "no_convergence"
    assert "An equilibrium has one value of 'energy'" in outcome.message


def test_an_equilibrium_has_its_own_energy():
    """That of the upright position is 2 g l, whatever nobody has given."""
    problem = cw.Equilibrium(PENDULUM, PENDULUM.defaults(), "l")
    branch = cw.continue_branch(problem, [math.pi, 0.0], (0.5, 2.0), marks={"l": [1.5]})
    for point in branch.special_points:
        length = point.parameters["l"]
        assert point.parameters["energy"] == pytest.approx(2.0 * 9.81 * length, rel=1e-14)


def test_a_start_outside_the_range_is_refused_by_its_own_value():
    with pytest.raises(StartError, match=r"The start has energy = 4\.50963, the range is \(5, 6\)"):
        cw.continue_branch(
            cw.PeriodicOrbit(PENDULUM, PENDULUM.defaults(), "energy"), [1.0, 0.0], (5.0, 6.0), period=2.15
        )


def test_a_value_that_is_not_reached_is_told_with_the_start_s_own():
    """Above 2 g l the pendulum goes round and round, and no swing has that energy."""
    parameters = PENDULUM.defaults() | {"energy": 40.0}
    outcome = opened_orbit(
        PENDULUM, parameters, "l", np.array([1.0, 0.0]), Settings(range=(0.9, 1.1)), period=2.15
    )
    assert isinstance(outcome, Outcome)
    assert "The start has energy = 4.50963, and 40 is asked for." in outcome.message


def van_der_pol(t, x, p, dx):
    dx[0], dx[1] = x[1], p.mu * (1.0 - x[0] ** 2) * x[1] - x[0]


def half_square(t, x, p):
    return 0.5 * (x[0] ** 2 + x[1] ** 2)


def test_what_is_conserved_for_some_parameters_only_is_refused_for_others():
    """At mu = 0, the default, the energy is conserved; the limit cycle of any other has none."""
    system = System(
        "van_der_pol",
        states=(State("x"), State("v")),
        parameters=(Parameter("mu", 0.0),),
        modes=(Mode("only", van_der_pol),),
        conserved=(Conserved("energy", half_square),),
    )
    outcome = opened_orbit(
        system,
        {"mu": 0.5, "energy": math.nan},
        "mu",
        np.array([2.0, 0.0]),
        Settings(range=(0.1, 1.0)),
        until="settled",
    )
    assert isinstance(outcome, Outcome)
    assert "'energy' is not conserved along the first orbit" in outcome.message


def test_an_impact_that_loses_is_seen_at_the_first_orbit():
    """With a reset that loses some part: what closes with a force that makes up for it is no orbit."""

    def loses(t, x, p, after):
        after[0], after[1] = x[0], -p.e * x[1]

    (bounce,) = BALL.transitions
    system = replace(
        BALL,
        parameters=(*BALL.parameters, Parameter("e", 1.0)),
        transitions=(replace(bounce, reset=loses),),
    )
    parameters = system.defaults() | {"e": 0.999}
    outcome = opened_orbit(
        system, parameters, "g", np.array([1.0, 0.0]), Settings(range=(5.0, 15.0)), mode="flight", until=0.0
    )
    assert isinstance(outcome, Outcome)
    assert "not conserved" in outcome.message

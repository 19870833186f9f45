"""Motions that turn: what is said where angles are not declared, or are periodic only together."""

from __future__ import annotations

import math

import numpy as np
import pytest

import contwalk as cw
from contwalk.errors import StartError
from contwalk.plugin_check.system import check_system
from contwalk.problems.initial.recurrence import Simulation
from contwalk.problems.parameter_line import ParameterLine
from contwalk.studies.orbit_start import OrbitStart
from contwalk.studies.turning import without_angles
from contwalk.system import Mode, Parameter, State, System

TURN = 2.0 * math.pi


def system(field, states):
    return System("rotors", states, (Parameter("torque", 1.0),), (Mode("only", field),))


def pendulum(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.torque - 0.5 * x[1] - 0.3 * np.sin(x[0])


def shaft(t, x, p, dx):
    """Two rotors, a spring between their angles: the field is the same where both have turned."""
    twist = 4.0 * (x[0] - x[1])
    dx[0] = x[2]
    dx[1] = x[3]
    dx[2] = p.torque - twist - 0.2 * (x[2] - x[3])
    dx[3] = twist - 0.2 * (x[3] - x[2]) - 0.5 * x[3] - 0.3 * np.sin(x[1])


def gears(t, x, p, dx):
    """As `shaft`, with wheels that turn against each other."""
    twist = 4.0 * (x[0] + x[1])
    dx[0] = x[2]
    dx[1] = x[3]
    dx[2] = p.torque - twist - 0.2 * (x[2] + x[3])
    dx[3] = -twist - 0.2 * (x[2] + x[3]) - 0.5 * x[3] - 0.3 * np.sin(x[1])


def drift(t, x, p, dx):
    """Nothing depends on x[0]: it drifts, and turns in nobody's eyes."""
    dx[0] = x[1]
    dx[1] = p.torque - 0.5 * x[1]


def told(field, names, state):
    states = tuple(State(name) for name in names)
    made = system(field, states)
    line = ParameterLine.of(made, made.defaults(), "torque")
    start = OrbitStart(made, line, None, np.array(state), settings=None, discretization=None)
    assert Simulation(made, start.values).states == states
    return without_angles(start, StartError("Nothing is known.", "Ask."))


@pytest.mark.parametrize(
    ("field", "names", "state", "words"),
    [
        (pendulum, "av", [0.0, 1.0], 'declare angles, State("a", period=2 * math.pi).'),
        (
            shaft,
            "abuv",
            [0.0, 0.0, 1.0, 1.0],
            'State("a", period=2 * math.pi), and in place of b write b - a,',
        ),
        (
            gears,
            "abuv",
            [0.0, 0.0, 1.0, -1.0],
            'State("a", period=2 * math.pi), and in place of b write b + a,',
        ),
        (drift, "av", [0.0, 1.0], "Nothing is known."),
    ],
)
def test_a_motion_that_turns_says_which_states_are_angles(field, names, state, words):
    assert words in str(told(field, names, state))


@pytest.mark.parametrize(
    ("field", "words"),
    [
        (shaft, "together: keep a as an angle, and in place of b write b - a, "),
        (
            gears,
            "against each other: keep a as an angle, and in place of b write b + a, ",
        ),
    ],
)
def test_declared_angles_that_are_periodic_together_have_their_difference_suggested(field, words):
    angles = State("a", period=TURN), State("b", period=TURN)
    found = check_system(system(field, (*angles, State("u"), State("v"))))
    (error,) = [each for each in found if each.what == "period of state 'a'"]
    assert words in error.sentence


def test_what_is_suggested_has_an_orbit():
    def suggested(t, x, p, dx):
        twist = -4.0 * x[1]
        dx[0] = x[2]
        dx[1] = x[3] - x[2]
        dx[2] = p.torque - twist - 0.2 * (x[2] - x[3])
        dx[3] = twist - 0.2 * (x[3] - x[2]) - 0.5 * x[3] - 0.3 * np.sin(x[0] + x[1])

    made = system(suggested, (State("a", period=TURN), State("d"), State("u"), State("v")))
    start = {"a": 0.0, "d": 0.0, "u": 1.0, "v": 1.0}
    found = cw.diagram(made, "torque", (0.95, 1.05), start={"simulate": {"state": start, "until": "settled"}})
    assert found["b1"].info.problem == "periodic_orbit"

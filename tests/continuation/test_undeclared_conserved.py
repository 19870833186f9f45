"""Machines with events that lose nothing, started beside their orbits: they are told to come in a family."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contwalk.branch import Outcome
from contwalk.continuation.settings import Settings
from contwalk.studies.opening_orbits import opened_orbit
from contwalk.system import Mode, Parameter, State, System, Transition


def hopper(loss):
    """A ball on a bed whose force grows with the cube of its depth, with some friction in it."""

    def fly(t, x, p, dx):
        dx[0], dx[1] = x[1], -p.g

    def sink(t, x, p, dx):
        dx[0], dx[1] = x[1], -p.g - p.k * (x[0] + 2.0 * x[0] ** 3) - loss * x[1]

    return System(
        "bed",
        states=(State("y"), State("v")),
        parameters=(Parameter("g", 1.0), Parameter("k", 30.0)),
        modes=(Mode("air", fly), Mode("bed", sink)),
        transitions=(
            Transition("down", "air", "bed", lambda t, x, p: x[0]),
            Transition("up", "bed", "air", lambda t, x, p: x[0], "rising"),
        ),
    )


def runner():
    """A mass on a massless leg, in units of its mass, leg and gravity."""

    def flight(t, x, p, dx):
        dx[1], dx[2], dx[3] = x[3], 0.0, -1.0

    def stance(t, x, p, dx):
        push = p.k * (1.0 / math.hypot(x[0], x[1]) - 1.0)
        dx[0], dx[1], dx[2], dx[3] = x[2], x[3], push * x[0], push * x[1] - 1.0

    def set_down(t, x, p, after):
        after[0], after[1], after[2], after[3] = -math.cos(p.angle), x[1], x[2], x[3]

    return System(
        "runner",
        states=(State("x"), State("y"), State("u"), State("v")),
        parameters=(Parameter("k", 22.0), Parameter("angle", 1.17)),
        modes=(Mode("flight", flight, states=("y", "u", "v")), Mode("stance", stance)),
        transitions=(
            Transition("down", "flight", "stance", lambda t, x, p: x[1] - math.sin(p.angle), reset=set_down),
            Transition("up", "stance", "flight", lambda t, x, p: math.hypot(x[0], x[1]) - 1.0, "rising"),
        ),
    )


@pytest.mark.parametrize(
    ("system", "free", "state", "until"),
    [
        (hopper(0.0), "k", [0.8, 0.0], "settled"),
        (hopper(0.0), "k", [0.8, 0.0], 0.0),
        (runner(), "angle", [0.0, 1.02, 1.6, 0.0], 0.0),
    ],
    ids=["settled", "bed", "runner"],
)
def test_family_is_told(system, free, state, until):
    found = opened_orbit(system, system.defaults(), free, np.array(state), Settings(), until=until)
    assert isinstance(found, Outcome)
    assert "Orbits come in a family there" in found.message
    assert "A second multiplier is 1" in found.message
    assert "conserved=(" in found.message


def test_machine_that_loses_is_none():
    system = hopper(0.4)
    found = opened_orbit(system, system.defaults(), "k", np.array([0.8, 0.0]), Settings(), until=0.0)
    assert "family" not in found.message

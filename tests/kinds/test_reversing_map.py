"""A multiplier that passes zero, of a clock whose map is the logistic one: a kind that a system declares."""

from __future__ import annotations

import math

import numpy as np
import pytest
from reversing_map import ReversingMap
from small_systems import labelled

import contwalk as cw
from contwalk.system import Mode, Parameter, State, System, Transition
from contwalk.verification.finding import AGREES
from contwalk.verification.points import checked_point

ACCURACY = 1e-8  # the default one


def decays(t, x, p, dx):
    """Between doses."""
    dx[0] = -p.k * x[0]
    dx[1] = -x[1]


def tick(t, x, p):
    """Once a second."""
    return math.sin(2.0 * math.pi * t)


def dosed(t, x, p, x_plus):
    """The second state is set: one multiplier is zero all along."""
    x_plus[0] = p.a * x[0] * (1.0 - x[0])
    x_plus[1] = x[0]


def doses():
    """From dose to dose x goes to a q x (1 - x), q = exp(-k): at 1 - 1 / (a q) the multiplier is 2 - a q."""
    return System(
        "doses",
        states=(State("x"), State("y")),
        parameters=(Parameter("a", 3.0), Parameter("k", 0.5)),
        modes=(Mode("only", decays),),
        transitions=(Transition("dose", "only", "only", tick, "rising", reset=dosed),),
        period=lambda p: 1.0,
        point_types=(ReversingMap(forgotten=1),),
    )


@pytest.mark.slow
def test_it_is_found_where_the_map_begins_to_reverse():
    system, q = doses(), math.exp(-0.5)
    fixed = 1.0 - 1.0 / (3.0 * q)
    orbit = cw.PeriodicOrbit(system, system.defaults(), "a")
    branch = cw.continue_branch(orbit, [fixed, fixed], (2.8, 3.8), until="settled")
    (point,) = labelled(branch, "ZM")
    assert (point.name, point.status) == ("ZM1", "located")
    assert abs(point.parameters["a"] - 2.0 / q) <= point.error < ACCURACY * 2.0 / q
    assert np.max(np.abs(point.spectrum)) < 1e-7  # both multipliers are zero to what the orbit is known to
    assert (point.unstable_before, point.unstable_after) == (0, 0)
    assert checked_point(system, branch, point).verdict == AGREES

"""Branches of orbits that begin at a pitchfork and come back to it: loops in closed form."""

import math

import numpy as np
import pytest
from orbit_systems import assert_met, orbits
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.system import Symmetry

# y^2 + (lam - 1/2)^2 = 1/25: from the pitchfork at 0.3 to the one at 0.7, and back.
BEGINS, ENDS = 0.3, 0.7


def across(t, x, p, out):
    """The last state with the other sign."""
    out[:] = x
    out[-1] = -x[-1]


def circle_with_loop(declared: bool):
    """The cycle x^2 + v^2 = 1, and across it y' = y (0.04 - (lam - 1/2)^2 - y^2), which is odd in y."""

    def field(t, x, p, dx):
        r = x[0] ** 2 + x[1] ** 2
        dx[0] = x[0] * (1.0 - r) - 2.0 * x[1]
        dx[1] = x[1] * (1.0 - r) + 2.0 * x[0]
        dx[2] = x[2] * (0.04 - (p.lam - 0.5) ** 2 - x[2] ** 2)

    mirror = Symmetry("mirror", "spatial", across)
    return small_system(field, ("x", "v", "y"), {"lam": 0.2}, symmetries=(mirror,) if declared else ())


def forced_loop(declared: bool):
    """The same across a forced linear oscillation."""

    def field(t, x, p, dx):
        dx[0] = -x[0] + np.cos(2.0 * math.pi * t)
        dx[1] = x[1] * (0.04 - (p.lam - 0.5) ** 2 - x[1] ** 2)

    mirror = Symmetry("mirror", "spatial", across)
    return small_system(
        field, ("x", "y"), {"lam": 0.2}, symmetries=(mirror,) if declared else (), period=lambda p: 1.0
    )


@pytest.mark.drawn(1)
@pytest.mark.parametrize("declared", [False, True], ids=["undeclared", "mirror"])
@pytest.mark.parametrize("forced", [False, True], ids=["cycle", "forced"])
def test_a_loop_through_two_pitchforks_is_closed(forced: bool, declared: bool) -> None:
    system = forced_loop(declared) if forced else circle_with_loop(declared)
    problem = orbits(system, "lam")
    start, period = ([0.0, 0.0], None) if forced else ([1.0, 0.0, 0.0], math.pi)
    parent = cw.continue_branch(problem, start, (0.0, 1.0), **({} if forced else {"period": period}))
    first, last = labelled(parent, "BP")
    assert_met(first, "lam", BEGINS)
    assert_met(last, "lam", ENDS)
    loop = cw.switch_branch(problem, parent, first.name, (0.0, 1.0))
    assert loop.outcome.reason == "closed", loop.outcome.message
    y = loop["y"]
    np.testing.assert_allclose(y**2 + (loop["lam"] - 0.5) ** 2, 0.04, atol=1e-9)
    assert y.min() < -0.19
    assert y.max() > 0.19
    # Once round: it meets the other pitchfork, and its own again.
    assert [round(p.parameters["lam"], 6) for p in labelled(loop, "BP")] == [ENDS, BEGINS]
    assert labelled(loop, "LP", "PD", "NS") == []

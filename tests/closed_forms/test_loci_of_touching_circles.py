"""Curves of grazings of the circle of radius sqrt(mu) at x = c: of an event that changes nothing, and of a
visit to another mode that has become none. In closed form mu = c^2."""

from __future__ import annotations

import numpy as np
import pytest
from hybrid_runs import diagram, machine
from loci_of_orbits import FINE, WALKED, labels
from small_systems import labelled

import contwalk as cw
from contwalk.system import System, Transition

START = {"mu": 0.5, "c": 1.0}


def circle(t, x, p, dx):
    g = p.mu - x[0] ** 2 - x[1] ** 2
    dx[0] = g * x[0] - 2.0 * x[1]
    dx[1] = 2.0 * x[0] + g * x[1]


def pushed(t, x, p, dx):
    circle(t, x, p, dx)
    dx[1] = dx[1] + 3.0 * (x[0] - p.c)


def touch(t, x, p):
    return x[0] - p.c


def passing() -> System:
    """At x = c something happens that changes nothing."""
    return machine("xy", START, {"only": circle}, (Transition("touch", "only", "only", touch, "rising"),))


def visiting() -> System:
    """Beyond x = c the motion is pushed."""
    there = Transition("touch", "free", "beyond", touch, "rising")
    back = Transition("back", "beyond", "free", touch, "falling")
    return machine("xy", START, {"free": circle, "beyond": pushed}, (there, back))


@pytest.mark.drawn(1)
@pytest.mark.parametrize(("system", "mu", "x"), [(passing, 0.5, 0.7), (visiting, 1.5, 1.2)])
def test_a_circle_that_touches(system, mu, x) -> None:
    """Where nothing changes, or a visit lasts no time, rounding tells neither folds nor doublings."""
    made = system()
    start = [x, 0.0], {"mu": mu}
    branch, *_ = diagram(made, "mu", (0.3, 1.7), *start, until="settled", mode=made.modes[0].name)
    (point,) = labelled(branch, "GR")
    curve = cw.continue_locus(made, branch, point, {"mu": (0.4, 1.6), "c": (0.7, 1.2)}, **FINE)
    assert curve.outcome.reason == "bound"
    assert labels(curve) == []
    assert np.max(np.abs(curve["mu"] - curve["c"] ** 2)) < WALKED
    assert (curve["c"].min(), curve["c"].max()) == (0.7, 1.2)
    assert len(curve["c"]) < 60

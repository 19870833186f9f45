"""Doublings where the parameter stands still: located along the branch, and checked, by their multiplier.

On Roessler's spiral, where the parameter moves, both ways have to find the same point. Along the canards of a
Hindmarsh-Rose neuron (r = 0.001, near I = 5.4607928) only the multiplier finds them, in minutes.
"""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.problems.located import Located
from contwalk.problems.orbit import augmented
from contwalk.problems.orbit.multipliers import Multipliers
from contwalk.problems.orbit.points.period_doubling import FlatDoubling, PeriodDoubling

START, PERIOD = [-0.5106358874614251, -6.758094052655368, 0.03773321158082464], 11.56483917784737
# Displacement along the branch from the doubling: the ways begin beside it.
BESIDE = 1e-4


def spiral(t, x, p, dx):
    dx[0] = -x[1] - x[2]
    dx[1] = x[0] + 0.2 * x[1]
    dx[2] = 0.2 + x[2] * (x[0] - p.c)


@cache
def beside_the_doubling():
    system = small_system(spiral, ("x", "y", "z"), {"c": 3.750158598218444})
    asked = cw.Discretization(accuracy=1e-8)
    problem = cw.PeriodicOrbit(system, system.defaults(), "c", discretization=asked)
    branch = cw.continue_branch(problem, START, (3.74, 3.86), period=PERIOD)
    (point,) = labelled(branch, "PD")
    z, tangent = np.array(point.unknowns), np.array(point.tangent)
    there = problem.finely(z)
    z = z + BESIDE * tangent
    weights = there.weighted(there.mesh.magnitudes)
    return point, there, there.examine(z, tangent, weights, there.linearize(z), None)


@pytest.mark.parametrize("kind", [FlatDoubling(), PeriodDoubling()])
def test_both_ways_find_the_same_doubling(kind):
    point, there, sample = beside_the_doubling()
    found = kind.locate(there, sample, 0).settled()
    assert abs(sample.parameter - point.parameters["c"]) > 1e3 * (found.error + point.error)
    assert abs(found.z[-1] - point.parameters["c"]) <= found.error + point.error


@pytest.mark.parametrize(
    ("multiplier", "accuracy", "kept"),
    [
        (-1.0 + 1e-6, 1e-7, True),
        (-74.0, 1.5, False),  # told as a doubling of Hindmarsh-Rose's canards
        (0.64, 6.5e-3, False),
        (-74.0, 10.0, True),  # not known well enough to tell
        (np.nan, np.inf, True),
    ],
)
def test_a_doubling_has_its_multiplier(multiplier, accuracy, kept):
    each = np.array([accuracy, 1e-9])
    values = Multipliers(np.array([multiplier, 0.0], dtype=complex), np.zeros(2), accuracy, accuracies=each)
    orbit = SimpleNamespace(
        linearize=lambda z: SimpleNamespace(jacobian=None), multipliers=lambda z, jacobian: values
    )
    found = Located(np.zeros(3), 1e-9, problem=orbit)
    assert augmented._with_multiplier(found, -1.0) is (found if kept else None)
    assert augmented._with_multiplier(None, -1.0) is None

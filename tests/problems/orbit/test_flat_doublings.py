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
from contwalk.problems.orbit.critical_along import along_branch
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
    values.values[0] *= -1.0
    assert augmented._with_multiplier(found, 1.0) is (found if kept else None)


class Turning:
    """Two multipliers of a large product, whose sum goes through zero within 1e-8 of the branch z[0]."""

    product, steep = 1e64, 1e72
    size, discretization = 1, None

    def linearize(self, z):
        at = SimpleNamespace(jacobian=z)
        at.with_row = lambda value, row: (np.array([z[1], value]), np.array([[0.0, 1.0], row]))
        return at

    def multipliers(self, z, jacobian):
        total = self.steep * z[0]
        root = np.sqrt(complex(total**2 - 4.0 * self.product))
        larger = 0.5 * (total + np.copysign(1.0, total) * root)
        values = np.array([larger, self.product / larger])
        return SimpleNamespace(values=values if root.imag else values.real.astype(complex))


@pytest.mark.parametrize("critical", [1.0, -1.0])
def test_a_multiplier_that_passes_both_circles_within_little_has_a_rate(critical):
    """Its logarithm exists on one side alone, for less than the displacement that rates were told by."""
    orbit, steep = Turning(), Turning.steep / Turning.product
    place = critical * 1.1 / steep  # beside the point, which is at 1 / steep
    sample = SimpleNamespace(
        z=np.array([place, 0.0]), tangent=np.array([1.0, 0.0]), weights=np.ones(2), parameter=0.0
    )
    system = along_branch(orbit, sample, critical)
    residual, rows = system.evaluate(orbit, sample.z)
    # the smaller multiplier is the product over the larger one
    assert residual[-1] == pytest.approx(-np.log(1.1), rel=1e-9)
    # differences over a displacement of a tenth of where the multiplier is are right to its square
    assert rows[-1, 0] == pytest.approx(-1.0 / place, rel=0.02)
    values = [
        system.evaluate(orbit, np.array([critical * x / steep, 0.0]))[0][-1]
        for x in (1e3, 10.0, 0.9, 0.1, 0.0, -0.5, -10.0, -1e3)
    ]
    signs = np.sign(values)
    assert signs.tolist() == [signs[0]] * 2 + [-signs[0]] * 6

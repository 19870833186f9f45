"""Cycles that fold at mu = -1/4 and are born at mu = 0, with and without shear of the phase."""

from __future__ import annotations

import numpy as np
import pytest
from small_systems import labelled, small_system

import contwalk as cw


def cycles(t, x, p, dx):
    # r' = r (mu + r^2 - r^4), phase' = 1 + twist r^2
    r2 = x[0] ** 2 + x[1] ** 2
    growth, turn = p.mu + r2 - r2**2, 1.0 + p.twist * r2
    dx[0] = growth * x[0] - turn * x[1]
    dx[1] = turn * x[0] + growth * x[1]


@pytest.mark.drawn(3)
@pytest.mark.parametrize("twist", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("accuracy", [1e-4, 1e-6, 1e-8])
def test_the_fold_is_found_to_the_accuracy_asked(twist, accuracy):
    system = small_system(cycles, ("x", "y"), {"mu": -0.2, "twist": twist})
    problem = cw.PeriodicOrbit(
        system, system.defaults(), "mu", discretization=cw.Discretization(accuracy=accuracy)
    )
    radius = np.sqrt(0.5 + np.sqrt(0.25 - 0.2))  # of the stable cycle at mu = -0.2
    period = 2.0 * np.pi / (1.0 + twist * radius**2)
    branch = cw.continue_branch(
        problem, [radius, 0.0], range=(-0.3, -0.1), period=period, direction="backward"
    )
    (fold,) = labelled(branch, "LP", "BP")
    assert (fold.label, fold.status) == ("LP", "located")
    assert abs(fold.parameters["mu"] + 0.25) <= accuracy * 0.25
    assert abs(fold.parameters["mu"] + 0.25) <= 5.0 * fold.error  # five times: the estimate is one
    # at the fold r^2 = 1/2
    assert fold.period == pytest.approx(2.0 * np.pi / (1.0 + 0.5 * twist), rel=accuracy)

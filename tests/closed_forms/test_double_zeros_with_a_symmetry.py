"""Double zeros of odd fields: Hopf points meet branch points that persist, not folds.

x'' = mu x + nu x' - x^3 - x^2 x' (Guckenheimer & Holmes 1983, section 7.3): the equilibrium zero has Hopf
points where nu = 0 > mu and branch points where mu = 0; those beside it have Hopf points where nu = mu > 0.
"""

from __future__ import annotations

import numpy as np
import pytest
from small_systems import labelled, small_system

import contwalk as cw

RANGES = {"mu": (-1.0, 1.0), "nu": (-1.0, 1.0)}


def odd(t, x, p, dx):
    """An odd oscillator."""
    dx[0] = x[1]
    dx[1] = p.mu * x[0] + p.nu * x[1] - x[0] ** 3 - x[0] ** 2 * x[1]


@pytest.fixture(scope="module")
def system() -> cw.system.System:
    return small_system(odd, ["x", "y"], {"mu": -0.5, "nu": -0.5})


def followed(system, free: str, point: str, other: str):
    problem = cw.Equilibrium(system, system.defaults(), free)
    branch = cw.continue_branch(problem, [0.0, 0.0], range=RANGES[free])
    return cw.continue_locus(system, branch, point, {free: RANGES[free], other: RANGES[other]})


def test_hopf_points_pass_the_double_zero_where_their_own_parameter_stands_still(system) -> None:
    """The curve is nu = 0 throughout, and leads from the focus to the saddle."""
    curve = followed(system, "nu", "HB1", "mu")
    assert curve.outcome.reason == "bound"
    assert np.all(curve["nu"] == 0.0)
    assert (curve["mu"].min(), curve["mu"].max()) == RANGES["mu"]
    for label in ("BT", "BP"):
        (point,) = labelled(curve, label)
        assert point.status == "located"
        assert abs(point.parameters["mu"]) <= point.errors["mu"] < 1e-30


def test_branch_points_have_it_as_well(system) -> None:
    curve = followed(system, "mu", "BP1", "nu")
    (point,) = labelled(curve, "BT")
    assert abs(point.parameters["nu"]) <= point.errors["nu"] < 1e-30

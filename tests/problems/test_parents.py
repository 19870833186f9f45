"""A step onto the branch that the own one left is told by the symmetry that the parent has."""

from __future__ import annotations

import numpy as np
import pytest

import contwalk as cw
from contwalk.errors import NotFinite
from contwalk.problems.parents import gained_symmetry
from contwalk.system import Mode, Parameter, State, Symmetry, System


def told(before, after):
    return gained_symmetry(lambda: before, lambda: after)


def test_what_is_left_of_an_asymmetry_decides():
    assert told({"itself": 0.1}, {"itself": 1e-9})
    assert not told({"itself": 0.1}, {"itself": 0.01})
    assert not told({"itself": 0.1}, {"itself": 0.1})


def test_an_asymmetry_as_small_as_errors_tells_nothing():
    assert not told({"itself": 1e-5}, {"itself": 1e-13})


def test_another_symmetry_does_not_hide_the_one_that_is_gained():
    assert told({"itself": 0.2, "mirror 1": 0.3}, {"itself": 1e-8, "mirror 1": 0.3})


def test_a_motion_that_ends_tells_nothing():
    def ends():
        raise NotFinite("the motion ends", "nothing to do")

    assert not gained_symmetry(lambda: {"itself": 0.1}, ends)


def bubble() -> System:
    """x = 0, and x^2 = lam (1 - lam) between two pitchforks."""

    def field(t, x, p, dx):
        dx[0] = x[0] * (p.lam * (1.0 - p.lam) - x[0] ** 2)
        dx[1] = 1.0 - x[1]

    def mirror(t, x, p, y):
        y[0], y[1] = -x[0], x[1]

    return System(
        name="bubble",
        states=(State("x"), State("y")),
        parameters=(Parameter("lam", 0.5),),
        modes=(Mode("m", field),),
        symmetries=(Symmetry("mirror", "spatial", mirror),),
    )


def test_an_equilibrium_on_a_mirror_is_a_parent():
    problem = cw.Equilibrium(bubble(), bubble().defaults(), "lam")
    aside, mirrored = np.array([0.3, 1.0, 0.9]), np.array([0.0, 1.0, 0.97])
    assert problem.gains_symmetry(aside, mirrored)
    assert not problem.gains_symmetry(aside, np.array([-0.05, 1.0, 0.9975]))
    assert not problem.gains_symmetry(mirrored, aside)


def test_a_branch_comes_back_through_its_pitchforks():
    problem = cw.Equilibrium(bubble(), bubble().defaults(), "lam")
    branch = cw.continue_branch(problem, [0.5, 1.0], (-0.5, 1.5))
    points = sorted(p.parameters["lam"] for p in branch.special_points if p.label == "BP")
    assert points == pytest.approx([0.0, 1.0], abs=1e-12)
    assert branch.outcome.reason == "closed"

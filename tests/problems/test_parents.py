"""A step onto the branch that the own one left is told by the symmetry that the parent has."""

from __future__ import annotations

import math

import numpy as np
import pytest
from contwalk_systems.bouncing_ball import SYSTEM as BALL
from hybrid_runs import diagram

import contwalk as cw
from contwalk.diagram.reopening import reopened
from contwalk.errors import NotFinite
from contwalk.problems.parents import SymmetriesLost, gained_symmetry, kept_symmetry
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


def test_beside_a_branch_point_the_way_that_breaks_a_symmetry_tells_how_much():
    def kept(guess, after, point=1e-10):
        return kept_symmetry(lambda: {"itself": point}, lambda: guess, lambda: after)

    assert kept({"itself": 1e-6}, {"itself": 1e-9})
    assert not kept({"itself": 1e-6}, {"itself": 8e-7})
    # On walking steps a solution of the parent's may be this asymmetric (a gear that rattles).
    assert kept({"itself": 1e-4}, {"itself": 1e-5})
    # A way as short as what the branch point is known to tells nothing, but where it has led far away.
    assert kept({"itself": 9.2e-7}, {"itself": 5e-6}, point=9.2e-7)
    assert not kept({"itself": 2.4e-9}, {"itself": 2.5e-6}, point=2.3e-9)
    assert not kept({"itself": 2.0}, {"itself": 2.0}, point=2.0)  # none has it
    # A way that keeps it, and one that is known to rounding only.
    assert not kept({"itself": 1e-12}, {"itself": 0.0})
    # One symmetry may be broken, and another stay.
    assert not kept({"itself": 1e-3, "mirror 1": 0.0}, {"itself": 1e-3, "mirror 1": 0.0})


def test_a_branch_does_not_begin_on_the_one_that_it_leaves(monkeypatch):
    problem = cw.Equilibrium(bubble(), {"lam": 0.5}, "lam")
    parent = cw.continue_branch(problem, [0.0, 1.0], (-0.5, 1.5))
    assert cw.switch_branch(problem, parent, "BP1", (-0.5, 1.5)).outcome.reason == "closed"
    # What is found keeps the symmetry that the way there breaks.
    monkeypatch.setattr(cw.Equilibrium, "keeps_symmetry", lambda self, point, guess, z: abs(guess[0]) > 0.0)
    lost = cw.switch_branch(problem, parent, "BP1", (-0.5, 1.5))
    assert lost.outcome.status == "failed"
    assert "what is found is that one's" in lost.outcome.message


def test_a_motion_that_ends_tells_nothing():
    def ends():
        raise NotFinite("the motion ends", "nothing to do")

    assert not gained_symmetry(lambda: {"itself": 0.1}, ends)


def test_a_symmetry_that_was_lost_and_stays_is_that_of_the_parent():
    lost = SymmetriesLost()

    def regained(before, after):
        return lost.regained(lambda: {"itself": before}, lambda: {"itself": after})

    assert not regained(0.0, 1e-8)  # had from the first on
    assert not regained(1e-8, 0.2)
    assert not regained(0.2, 1e-8)  # it may be passed
    assert not regained(1e-8, 0.2)
    assert regained(1e-8, 1e-9)


def cycle() -> System:
    """x^2 + y^2 = lam."""

    def field(t, x, p, dx):
        room = p.lam - x[0] ** 2 - x[1] ** 2
        dx[0] = room * x[0] - x[1]
        dx[1] = room * x[1] + x[0]

    return System(
        name="cycle",
        states=(State("x"), State("y")),
        parameters=(Parameter("lam", 0.1),),
        modes=(Mode("m", field),),
    )


def test_a_walk_that_slides_onto_its_parent_says_so(monkeypatch):
    """No step gains much: what is left of an asymmetry falls by less than a factor of a hundred with each."""
    problem = cw.PeriodicOrbit(cycle(), {"lam": 0.1}, "lam")
    monkeypatch.setattr(cw.PeriodicOrbit, "asymmetries", lambda self, z: {"itself": 10.0 ** (-10.0 * z[-1])})
    branch = cw.continue_branch(
        problem, [math.sqrt(0.1), 0.0], (0.05, 1.5), period=2.0 * math.pi, direction="forward", max_step=0.05
    )
    assert (branch.outcome.status, branch.outcome.reason) == ("failed", "no_convergence")
    assert "has come onto the branch" in branch.outcome.message
    walked = np.unique(branch["lam"])
    assert walked[-3] < 0.6 < walked[-2]  # where 1e-6 is left
    assert branch.special_points[-1].index < len(branch)


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


def test_a_machine_s_doubled_orbit_is_far_from_its_parent_run_through_twice():
    """A ball on a moving table: two bounces that differ, beside one bounce told as two."""
    g, omega, e, a = 9.81, 35.0, 0.5, 0.0095
    speed = math.pi * g / omega  # after a bounce
    cosine = speed * (1.0 - e) / ((1.0 + e) * a * omega)
    passed = (2.0 * math.pi - math.acos(cosine)) / omega
    height = a * math.sqrt(1.0 - cosine**2)
    start = height + speed * passed - 0.5 * g * passed**2, speed - g * passed
    given = {"e": e, "A": a, "omega": omega, "g": g}
    found = diagram(BALL, "A", (0.009, 0.0124), start, given, follow=["PD"], events={"GR": "ignore"})
    doubled = found[1]
    (_, born), (problem, sample) = (reopened(BALL, doubled, row) for row in (0, len(doubled.points) - 1))
    assert doubled.outcome.reason == "bound"
    assert problem.gains_symmetry(sample.z, born.z)
    assert not problem.gains_symmetry(born.z, sample.z)
    assert not problem.gains_symmetry(sample.z, sample.z + 1e-3 * sample.tangent)

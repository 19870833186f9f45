"""Special points of orbits of every kind, by shooting and by collocation: the same, within their errors."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from contwalk_systems.impact_oscillator import SYSTEM as OSCILLATOR
from hybrid_runs import diagram, solution
from one_impact import forced, parameters, stiffness
from orbit_systems import moebius, torus, transverse
from small_systems import small_problem, small_system

import contwalk as cw
from contwalk.branch import SpecialPoint
from contwalk.problems.orbit.discretization import Discretization
from contwalk.system import Symmetry

Found = list[SpecialPoint]


def pendulum(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -0.1 * x[1] - (1.0 + 4.0 * p.a * np.cos(2.0 * t)) * np.sin(x[0])


def mirrored(t, x, p, image):
    image[0], image[1] = -x[0], -x[1]


def closed_up_to_a_symmetry(given: Discretization) -> Found:
    """A pendulum whose pivot shakes: a forced period doubling, onto orbits that are their own images, and the
    point at which they lose that."""
    mirror = Symmetry("mirror", "spatial", mirrored)
    system = small_system(
        pendulum, ("theta", "v"), {"a": 0.02}, period=lambda p: math.pi, symmetries=(mirror,)
    )
    problem = cw.PeriodicOrbit(system, system.defaults(), "a", discretization=given)
    hanging = cw.continue_branch(problem, [0.0, 0.0], (0.02, 0.1))
    doubled = cw.switch_branch(problem, hanging, "PD1", (0.02, 0.4))
    assert doubled.info.closure == "mirror"
    return [*hanging.special_points, *doubled.special_points]


def doubled(given: Discretization) -> Found:
    """An autonomous period doubling, and the doubled orbits."""
    system = moebius(-1.0)
    problem = cw.PeriodicOrbit(system, system.defaults(), "lam", discretization=given)
    single = cw.continue_branch(problem, [1.0, 0.0, 0.0, 0.0], (0.7, 1.1), period=math.pi)
    return [
        *single.special_points,
        *cw.switch_branch(problem, single, "PD1", (0.9, 1.05)).special_points,
    ]


def on_a_torus(given: Discretization) -> Found:
    """A Neimark-Sacker point."""
    system = torus(1.05, -1.0, 3.0, 0.5)
    problem = cw.PeriodicOrbit(system, system.defaults(), "lam", discretization=given)
    start, period = [1.0, 0.0, 0.0, 0.0], 2.0 * math.pi / 1.5
    return list(cw.continue_branch(problem, start, (0.7, 1.2), period=period).special_points)


def crossed(given: Discretization) -> Found:
    """A pitchfork of cycles at a state that is zero, and the branch that leaves."""
    system = transverse(lambda p, z: (p.lam - 1.0) * z - z * z * z, lam=0.8)
    problem = cw.PeriodicOrbit(system, system.defaults(), "lam", discretization=given)
    branch = cw.continue_branch(problem, [1.0, 0.0, 0.0], (0.8, 1.2), period=math.pi)
    other = cw.switch_branch(problem, branch, "BP1", (0.8, 1.2))
    return [*branch.special_points, *other.special_points]


def morris_lecar(t, x, p, dx):
    v, w = x
    steady = 0.5 * (1.0 + np.tanh((v + 1.2) / 18.0))
    dx[0] = (p.I - 4.4 * steady * (v - 120.0) - 8.0 * w * (v + 84.0) - 2.0 * (v + 60.0)) / 20.0
    dx[1] = 0.04 * np.cosh((v - 2.0) / 60.0) * (0.5 * (1.0 + np.tanh((v - 2.0) / 30.0)) - w)


def born_and_folded(given: Discretization) -> Found:
    """A cycle from a Hopf point, round its fold."""
    system = small_problem(morris_lecar, "vw", {"I": 60.0}, "I").system
    problem = cw.Equilibrium(system, system.defaults(), "I", discretization=given)
    equilibria = cw.continue_branch(problem, [-50.0, 0.03], (60.0, 110.0))
    return list(cw.switch_branch(problem, equilibria, "HB1", (60.0, 95.0)).special_points)


def duffing(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = 1.5 * np.cos(p.omega * t) - 0.2 * x[1] - x[0] - x[0] ** 3


def resonant(given: Discretization) -> Found:
    """Folds of forced motions whose force's period is the parameter."""
    system = small_system(duffing, "xv", {"omega": 1.0}, period=lambda p: 2.0 * math.pi / p.omega)
    problem = cw.PeriodicOrbit(system, system.defaults(), "omega", discretization=given)
    return list(cw.continue_branch(problem, [1.0, 0.3], (1.0, 3.5)).special_points)


def with_an_impact(given: Discretization) -> Found:
    """A machine with an event: a grazing, the motions with an impact that leave there, and their fold."""
    p = parameters(1.3, 0.1, 0.8)
    low, high = 0.9 * stiffness(p), 1.1 * stiffness(p)
    p.force = low
    begun = forced(p, 0.0)
    branches = diagram(
        OSCILLATOR, "force", (low, high), begun, vars(p), events={"GR": "switch"}, scheme=given.scheme
    )
    return [point for branch in branches for point in branch.special_points]


KINDS: dict[str, Callable[[Discretization], Found]] = {
    "closed up to a symmetry": closed_up_to_a_symmetry,
    "doubled": doubled,
    "torus": on_a_torus,
    "crossed": crossed,
    "born and folded": born_and_folded,
    "resonant": resonant,
    "with an impact": with_an_impact,
}


@pytest.mark.drawn(1)
@pytest.mark.parametrize("kind", KINDS)
def test_both_find_the_same_points(kind):
    shot, collocated = (KINDS[kind](Discretization(scheme=scheme)) for scheme in ("shooting", "collocation"))
    assert [p.label for p in shot] == [p.label for p in collocated]
    assert any(p.label not in ("EP", "UZ") for p in shot)
    for a, b in zip(shot, collocated, strict=True):
        assert (a.status, a.kind, a.criticality) == (b.status, b.kind, b.criticality)
        assert (a.unstable_before, a.unstable_after) == (b.unstable_before, b.unstable_after)
        if a.label == "EP":
            continue
        assert a.error is not None
        assert b.error is not None
        here, there = a.unknowns[-1], b.unknowns[-1]
        assert abs(here - there) <= a.error + b.error + 4e-16 * abs(here)
        assert max(a.error, b.error) <= 1e-8 * abs(here)
        assert a.period == pytest.approx(b.period, rel=1e-6)
        for coefficient in ("c", "d"):
            if coefficient in a.coefficients:
                known = a.coefficients[f"{coefficient}_error"] + b.coefficients[f"{coefficient}_error"]
                assert abs(a.coefficients[coefficient] - b.coefficients[coefficient]) <= known


def test_legs_of_machines_are_solved_by_collocation_where_it_is_asked_for():
    p = parameters(1.3, 0.1, 0.8, force=0.3)
    problem, _ = solution(OSCILLATOR, "force", forced(p, 0.0), vars(p), scheme="collocation")
    assert problem.mesh.method.startswith("gauss")
    assert "collocation at Gauss points" in problem.mesh.reason

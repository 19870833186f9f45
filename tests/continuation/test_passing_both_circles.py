"""Multipliers that go from beyond 1 to beyond -1 within a step: both special points are told."""

import math

import numpy as np
import pytest
from hybrid_runs import branch_of
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import mathieu_a, mathieu_b

import contwalk as cw
from contwalk.problems.orbit.multipliers import Multipliers
from contwalk.system import Mode, Parameter, Start, State, System, Transition

DEPTH = 16.0


def hill(t, x, p, dx):
    """Mathieu's equation: between its tongues lie bands, here of 1e-4 and less."""
    dx[0] = x[1]
    dx[1] = -2.0 * p.c * x[1] - (p.a - 2.0 * DEPTH * math.cos(2.0 * t)) * x[0] - x[0] ** 3


SYSTEM = System(
    name="hill",
    states=(State("x", scale=1.0), State("v", scale=1.0)),
    parameters=(Parameter("a", -25.0), Parameter("c", 0.01)),
    modes=(Mode("smooth", hill),),
    period=lambda p: math.pi,
    starts=(Start("rest", lambda p: [[0.0, 0.0]]),),
    reference="N. W. McLachlan, Theory and Application of Mathieu Functions, 1947",
)


def trace(a: float, c: float) -> float:
    """Of the map over a period, by SciPy."""

    def linear(t, y):
        k = -(a - 2.0 * DEPTH * math.cos(2.0 * t))
        return [y[1], k * y[0] - 2.0 * c * y[1], y[3], k * y[2] - 2.0 * c * y[3]]

    begin, rounding = [1.0, 0.0, 0.0, 1.0], {"rtol": 1e-12, "atol": 1e-12}
    end = solve_ivp(linear, (0.0, math.pi), begin, method="DOP853", **rounding).y[:, -1]
    return float(end[0] + end[3])


def band(c: float) -> dict[str, float]:
    """The points at which a multiplier is 1 and -1, between the first two tongues."""
    low, high = float(mathieu_a(0, DEPTH)), float(mathieu_b(1, DEPTH))
    square = math.exp(-2.0 * math.pi * c)  # of the two multipliers
    return {
        label: brentq(lambda a, at=at: trace(a, c) - at * (1.0 + square), low - 1e-3, high + 1e-3, xtol=1e-13)
        for label, at in (("BP", 1.0), ("PD", -1.0))
    }


@pytest.mark.drawn(1)
@pytest.mark.parametrize("c", [0.01, -0.01])
def test_a_band_between_two_tongues_is_not_stepped_over(c):
    """From 1.7e5 to -3.5e4 within a step: the doubling behind the branch point was lost without a word."""
    known = band(c)
    problem = cw.PeriodicOrbit(SYSTEM, {**SYSTEM.defaults(), "c": c}, "a")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-25.0, -23.0))
    found = [point for point in branch.special_points if point.label != "EP"]
    assert [(point.label, point.status) for point in found] == [("BP", "located"), ("PD", "located")]
    for point in found:
        # SciPy's trace is right to 1e-9 of its slope, 2e6.
        assert abs(point.parameters["a"] - known[point.label]) <= point.error + 1e-12
    through, inside = (1, 0) if c > 0.0 else (1, 2)
    assert [(p.unstable_before, p.unstable_after) for p in found] == [(through, inside), (inside, through)]


def test_nor_along_orbits_with_events():
    """A clock's tick changes nothing: the points are those of the same orbit without it."""
    tick = Transition("tick", "smooth", "smooth", lambda t, x, p: math.sin(2.0 * t), "rising")
    system = System(
        name="ticking",
        states=SYSTEM.states,
        parameters=SYSTEM.parameters,
        modes=SYSTEM.modes,
        transitions=(tick,),
        period=SYSTEM.period,
    )
    branch = branch_of(system, "a", (-25.0, -23.0), [0.0, 0.0], event="tick", accuracy=1e-8)
    found = [point for point in branch.special_points if point.label != "EP"]
    assert [(point.label, point.status) for point in found] == [("BP", "located"), ("PD", "located")]
    for point, value in zip(found, band(0.01).values(), strict=True):
        assert abs(point.parameters["a"] - value) <= point.error + 1e-12


def test_a_small_multiplier_is_known_better_than_a_large_one():
    """Where the parameter stands still the family's own is 1 to its own error, not to that of 1e32."""
    values, errors = np.array([1e32, 0.65], dtype=complex), np.array([1e20, 1e-11])
    found = Multipliers(values, errors, 1e30, accuracies=np.array([1e30, 1e-3])).standing(0.0)
    assert (found.errors[1], found.unstable(2)) == (1e-11, 1)
    nearly = values + np.array([0.0, 0.3505])
    own = Multipliers(nearly, errors, 1e30, accuracies=np.array([1e30, 1e-3])).standing(0.0)
    assert (own.errors[1], own.unstable(2)) == (1e-3, 2)  # it counts as beside

"""Where the coefficient that tells the kind of branch points vanishes, a curve of folds touches theirs."""

from __future__ import annotations

import math

import numpy as np
import pytest
from small_systems import small_problem

import contwalk as cw
from contwalk.branch import Branch, SpecialPoint
from contwalk.problems.locus.curves import HOPF_POINTS
from contwalk.problems.locus.equilibrium_locus import EquilibriumLocus, plane_of

# Of second differences of a coefficient of order one nothing is lost: rounding and what q and p are known to.
COEFFICIENT = 1e-11


def pitchforks(t, x, p, dx):
    """Pitchforks where m = 0; folds where m = -a^2 / 4, x^2 = a / 2."""
    dx[0] = x[0] * (p.m + p.a * x[0] ** 2 - x[0] ** 4)


def chemostat(t, x, p, dx):
    """Growth S / (K + S + S^2 / I) is fastest at S = sqrt(K I): folds where D is that, whatever the feed.

    Without biomass S is the feed, and branch points are where D is the rate at the feed.
    """
    rate = x[0] / (0.5 + x[0] + x[0] ** 2)
    dx[0] = p.D * (p.feed - x[0]) - rate * x[1]
    dx[1] = (rate - p.D) * x[1]


def brusselators(t, x, p, dx):
    """Two Brusselators, coupled."""
    dx[0] = 2.0 - (p.B + 1.0) * x[0] + x[0] ** 2 * x[1] + 0.3 * (x[2] - x[0])
    dx[1] = p.B * x[0] - x[0] ** 2 * x[1] + p.D2 * (x[3] - x[1])
    dx[2] = 2.0 - (p.B + 1.0) * x[2] + x[2] ** 2 * x[3] + 0.3 * (x[0] - x[2])
    dx[3] = p.B * x[2] - x[2] ** 2 * x[3] + p.D2 * (x[1] - x[3])


def points(curve: Branch, *without: str) -> list[SpecialPoint]:
    return [p for p in curve.special_points if p.label not in ("EP", *without)]


def assert_at(point: SpecialPoint, **truth: float) -> None:
    assert (point.label, point.kind, point.status) == ("CP", "branch point", "located")
    for name, value in truth.items():
        assert abs(point.parameters[name] - value) <= max(point.errors[name], np.spacing(value))


def test_pitchforks_tell_where_they_change_between_super_and_subcritical() -> None:
    problem = small_problem(pitchforks, ["x"], {"m": -0.5, "a": 0.8}, "m")
    branch = cw.continue_branch(problem, [0.0], range=(-1.0, 1.0))
    found = cw.continue_locus(problem.system, branch, "BP1", {"m": (-1.0, 1.0), "a": (-0.9, 1.1)})
    (point,) = points(found)
    assert_at(point, m=0.0, a=0.0)
    assert point.coefficients["e"] == pytest.approx(-1.0, abs=COEFFICIENT)
    assert "super- and subcritical" in point.note


@pytest.mark.long
def test_folds_of_pitchforks_end_where_these_change() -> None:
    """A branch point that is not located was told there, and steps of 1e-50 led to it."""
    problem = small_problem(pitchforks, ["x"], {"m": 0.5, "a": 0.8}, "m")
    branch = cw.continue_branch(problem, [1.05], range=(-1.0, 1.0))
    found = cw.continue_locus(problem.system, branch, "LP1", {"m": (-1.0, 1.0), "a": (-0.9, 1.1)})
    assert found.outcome.status == "complete"
    (point,) = points(found)
    assert_at(point, m=0.0, a=0.0)
    assert np.max(np.abs(found["m"] + found["a"] ** 2 / 4.0)) < 1e-14


@pytest.mark.slow
def test_folds_of_coupled_brusselators_come_to_their_pitchforks() -> None:
    """They ended as `step_too_small` beside the point, in 22 steps of rounding.

    e by Lyapunov and Schmidt: with both D2 = 1 and the distance y along the critical vector held, the
    eigenvalue of what both alike do is -e y^4; -0.013279293 at y = 0.025 and -0.013281192 at 0.05 (mpmath,
    40 digits), which extrapolate to -0.01327866.
    """
    problem = small_problem(brusselators, ["x", "y", "u", "v"], {"B": 11.0, "D2": 0.35}, "B")
    balanced = cw.continue_branch(problem, [2.0, 5.5, 2.0, 5.5], range=(10.0, 12.0))
    beside = cw.switch_branch(problem, balanced, "BP1", range=(2.0, 12.0))
    ranges = {"B": (2.0, 12.0), "D2": (0.05, 10.0)}
    folds = cw.continue_locus(problem.system, beside, "LP1", ranges)
    assert folds.outcome.status == "complete"
    assert "pitchforks near B = 4.8, D2 = 1" in folds.outcome.message
    pitchforks = cw.continue_locus(problem.system, balanced, "BP1", ranges)
    for curve in (folds, pitchforks):
        (point,) = [p for p in points(curve) if p.label == "CP"]
        assert_at(point, B=4.8, D2=1.0)
        assert point.coefficients["e"] == pytest.approx(-0.01327866, abs=1e-8)


@pytest.mark.long
def test_folds_at_one_value_of_the_first_parameter_pass_branch_points() -> None:
    """The parameter's share of the tangent is rounding: biomass was told to be of the size 1e16 by it, and
    what was left of it was taken for dust: the walk went over to the branch points.
    """
    problem = small_problem(chemostat, ["S", "X"], {"D": 0.3, "feed": 3.0}, "D")
    washed_out = cw.continue_branch(problem, [3.0, 0.0], range=(0.01, 1.0))
    alive = cw.switch_branch(problem, washed_out, "BP1", range=(0.01, 1.0))
    ranges = {"D": (0.01, 1.0), "feed": (0.1, 5.0)}
    best = math.sqrt(0.5)
    fastest = best / (0.5 + best + 0.5)
    folds = cw.continue_locus(problem.system, alive, "LP1", ranges)
    assert (folds.outcome.reason, folds["feed"].min(), folds["feed"].max()) == ("bound", 0.1, 5.0)
    assert np.max(np.abs(folds["D"] - fastest)) < 1e-15
    assert folds.gaps() == []  # figures drew two dashes of it, and charts no region beside it
    for curve in (folds, cw.continue_locus(problem.system, washed_out, "BP1", ranges)):
        (point,) = points(curve)
        assert_at(point, D=fastest, feed=best)
        # Along q = (1, -1) / sqrt(2) y' = y (rate - D): c is a quarter of the second derivative of the rate.
        assert point.coefficients["c"] == pytest.approx(-0.5 * best / (1.0 + best) ** 2, abs=COEFFICIENT)


def test_magnitudes_are_told_wherever_newtons_method_leads() -> None:
    """F_u is 1e200 there, and its square was asked for: an OverflowError ended the study."""
    problem = small_problem(brusselators, ["x", "y", "u", "v"], {"B": 4.5, "D2": 0.35}, "B")
    plane = plane_of(problem.system, problem.system.defaults(), ("B", "D2"))
    curve = EquilibriumLocus(plane, HOPF_POINTS, np.array([2.0, 2.5, 2.0, 2.5, 4.0, 0.35, 5.0]))
    with np.errstate(over="ignore", invalid="ignore"):
        there = curve.linearize(np.array([1e100, 1e100, 2.0, 2.5, 4.0, 0.35, 5.0]))
        assert np.isfinite(there.magnitudes[4])

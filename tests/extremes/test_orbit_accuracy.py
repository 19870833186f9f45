"""What `accuracy` promises of special points of orbits: 1e-14, 0.1 and what lies between."""

import math
import re
from functools import cache

import mpmath
import numpy as np
import pytest
from small_orbits import moebius_branch, orbits, stuart_landau
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.branch import Branch, SpecialPoint

pytestmark = pytest.mark.slow

ACCURACIES = (1e-4, 1e-6, 1e-8, 1e-10)
PARAMETER_ROUNDING = 4.0 * np.finfo(float).eps


# -- two period doublings beside each other ------------------------------------------------------------------


@pytest.mark.drawn(1)
@pytest.mark.parametrize("accuracy", [1e-8, 1e-12])
@pytest.mark.parametrize("apart", [1e-2, 1e-4, 1e-6])
def test_two_period_doublings_within_one_step(apart, accuracy):
    """|mu| dips below 1 by pi apart^2 / 2 between them: where they are nearest that is rounding, 2e-12."""
    branch = moebius_branch(apart, accuracy)
    assert branch.outcome.reason == "bound"
    first, *rest = labelled(branch, "LP", "BP", "PD", "NS")
    if apart == 1e-6 and first.status == "unlocated":
        low, high = (float(end) for end in re.findall(r"between (\S+) and (\S+)\.$", first.note)[0])
        assert (first.label, rest) == ("PD", [])
        assert low < 0.3 - 0.5 * apart < 0.3 + 0.5 * apart < high < low + 1e-4
        return
    (second,) = rest
    assert (first.label, second.label) == ("PD", "PD")
    assert [(q.unstable_before, q.unstable_after) for q in (first, second)] == [(1, 0), (0, 1)]
    for point, truth in ((first, 0.3 - 0.5 * apart), (second, 0.3 + 0.5 * apart)):
        assert point.status == "located"
        off = abs(point.parameters["lam"] - truth)
        assert off <= point.error + PARAMETER_ROUNDING
        assert off <= 0.05 * apart, "they are told apart"
        if apart >= 1e-2:  # nearer ones are known to rounding over 2 pi apart
            assert off <= accuracy * 0.3 + PARAMETER_ROUNDING


def test_period_doublings_that_have_just_merged_are_not_reported():
    """g = (lam - 0.3)^2 + 1e-6 never vanishes: 1 - |mu| stays 6e-6 above the walk's tolerance of 1e-6."""

    def field(t, x, p, dx):
        g = (p.lam - 0.3) ** 2 + 1e-6
        square, q = x[0] ** 2 + x[1] ** 2, x[2] ** 2 + x[3] ** 2
        mean, spread = 0.5 * (g - 1.0) - q, 0.5 * (g + 1.0)
        dx[0] = x[0] - x[1] - x[0] * square
        dx[1] = x[0] + x[1] - x[1] * square
        dx[2] = mean * x[2] + spread * (x[0] * x[2] + x[1] * x[3]) - 0.5 * x[3]
        dx[3] = mean * x[3] + spread * (x[1] * x[2] - x[0] * x[3]) + 0.5 * x[2]

    problem = orbits(field, "xyuv", {"lam": -0.5}, "lam")
    branch = cw.continue_branch(problem, [1.0, 0.0, 0.0, 0.0], (-0.5, 1.0), period=6.28)
    assert branch.outcome.reason == "bound"
    assert labelled(branch, "LP", "BP", "PD", "NS") == []
    assert np.all(branch["unstable"] == 1)


# -- 1e-14 and 0.1 -------------------------------------------------------------------------------------------


def test_1e_minus_14_says_what_it_can_give():
    branch = moebius_branch(0.2, 1e-14)
    assert branch.outcome.reason == "bound"
    points = labelled(branch, "PD")
    assert len(points) == 2
    for point, truth in zip(points, (0.2, 0.4), strict=True):
        assert point.status == "located"
        assert abs(point.parameters["lam"] - truth) <= point.error
        # Rounding of some hundred steps over the rate of the multiplier, 4 pi 0.1.
        assert point.error <= 1e-12
        if point.error > 1e-14 * truth:
            assert point.note is not None, "an accuracy that is not reached is said in words"
            assert "accuracy" in point.note


def test_0_1_is_met_and_costs_less():
    branches = {accuracy: moebius_branch(0.2, accuracy) for accuracy in (0.1, 1e-8)}
    for point, truth in zip(labelled(branches[0.1], "PD"), (0.2, 0.4), strict=True):
        assert abs(point.parameters["lam"] - truth) <= 0.1 * truth
        assert point.error <= 0.1 * truth
    assert branches[0.1].cost["rhs"] < branches[1e-8].cost["rhs"]
    assert [q.label for q in branches[0.1].special_points] == [q.label for q in branches[1e-8].special_points]


# -- the promise ---------------------------------------------------------------------------------------------


def _doublings(accuracy: float) -> list[tuple[SpecialPoint, float, float]]:
    """Two period doublings known in closed form."""
    points = labelled(moebius_branch(0.2, accuracy), "PD")
    return [(q, q.parameters["lam"], t) for q, t in zip(points, (0.2, 0.4), strict=True)]


def _folds(accuracy: float) -> list[tuple[SpecialPoint, float, float]]:
    """r' = mu r + r^3 - r^5: the cycles turn at mu = -1/4."""

    def field(t, x, p, dx):
        square = x[0] ** 2 + x[1] ** 2
        rate = p.mu + square - square * square
        dx[0] = rate * x[0] - x[1]
        dx[1] = x[0] + rate * x[1]

    problem = orbits(field, "xy", {"mu": -0.1}, "mu", accuracy)
    radius = math.sqrt(0.5 + math.sqrt(0.15))
    branch = cw.continue_branch(problem, [radius, 0.0], (-0.5, -0.05), direction="backward", period=6.28)
    (fold,) = labelled(branch, "LP")
    return [(fold, fold.parameters["mu"], -0.25)]


def _tori(accuracy: float) -> list[tuple[SpecialPoint, float, float]]:
    """A cycle of period 2 pi and a plane that turns by 1.3 rad a unit of time and grows with mu - 1/3."""

    def field(t, x, p, dx):
        square, q = x[0] ** 2 + x[1] ** 2, x[2] ** 2 + x[3] ** 2
        growth = p.mu - 1.0 / 3.0 + 0.5 * (x[0] - 0.4 * x[0] * x[1])
        dx[0] = x[0] - x[1] - x[0] * square
        dx[1] = x[0] + x[1] - x[1] * square
        dx[2] = (growth - q) * x[2] - 1.3 * x[3]
        dx[3] = 1.3 * x[2] + (growth - q) * x[3]

    problem = orbits(field, "xyuv", {"mu": -0.5}, "mu", accuracy)
    branch = cw.continue_branch(problem, [1.0, 0.0, 0.0, 0.0], (-0.5, 1.0), period=6.28)
    (torus,) = labelled(branch, "NS")
    # Along cos and sin the additional terms have no mean.
    return [(torus, torus.parameters["mu"], 1.0 / 3.0)]


def _branch_points(accuracy: float) -> list[tuple[SpecialPoint, float, float]]:
    """A symmetric cycle that leaves its plane at mu = 1/2."""

    def field(t, x, p, dx):
        square = x[0] ** 2 + x[1] ** 2
        dx[0] = x[0] - x[1] - x[0] * square
        dx[1] = x[0] + x[1] - x[1] * square
        dx[2] = (p.mu - x[0] ** 2) * x[2] - x[2] ** 3

    problem = orbits(field, "xyz", {"mu": 0.0}, "mu", accuracy)
    branch = cw.continue_branch(problem, [1.0, 0.0, 0.0], (0.0, 1.0), period=6.28)
    (point,) = labelled(branch, "BP")
    return [(point, point.parameters["mu"], 0.5)]


def _forced(accuracy: float) -> list[tuple[SpecialPoint, float, float]]:
    """x' = a x - x^3 + ... forced linearly in the other direction: multiplier exp(2 pi (mu - 0.7))."""

    def field(t, x, p, dx):
        dx[0] = -x[0] + math.cos(t)
        dx[1] = (p.mu - 0.7 + x[0]) * x[1] - x[1] ** 3

    problem = orbits(field, "xy", {"mu": 0.0}, "mu", accuracy, period=lambda p: 2.0 * math.pi)
    branch = cw.continue_branch(problem, [0.5, 0.0], (0.0, 1.5))
    (point,) = labelled(branch, "BP")
    return [(point, point.parameters["mu"], 0.7)]


CASES = {"PD": _doublings, "LP": _folds, "NS": _tori, "BP": _branch_points, "forced BP": _forced}


@cache
def _found(case: str, accuracy: float) -> list[tuple[SpecialPoint, float, float]]:
    """Points of a case with the values found and the true ones, computed once."""
    return CASES[case](accuracy)


@pytest.mark.drawn
@pytest.mark.parametrize("accuracy", ACCURACIES)
@pytest.mark.parametrize("case", CASES)
def test_the_accuracy_requested_is_met(case, accuracy):
    for point, value, truth in _found(case, accuracy):
        assert point.status == "located", point.note
        assert abs(value - truth) <= accuracy * abs(truth)
        assert point.error <= accuracy * abs(truth)


@pytest.mark.long
def test_claimed_errors_bound_the_true_ones():
    """The claim is twice the correction on finer steps, an estimate; of these 24 points it holds of all."""
    ratios = []
    for case in CASES:
        for accuracy in ACCURACIES:
            for point, value, truth in _found(case, accuracy):
                # What the parameter's own rounding allows is no error.
                true = max(abs(value - truth) - PARAMETER_ROUNDING * abs(truth), 0.0)
                ratios.append(true / point.error)
    assert len(ratios) == 24
    assert max(ratios) <= 1.0, sorted(ratios)[-4:]


# -- marks ---------------------------------------------------------------------------------------------------


def _marked(accuracy: float) -> Branch:
    """Largest multiplier exp(-4 pi mu) of the cycle; the mark where it is 1/2."""
    problem = orbits(stuart_landau(), "xy", {"mu": 0.5}, "mu", accuracy)
    start = [math.sqrt(0.5), 0.0]
    return cw.continue_branch(problem, start, (0.01, 0.5), period=6.28, marks={"max_abs": [0.5]})


@pytest.mark.drawn(1)
@pytest.mark.parametrize("accuracy", ACCURACIES)
def test_marks_of_an_observable_meet_the_accuracy(accuracy):
    (mark,) = labelled(_marked(accuracy), "UZ")
    with mpmath.workdps(30):
        truth = float(mpmath.log(2) / (4 * mpmath.pi))
    off = abs(mark.parameters["mu"] - truth)
    assert off <= accuracy * truth
    assert off <= mark.error + PARAMETER_ROUNDING * truth


@pytest.mark.drawn(1)
@pytest.mark.parametrize("accuracy", ACCURACIES)
def test_marks_of_an_extremum_claim_no_more_than_they_know(accuracy):
    """The multiplier of the twisted plane is smallest at lam = 0.3."""
    problem = orbits(_dipping, "xyuv", {"lam": -0.5}, "lam", accuracy)
    branch = cw.continue_branch(
        problem, [1.0, 0.0, 0.0, 0.0], (-0.5, 1.0), period=6.28, marks={"max_abs": ["extremum"]}
    )
    (mark,) = labelled(branch, "UZ")
    off = abs(mark.parameters["lam"] - 0.3)
    assert off <= mark.error + PARAMETER_ROUNDING
    assert off <= 10.0 * accuracy * 0.3


def _dipping(t, x, p, dx):
    """The plane grows by (lam - 0.3)^2 + 0.1, and by 0.2 more where x = 1, less where x = -1."""
    g = (p.lam - 0.3) ** 2 + 0.1 + 0.2 * x[0]
    square, q = x[0] ** 2 + x[1] ** 2, x[2] ** 2 + x[3] ** 2
    mean, spread = 0.5 * (g - 1.0) - q, 0.5 * (g + 1.0)
    dx[0] = x[0] - x[1] - x[0] * square
    dx[1] = x[0] + x[1] - x[1] * square
    dx[2] = mean * x[2] + spread * (x[0] * x[2] + x[1] * x[3]) - 0.5 * x[3]
    dx[3] = mean * x[3] + spread * (x[1] * x[2] - x[0] * x[3]) + 0.5 * x[2]


@pytest.mark.drawn(2)
@pytest.mark.parametrize("accuracy", ACCURACIES)
def test_hopf_points_of_the_same_run_exceed_every_request(accuracy):
    system = small_system(stuart_landau(), "xy", {"mu": -0.5})
    chosen = cw.Discretization(accuracy=accuracy)
    problem = cw.Equilibrium(system, system.defaults(), "mu", discretization=chosen)
    branch = cw.continue_branch(problem, [0.0, 0.0], (-1.0, 1.0))
    (hopf,) = labelled(branch, "HB")
    assert abs(hopf.parameters["mu"]) <= 1e-15

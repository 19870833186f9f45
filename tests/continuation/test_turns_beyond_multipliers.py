"""Folds of cycles along which deviations grow beyond 1e100: the parameter's own turns tell them."""

from __future__ import annotations

import math

import pytest
from small_systems import labelled, small_problem

import contwalk as cw

# AUTO-07p with 200 and with 400 intervals (degree 4, tolerances 1e-9) agrees in these folds, in this order.
FOLDS = (-4.2305760798, -4.2303947175)


def mean_field(t, x, p, dx):
    """Quadratic integrate-and-fire neurons that adapt: firing rate, mean voltage, adaptation and its rate."""
    dx[0] = 2.0 / math.pi + 2.0 * x[0] * x[1]
    dx[1] = x[1] ** 2 + p.eta + 15.0 * math.sqrt(2.0) * x[0] - (math.pi * x[0]) ** 2 - x[2]
    dx[2] = x[3] / 10.0
    dx[3] = x[0] - (2.0 * x[3] + x[2]) / 10.0


@pytest.mark.slow
def test_the_parameter_tells_what_multipliers_of_1e100_do_not():
    """A multiplier goes from beyond 1 to beyond -1 within 1e-100: no step shows one between both."""
    problem = small_problem(mean_field, "rvab", {"eta": -4.5}, "eta")
    rest = cw.continue_branch(problem, [0.1, -2.8, 1.0, 0.0], (-5.0, -3.9))
    cycles = cw.switch_branch(problem, rest, "HB1", (-4.2308, -3.9))
    assert cycles.outcome.reason == "bound", cycles.outcome
    folds = labelled(cycles, "LP")
    assert [fold.parameters["eta"] for fold in folds] == pytest.approx(FOLDS, abs=2e-10)
    for fold, eta in zip(folds, FOLDS, strict=True):
        assert fold.status == "located"
        assert abs(fold.parameters["eta"] - eta) <= fold.error + 1e-10
        assert "where the parameter turns" in fold.note
    # Each has the doubling that is not told apart from it, and nothing else is between them.
    assert [point.label for point in cycles.special_points] == ["LP", "PD", "LP", "PD", "EP"]
    assert [point.status for point in labelled(cycles, "PD")] == ["unlocated", "unlocated"]
    assert len(cycles) < 260  # the walk crept to each of them, in steps of 1e-10


def oregonator(t, x, p, dx):
    """Two variables; the field has a pole at x = -q, behind which lies a saddle."""
    q, eps = 8e-4, 1e-2
    dx[0] = (x[0] * (1.0 - x[0]) - p.f * x[1] * (x[0] - q) / (x[0] + q)) / eps
    dx[1] = x[0] - x[1]


@pytest.mark.slow
def test_a_canard_does_not_come_to_a_saddle_behind_a_pole():
    """The parameter stands still along it to 13 digits, as at a homoclinic orbit; it goes on."""
    problem = small_problem(oregonator, "xz", {"f": 0.4}, "f")
    rest = cw.continue_branch(problem, [0.6, 0.6], (0.3, 1.5))
    cycles = cw.switch_branch(problem, rest, "HB1", (0.3, 1.5), max_points=165)
    assert cycles.outcome.reason == "max_points", cycles.outcome
    assert cycles["period"][-1] > 8.7  # where it was told as homoclinic

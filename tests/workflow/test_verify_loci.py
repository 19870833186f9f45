"""Special points of curves in two parameters computed once more, and what is told of neutral saddles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.branch import Branch
from contwalk.verification.finding import AGREES, DISAGREES
from contwalk.verification.points import checked_point

RANGES = {"alpha": (0.01, 0.9), "delta": (0.001, 1.0)}


def bazykin(t, x, p, dx):
    eaten = x[0] * x[1] / (1.0 + p.alpha * x[0])
    dx[0] = x[0] - eaten - 0.01 * x[0] ** 2
    dx[1] = -x[1] + eaten - p.delta * x[1] ** 2


SYSTEM = small_system(bazykin, "xy", {"alpha": 0.3, "delta": 0.2})


@pytest.fixture(scope="module")
def one() -> Branch:
    return cw.continue_branch(
        cw.Equilibrium(SYSTEM, SYSTEM.defaults(), "alpha"), [2.0, 2.0], range=RANGES["alpha"]
    )


def curve(one, point: str, **settings) -> Branch:
    return cw.continue_locus(SYSTEM, one, point, RANGES, **settings)


@pytest.fixture(scope="module")
def curves(one) -> dict[str, Branch]:
    return {point: curve(one, point) for point in ("HB1", "LP1")}


@pytest.mark.parametrize("name", ["HB1", "LP1"])
def test_points_of_curves_are_found_again(curves, name) -> None:
    for point in labelled(curves[name], "BT", "CP", "GH"):
        found = checked_point(SYSTEM, curves[name], point)
        # What is known to less than a rounding of the field's terms cannot be told apart in doubles.
        assert found.verdict == AGREES or "it is recomputed to" in found.reason, found


@pytest.mark.parametrize("name", ["HB1", "LP1"])
@pytest.mark.parametrize("which", ["alpha", "delta"])
def test_an_error_of_either_parameter_is_seen(curves, name, which) -> None:
    branch = curves[name]
    point = labelled(branch, "BT")[0]
    place = -1 - branch.info.free.index(which)
    unknowns = list(point.unknowns)
    unknowns[place] += 1e-9
    parameters = {**point.parameters, which: unknowns[place]}
    moved = replace(point, unknowns=tuple(unknowns), parameters=parameters)
    found = checked_point(SYSTEM, branch, moved)
    assert (found.verdict, found.quantity) == (DISAGREES, which)
    assert found.difference == pytest.approx(1e-9, rel=1e-3)


def test_one_direction_of_a_neutral_saddle_is_unstable(curves) -> None:
    branch = curves["HB1"]
    saddle = branch["frequency_squared"] < 0.0
    assert saddle.any()
    # Two states: both eigenvalues are those of the curve.
    np.testing.assert_array_equal(branch["unstable"], saddle.astype(int))
    np.testing.assert_array_equal(branch["stable"], ~saddle)
    first, second = labelled(branch, "BT")
    assert [(p.unstable_before, p.unstable_after) for p in (first, second)] == [(0, 1), (1, 0)]


def test_curves_stop_before_neutral_saddles_where_that_is_asked_for(one) -> None:
    branch = curve(one, "HB1", neutral_saddles="stop")
    assert np.all(branch["frequency_squared"] > -1e-12)
    assert [p.label for p in branch.special_points][-2:] == ["BT", "EP"]
    assert branch.outcome.reason == "stop_at"
    assert "neutral_saddles=follow" in branch.outcome.message


@pytest.mark.long
def test_parameters_are_marked_along_curves(one) -> None:
    branch = cw.continue_locus(SYSTEM, one, "HB1", RANGES, marks={"delta": [0.15], "alpha": [0.25]})
    found = labelled(branch, "UZ")
    assert [dict(point.mark) for point in found] == [
        {"name": "delta", "value": 0.15},
        {"name": "alpha", "value": 0.25},
        {"name": "delta", "value": 0.15},
    ]
    for point in found:
        assert point.parameters[point.mark["name"]] == point.mark["value"]
        assert all(error <= 1e-15 for error in point.errors.values())
        assert checked_point(SYSTEM, branch, point).verdict == AGREES

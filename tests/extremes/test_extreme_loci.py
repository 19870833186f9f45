"""Curves in two parameters at the ends of what floats hold: tiny isolas, starts beside double points."""

from __future__ import annotations

import math

import numpy as np
import pytest
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.branch import Branch

pytestmark = pytest.mark.slow


def bogdanov_takens(t, x, p, dx):
    """Folds where b1 = b2^2 / 4, Hopf points where b1 = 0 and b2 < 0."""
    dx[0] = x[1]
    dx[1] = p.b1 + p.b2 * x[0] + x[0] ** 2 - x[0] * x[1]


def scaled(t, x, p, dx):
    """The same with parameters of 1e-8 and 1e8."""
    b1, b2 = p.b1 * 1e8, p.b2 * 1e-8
    dx[0] = x[1]
    dx[1] = b1 + b2 * x[0] + x[0] ** 2 - x[0] * x[1]


def hyperbola(t, x, p, dx):
    """Folds where a b = 1."""
    dx[0] = x[0] ** 2 + p.a * p.b - 1.0


def crossing_folds(t, x, p, dx):
    """Folds where a = b and where a = -b."""
    dx[0] = x[0] ** 2 + p.a**2 - p.b**2


def study(field, states, parameters, state, ranges, which, **settings) -> tuple[Branch, Branch]:
    system = small_system(field, states, parameters)
    free = next(iter(ranges))
    branch = cw.continue_branch(cw.Equilibrium(system, parameters, free), state, range=ranges[free])
    return branch, cw.continue_locus(system, branch, which, ranges, **settings)


def start(b1: float, b2: float) -> list[float]:
    """The equilibrium of `bogdanov_takens` on the left of its fold."""
    return [0.5 * (-b2 - math.sqrt(b2**2 - 4.0 * b1)), 0.0]


@pytest.mark.drawn(1)
@pytest.mark.parametrize("radius", [1e-2, 1e-4, 1e-7])
@pytest.mark.parametrize("middle", [(0.0, 0.0), (3.0, 5.0)])
def test_isolas_of_folds_close(radius, middle) -> None:
    a0, b0 = middle
    if radius < 1e-12 * max(middle) * 1e5:
        pytest.skip("beyond what the parameters' digits tell of so small a circle")

    def isola(t, x, p, dx):
        dx[0] = x[0] ** 2 + ((p.a - a0) ** 2 + (p.b - b0) ** 2 - radius**2)

    ranges = {"a": (a0 - 2.0, a0 + 2.0), "b": (b0 - 2.0, b0 + 2.0)}
    _, found = study(isola, "x", {"a": a0, "b": b0}, [radius], ranges, "LP1")
    assert found.outcome.reason == "closed"
    distance = np.hypot(found["a"] - a0, found["b"] - b0)
    np.testing.assert_allclose(distance, radius, rtol=1e-6 if any(middle) else 1e-12)
    assert found["b"].min() < b0 - 0.99 * radius
    assert [p.label for p in found.special_points] == ["EP"]


@pytest.mark.drawn(1)
@pytest.mark.parametrize(("which", "sign"), [("LP1", 1.0), ("HB1", -1.0)])
def test_parameters_of_1e_minus_8_and_1e8(which, sign) -> None:
    parameters = {"b1": -0.4e-8, "b2": 0.7e8 * sign}
    ranges = {"b1": (-1e-8, 1e-8), "b2": (-1.5e8, 1.5e8)}
    _, found = study(scaled, "xy", parameters, start(-0.4, 0.7 * sign), ranges, which)
    (point,) = labelled(found, "BT", "CP", "GH", "ZH")
    assert point.label == "BT"
    assert abs(point.parameters["b1"]) <= point.errors["b1"] < 1e-30
    assert abs(point.parameters["b2"]) <= point.errors["b2"] < 1e-14
    assert found.outcome.reason == "bound"
    folds = found.info.settings["of"] == "LP"
    expected = found["b2"] ** 2 / 4e24 if folds else 0.0 * found["b2"]
    np.testing.assert_allclose(found["b1"], expected, atol=1e-21)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("beside", [1e-3, 1e-5, 1e-6])
@pytest.mark.parametrize(("which", "sign"), [("LP1", 1.0), ("HB1", -1.0)])
def test_curves_through_a_bogdanov_takens_point_beside_their_start(which, sign, beside) -> None:
    parameters = {"b1": -0.4, "b2": beside * sign}
    ranges = {"b1": (-1.0, 1.0), "b2": (-1.5, 1.5)}
    branch, found = study(bogdanov_takens, "xy", parameters, start(-0.4, beside * sign), ranges, which)
    # Where b2 is negative a Hopf point is as near to the fold, and both together change the count by one.
    assert [p.label for p in labelled(branch, "HB", "LP")] == (["LP"] if sign > 0.0 else ["HB", "LP"])
    (point,) = labelled(found, "BT", "CP", "GH", "ZH")
    assert point.label == "BT"
    for name in ("b1", "b2"):
        assert abs(point.parameters[name]) <= point.errors[name] < 1e-30
    assert sorted(found["b2"][[0, -1]]) == pytest.approx([-1.5, 1.5])


@pytest.mark.long
@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-9, 1e-12])
def test_nearly_tangent_curves_are_not_mistaken_for_each_other(gap) -> None:
    def nearly_tangent(t, x, p, dx):
        dx[0] = x[0] ** 2 + p.a - p.b**2
        dx[1] = x[1] ** 2 + p.a - 2.0 * p.b**2 - gap

    ranges = {"a": (-2.0, 2.0), "b": (-1.0, 1.0)}
    state = [-math.sqrt(1.25), -math.sqrt(1.5)]
    _, found = study(nearly_tangent, "xy", {"a": -1.0, "b": 0.5}, state, ranges, "LP1")
    np.testing.assert_allclose(found["a"], found["b"] ** 2, atol=1e-14)
    assert sorted(found["b"][[0, -1]]) == [-1.0, 1.0]
    assert [p.label for p in found.special_points] == ["EP", "EP"]


def test_a_curve_that_runs_off_says_so() -> None:
    ranges = {"a": (0.0, 2.0), "b": (0.0, math.inf)}
    _, found = study(hyperbola, "x", {"a": 0.5, "b": 1.0}, [0.7], ranges, "LP1")
    assert found.outcome.reason == "unbounded"
    assert "runs off as a tends to 0: b is" in found.outcome.message
    np.testing.assert_allclose(found["a"] * found["b"], 1.0, rtol=1e-12)


def test_curves_of_one_kind_that_cross() -> None:
    ranges = {"a": (-2.0, 2.0), "b": (-1.0, 1.0)}
    branch, found = study(crossing_folds, "x", {"a": 0.5, "b": 0.8}, [0.6], ranges, "LP1")
    (point,) = labelled(found, "BP")
    assert point.status == "located"
    for name in ("a", "b"):
        assert abs(point.parameters[name]) <= point.errors[name] < 1e-30
    assert abs(abs(found["a"]) - abs(found["b"])).max() < 1e-14
    assert len(labelled(branch, "LP")) == 2

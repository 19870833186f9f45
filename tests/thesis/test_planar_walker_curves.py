"""The planar walker's curves over slope and foot radius, and over slope and a moment of inertia.

What lies on two curves is found from both, and points at which a foot touches right at a fold, or at a
period doubling, are confirmed by cuts along the slope alone on both sides of them.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from autobalancer_figures import figure_run
from planar_walker_figures import SLOPE

from contwalk.branch import Branch, SpecialPoint

pytestmark = [pytest.mark.thesis, pytest.mark.slow]

FEET, INERTIA = "planar_foot_radius_curves", "planar_inertia_curves"
SECOND = {FEET: "rf", INERTIA: "i2"}
# What a polynomial of fourth order misses between points of a curve, of slopes.
NEAR = 3e-5


def curves(name: str, of: str) -> list[Branch]:
    return [b for b in figure_run(name) if b.info.problem == "locus" and b.info.settings["of"] == of]


def points(name: str, of: str, label: str) -> list[SpecialPoint]:
    return [p for curve in curves(name, of) for p in curve.special_points if p.label == label]


def assert_one_point(one: SpecialPoint, other: SpecialPoint, second: str) -> None:
    """Found from both curves, and the same within what both claim of themselves."""
    for name in ("alpha", second):
        assert one.status == other.status == "located"
        error = one.errors[name] + other.errors[name]
        assert abs(one.parameters[name] - other.parameters[name]) <= error < 1e-9


@cache
def cut(parameter: str, value: float, alpha: float, low: float, high: float) -> Branch:
    """The gait along the slope alone, from a slope at which it is stable."""
    return figure_run(
        "planar_slope",
        f"parameters.{parameter}={value!r}",
        f"parameters.alpha={alpha!r}",
        f"continue.range=[{low!r}, {high!r}]",
        "diagram=none",
    )[0]


@pytest.mark.long
@pytest.mark.parametrize("name", [FEET, INERTIA])
def test_all_kinds_of_curves_are_there(name) -> None:
    of_one_step = [curve for curve in curves(name, "LP") if curve.info.closure == "legs"]
    assert [len(found) for found in (of_one_step, curves(name, "PD"))] == [1, 3]
    touched = {curve.info.settings["limit"]["name"] for curve in curves(name, "GR")}
    assert touched >= {"hind_dip", "front_dip", "heel_strike"}
    conditions = {curve.info.settings["limit"]["name"] for curve in curves(name, "AZ")}
    assert conditions >= {"knee_contact", "knee_friction", "front_knee_impulse", "hind_knee_impulse"}
    for branch in figure_run(name):
        assert branch.outcome.status in ("complete", "stopped"), (branch.name, branch.outcome)
        assert all(p.status == "located" for p in branch.special_points if p.label != "EP")


@pytest.mark.long
def test_folds_of_two_steps_lead_from_one_generalized_doubling_to_the_other() -> None:
    """One of them lies 3e-6 beside the point at which the curve of doublings meets that of folds."""
    found = figure_run(FEET, "diagram.follow=[]", "diagram.depth=3", "loci.of=[LP]", "loci.follow=[LPPD,GPD]")
    _, _, doublings, folds = found
    assert [b.info.settings["of"] for b in found[1:]] == ["LP", "PD", "LP"]
    assert folds.info.closure == "full"
    one, other = (p for p in doublings.special_points if p.label == "GPD")
    assert folds.info.origin in (f"{doublings.name}/{p.name}" for p in (one, other))
    assert folds.outcome.reason == "rejoined"
    ends = folds.points["free"][[0, -1]]
    # It begins a finite amplitude away from the one; the two are 12 % apart in rf.
    for point in (one, other):
        place = [point.parameters["alpha"], point.parameters["rf"]]
        assert np.min(np.abs(ends / place - 1.0).max(axis=1)) < 5e-3


@pytest.mark.long
@pytest.mark.parametrize("name", [FEET, INERTIA])
def test_fold_and_doublings_meet_in_a_point_that_both_curves_have(name) -> None:
    (one,), (other,) = points(name, "LP", "LPPD"), points(name, "PD", "LPPD")
    assert_one_point(one, other, SECOND[name])


@pytest.mark.long
@pytest.mark.parametrize("name", [FEET, INERTIA])
def test_a_foot_that_touches_at_a_doubling_is_found_from_both_curves(name) -> None:
    """Of the gait of one step there are three such points; two confirmed ones are of the hind dip."""
    step = [b for b in curves(name, "GR") if b.info.closure == "legs"]
    found = [p for curve in step for p in curve.special_points if p.label == "GRPD"]
    assert len(found) >= 3
    (doubled,) = [b for b in curves(name, "PD") if b.info.closure == "legs"]
    for point in (p for p in doubled.special_points if p.label == "GRPD"):
        near = min(found, key=lambda p: abs(p.parameters["alpha"] - point.parameters["alpha"]))
        assert_one_point(point, near, SECOND[name])


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.long
def test_cuts_beside_where_the_front_dip_touches_at_the_fold(side) -> None:
    """With lighter thighs the stable gait touches after the fold, with heavier ones the unstable before it.

    Both curves are tangent: the touch is at a larger slope than the fold on either side.
    """
    (one,), (other,) = points(INERTIA, "LP", "GRLP"), points(INERTIA, "GR", "GRLP")
    assert_one_point(one, other, "i2")
    branch = cut("i2", one.parameters["i2"] + side * 1e-3, 0.065, 0.034, 0.066)
    fold = branch.special("LP1")
    (touch,) = [p for p in branch.special_points if p.note and "'front_dip' is touched" in p.note]
    assert (touch.unstable_before, touch.unstable_after) == ((0, 0) if side < 0.0 else (1, 1))
    assert fold.parameters["alpha"] < touch.parameters["alpha"] < fold.parameters["alpha"] + 1e-5
    for of, point in (("LP", fold), ("GR", touch)):
        assert_on_curve(INERTIA, of, (point.parameters["alpha"], point.parameters["i2"]))


@pytest.mark.long
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_cuts_beside_where_the_hind_dip_touches_at_a_doubling(side) -> None:
    (doubled,) = [b for b in curves(FEET, "PD") if b.info.closure == "legs"]
    point = max((p for p in doubled.special_points if p.label == "GRPD"), key=lambda p: p.parameters["rf"])
    branch = cut("rf", point.parameters["rf"] + side * 1e-3, 0.09, 0.085, 0.105)
    doubling = branch.special("PD1")
    (touch,) = [p for p in branch.special_points if p.note and "'hind_dip' is touched" in p.note]
    assert (doubling.parameters["alpha"] < touch.parameters["alpha"]) == (side < 0.0)
    for of, found in (("PD", doubling), ("GR", touch)):
        assert_on_curve(FEET, of, (found.parameters["alpha"], found.parameters["rf"]))


def assert_on_curve(name: str, of: str, place: tuple[float, float], closure: str = "legs") -> None:
    """A place lies on one of the curves, as far as a polynomial through its points tells."""
    (alpha, value), second, off = place, SECOND[name], math.inf
    for curve in (b for b in curves(name, of) if b.info.closure == closure):
        apart = np.abs(curve[second] - value) / np.ptp(curve[second])
        apart += np.abs(curve["alpha"] - alpha) / np.ptp(curve["alpha"])
        first = max(int(np.argmin(apart)) - 3, 0)
        x, y = curve[second][first : first + 7] - value, curve["alpha"][first : first + 7]
        own = np.append(True, np.abs(np.diff(x)) > 1e-3 * np.ptp(x))  # special points may lie close together
        x, y = x[own][:5], y[own][:5]
        off = min(off, abs(float(np.polyval(np.polyfit(x / np.ptp(x), y, len(x) - 1), 0.0)) - alpha))
    assert off <= NEAR, (of, off)


@pytest.mark.long
def test_doublings_beside_the_fold_are_subcritical_on_both_of_its_sides() -> None:
    """The cubic coefficient has a pole where the doubling meets the fold, and a zero right beside it."""
    branch = cut("rf", 0.1, 0.065, 0.034, 0.066)
    found = [p for p in branch.special_points if p.label == "PD"]
    assert [p.criticality for p in found] == ["subcritical", "subcritical"]
    (doubled,) = [b for b in curves(FEET, "PD") if b.info.closure == "legs"]
    labels = [p.label for p in doubled.special_points if p.label in ("GPD", "LPPD")]
    assert labels in (["GPD", "LPPD", "GPD"], ["GPD", "LPPD", "GPD"][::-1])


@pytest.mark.long
def test_curves_pass_the_verified_points_of_table_1() -> None:
    doublings = SLOPE["period_doublings"]
    verified = [("LP", "legs", SLOPE["fold"]["alpha"]), ("PD", "legs", doublings["PD1"])]
    verified += [("PD", "full", doublings["PD2"]), ("PD", "full", doublings["PD4"])]
    for of, closure, alpha in verified:
        assert_on_curve(FEET, of, (float(alpha), 0.12), closure)

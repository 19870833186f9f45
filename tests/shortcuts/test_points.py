"""Points of a branch by number, and special points by name."""

from __future__ import annotations

import pytest

import contwalk as cw
from contwalk.errors import ContwalkError, StartError


@pytest.fixture(scope="module")
def branch():
    text = "x' = A - (B + 1)*x + x^2*y; y' = B*x - x^2*y; A = 1; B = 1.5"
    found = cw.diagram(cw.system_from_text(text), "B", (1, 3), diagram="none")
    return found["b1"]


def test_a_point_by_its_number(branch):
    assert branch[0]["B"] == branch["B"][0] == 1.0
    assert branch[-1]["x"] == branch["x"][-1]
    assert repr(branch[0]) == "<b1/0: B = 1, x = 1, y = 1; stable>"
    assert "unstable" in repr(branch[-1])
    assert [point.row for point in branch[2:5]] == [2, 3, 4]
    assert len(list(branch)) == len(branch)
    assert {"B", "x", "y", "stable"} <= set(branch[0].keys())
    with pytest.raises(IndexError):
        branch[len(branch)]
    with pytest.raises(KeyError):
        branch[0]["none"]


def test_a_special_point_by_its_name(branch):
    points = branch.special_points
    assert points["HB1"].parameters["B"] == pytest.approx(2.0)
    assert (points[0].name, points[-1].name, len(points[:2])) == ("EP1", "EP2", 2)
    with pytest.raises(KeyError, match="Known: EP1, HB1, EP2"):
        points["LP1"]


def test_a_branch_draws_itself(branch, tmp_path):
    axes = branch.plot("x", units={"B": "mol"})
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("B (mol)", "x")
    assert branch.plot("y", ax=axes) is axes
    assert cw.save(axes, tmp_path / "x.png").stat().st_size > 1000
    with pytest.raises(ContwalkError, match="z"):
        branch.plot("z")


def test_a_curve_is_drawn_in_both_of_its_parameters():
    folds = cw.diagram(
        cw.system_from_text("x' = a + b*x - x^3; a = -1; b = 1; x(0) = -1.3"),
        "a",
        (-1, 1),
        loci={"with": "b", "range": [-0.5, 1.5]},
    )
    curve = next(branch for branch in folds if branch.info.problem == "locus")
    axes = curve.plot()
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("a", "b")


def test_orbits_with_events_are_asked_for_by_their_events():
    ball = cw.load_system("bouncing_ball")
    bounce = cw.Itinerary((cw.Leg("flight", ball.transition("bounce")),))
    twice = cw.Itinerary(bounce.legs * 2)
    state, values = {"y": 0.0158, "v": -0.7435}, ball.defaults() | {"A": 0.0095}
    given = {"range": (0.009, 0.01), "until": "settled"}
    once = cw.continue_branch(cw.HybridOrbit(ball, bounce, values, "A"), state, **given)
    assert once.info.signature == ("bounce",)
    assert once.plot("impact_phase").get_ylabel().startswith("impact_phase")
    with pytest.raises(StartError, match="meets bounce, and bounce, bounce is asked for"):
        cw.continue_branch(cw.HybridOrbit(ball, twice, values, "A"), state, **given)

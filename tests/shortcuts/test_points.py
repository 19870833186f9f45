"""Points of a branch by number, and special points by name."""

from __future__ import annotations

import pytest

import contwalk as cw


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

"""Curves of marked values are drawn as contours: each with its value, the legend with what has it."""

from __future__ import annotations

import numpy as np
import pytest
from synthetic_branches import branch

from contwalk.plotting import plot_locus
from contwalk.plotting.contours import middle


def contour(name: str, level: float, curve: dict[str, object]):
    a = np.linspace(0.0, 1.0, 21)
    found = branch({"a": a, "b": level + a, "x": a}, free=("a", "b"), name=name, problem="locus")
    found.info.settings.update(of="UZ", curve={"level": level, **curve})
    return found


@pytest.mark.parametrize(
    ("curve", "what"),
    [
        ({"name": "pair"}, "max_re"),
        ({"name": "real"}, "max_re"),
        ({"name": "observable", "observable": "height"}, "height"),
        ({"name": "parameter", "place": -1}, "a"),
        ({"name": "parameter", "place": -2}, "b"),
    ],
)
def test_the_value_stands_beside_a_contour_and_its_name_in_the_legend(curve, what):
    ax = plot_locus([contour("b1", -0.5, curve), contour("b2", 0.25, curve)])
    assert {"-0.5", "0.25"} <= {text.get_text() for text in ax.texts}
    legend = [text.get_text() for text in ax.get_legend().get_texts()]
    assert legend == [f"UZ  {what} at the value beside it"]


def test_the_middle_is_half_way_along_a_line_as_it_is_drawn():
    points = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 1.0], [10.0, 3.0]])
    assert middle(points, np.array([10.0, 1.0])) == pytest.approx([10.0, 1.0])

"""Lines that lie over one another, as those of mirror images: nothing looks stable that is not."""

from __future__ import annotations

import numpy as np
import pytest
from synthetic_branches import branch, fold

from contwalk.branch import SpecialPoint
from contwalk.plotting import plot_bifurcation_diagram
from contwalk.plotting.overlaps import Cover


def lines(ax, start):
    return [line for line in ax.lines if (line.get_gid() or "").startswith(start)]


def length(parts):
    return sum(np.hypot(*np.diff(part, axis=0).T).sum() for part in parts)


def arc(first, last, k=57):
    """A part of the unit circle."""
    angle = np.linspace(first, last, k)
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


@pytest.fixture
def cover():
    return Cover(np.array([-1.0, -1.0]), np.array([1.0, 1.0]))


def test_a_curve_that_is_new_stays_as_it_is(cover):
    (part,) = cover.bare(arc(0.0, 2.0))
    np.testing.assert_array_equal(part, arc(0.0, 2.0))


@pytest.mark.parametrize("way", [1, -1])
def test_the_same_curve_on_other_points_is_covered(cover, way):
    cover.bare(arc(0.0, 2.0))
    # Chords of 82 parts lie 1e-4 from the arc, far less than a cell, 2e-3.
    assert cover.bare(arc(0.0, 2.0, 83)[::way]) == []


def test_only_what_is_new_of_a_curve_is_left(cover):
    cover.bare(arc(0.0, 1.0))
    # Where it ends is known to the samples, 0.25 points or 2e-3, and the cells around them.
    assert length(cover.bare(arc(0.5, 2.0))) == pytest.approx(1.0, abs=0.02)


def test_crossings_and_near_curves_are_not_covered(cover):
    cover.bare(np.array([[-1.0, 0.0], [1.0, 0.0]]))
    across, beside = np.array([[-0.5, -1.0], [0.5, 1.0]]), np.array([[-1.0, 0.02], [1.0, 0.02]])
    for new in (across, beside):
        (part,) = cover.bare(new)
        np.testing.assert_array_equal(part, new)


def test_what_is_not_finite_or_far_away_is_no_obstacle(cover):
    rough = np.array([[0.0, 0.0], [np.nan, 0.0], [0.5, 0.5], [1e250, 1.0], [np.inf, 0.0]])
    (part,) = cover.bare(rough)
    np.testing.assert_array_equal(part, rough)


def there_and_back(unstable):
    """A branch that passes through its mirror image at mu = 0: even quantities come back the same way."""
    x = np.concatenate([np.linspace(-1.0, 0.0, 31), np.linspace(0.0, 1.0, 47)[1:]])
    special = (SpecialPoint("BP", 30.0, unstable_before=unstable[0], unstable_after=unstable[1]),)
    count = np.where(x < 0.0, *unstable)
    return branch({"mu": x**2, "x": x**2 - x**4 / 2}, unstable=count, special=special)


def test_dashes_of_mirror_halves_are_drawn_once():
    ax = plot_bifurcation_diagram([there_and_back((1, 1))])
    halves = [line.get_xydata() for line in lines(ax, "b1-unstable")]
    x = np.linspace(0.0, 1.0, 400)
    once = length([np.stack([x, x - x**2 / 2], axis=1)])
    # Each half was drawn whole; beside the cusp, 8 points of 400, dashes are drawn twice.
    assert length(halves) == pytest.approx(once, rel=0.05)
    assert not lines(ax, "b1-on-stable")


@pytest.mark.parametrize("unstable", [(0, 1), (1, 0)])
def test_of_halves_one_of_which_is_unstable_both_are_seen(unstable):
    ax = plot_bifurcation_diagram([there_and_back(unstable)])
    assert len(lines(ax, "b1-stable")) == 1
    (inlay,) = lines(ax, "b1-on-stable")
    assert inlay.get_linestyle() == "--"
    assert inlay.get_color() == "white"
    stable = lines(ax, "b1-stable")[0]
    assert inlay.get_zorder() > stable.get_zorder()
    assert inlay.get_linewidth() < stable.get_linewidth()
    low, high = np.sort(inlay.get_xdata())[[0, -1]]
    assert low < 0.1  # the cusp
    assert high > 0.95
    assert "both, over one another" in [text.get_text() for text in ax.get_legend().get_texts()]


def test_a_fold_has_no_overlap():
    ax = plot_bifurcation_diagram([fold()])
    assert not lines(ax, "b1-on-stable")
    assert length([line.get_xydata() for line in lines(ax, "b1-unstable")]) > 1.0

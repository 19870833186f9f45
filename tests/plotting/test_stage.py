"""What a plugin draws is noted as it would be drawn on matplotlib's own axes."""

from __future__ import annotations

import numpy as np
import pytest
from machines import machine
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from contwalk.errors import PluginError
from contwalk.plotting.drawn_elements import elements_of
from contwalk.plotting.playback import Playback
from contwalk.plotting.stage import Performer, Stage


def plain(axes):
    axes.plot([0.0, 1.0], [0.0, 2.0], color="red", lw=3.0, zorder=5)
    axes.plot([1.0], [2.0], "o", markersize=7, color="white", markeredgecolor="black")
    axes.fill([0, 1, 1], [0, 0, 1], facecolor="#123456", edgecolor="none", alpha=0.5, zorder=1)
    axes.fill_between([0.0, 1.0], [0.0, 0.0], [-1.0, -2.0], color="#eeeeee", linewidth=0.0, zorder=0)
    axes.text(0.5, 0.5, "a", ha="center", va="top", fontsize=8)
    axes.add_patch(Circle((0.0, 0.0), 0.5, facecolor="green"))


def test_the_stage_notes_what_matplotlib_draws():
    stage, axes = Stage(), Figure().add_subplot()
    before = set(axes.get_children())
    plain(stage)
    plain(axes)
    drawn = [artist for artist in axes.get_children() if artist not in before]
    found, real = stage.elements(), sorted(elements_of(drawn), key=lambda each: each.order)
    assert [each.kind for each in found] == [each.kind for each in real]
    for own, other in zip(found, real, strict=True):
        assert own.text == other.text
        assert {k: v for k, v in own.look.items() if k != "thick"} == {
            k: v for k, v in other.look.items() if k != "thick"
        }
        low, high = own.points.min(axis=0), own.points.max(axis=0)
        # Collections of matplotlib repeat a corner; the outline is the same.
        assert np.allclose([low, high], [other.points.min(axis=0), other.points.max(axis=0)])


def test_a_draw_that_asks_for_more_is_drawn_on_real_axes():
    def draw(axes, t, x, p):
        axes.plot([0.0, 1.0], [0.0, float(x[0])])
        axes.scatter([0.0], [1.0], color="black")
        axes.set_xlim(-1.0, 1.0)
        axes.set_ylim(-1.0, 1.0)

    performer = Performer(Playback(machine(draw), [0.0, 1.0], [[0.0], [1.0]], {}))
    elements, limits = performer.at(0.5)
    assert performer.on_axes
    assert [each.kind for each in elements] == ["line", "line"]
    assert limits.tolist() == [-1.0, 1.0, -1.0, 1.0]


def test_limits_that_are_not_set_are_not_told():
    def draw(axes, t, x, p):
        axes.plot([0.0, 1.0], [0.0, float(x[0])])

    performer = Performer(Playback(machine(draw), [0.0], [[0.5]], {}))
    elements, limits = performer.at(0.0)
    assert limits is None
    assert not performer.on_axes
    assert elements[0].points.tolist() == [[0.0, 0.0], [1.0, 0.5]]


def test_a_draw_that_fails_names_its_line():
    def draw(axes, t, x, p):
        axes.plot([0.0, 1.0], [0.0, 1.0 / 0.0])

    performer = Performer(Playback(machine(draw), [0.0], [[0.5]], {}))
    with pytest.raises(PluginError, match=r"test_stage.*line"):
        performer.at(0.0)

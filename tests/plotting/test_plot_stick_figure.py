"""The machine at instants of a motion."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from machines import CLOCK, EVENTS, HOPPER, STATES, TIMES, TURN_STATES, TURN_TIMES, machine

from contwalk.errors import ContwalkError, PluginError
from contwalk.plotting import new_axes, plot_stick_figure, plot_stick_panels
from contwalk.plotting.playback import Playback
from contwalk.plotting.slanted import APART, spread
from contwalk.system import State


def by_gid(ax, gid):
    return [artist for artist in ax.get_children() if artist.get_gid() == gid]


def places(ax):
    return [line.get_xdata()[0] for line in by_gid(ax, "leg")]


def test_a_motion_is_interpolated_between_its_instants_and_has_both_sides_of_events():
    motion = Playback(HOPPER, TIMES, STATES, {})
    times, states = motion.until(0.55)
    assert (times[-1], states[-1, 0]) == pytest.approx((0.55, 0.55))
    assert len(times) == 7
    times, states = motion.until(1.0)  # after the event
    assert (len(times), states[-1, 0]) == (12, 0.0)
    times, states = motion.until(5.0)
    assert (times[-1], states[-1, 0]) == (2.0, 1.0)
    assert motion.until(-1.0)[1].tolist() == [[0.0]]


def test_a_machine_that_gets_somewhere_goes_on_from_where_it_landed():
    ax = plot_stick_figure(HOPPER, TIMES, STATES, {}, events=EVENTS)
    at = places(ax)
    # Four instants to an arc, both ends included, evenly spaced.
    np.testing.assert_allclose(at, np.linspace(0.0, 2.0, 9))
    low, high = ax.get_xlim()
    assert low < 0.0 < 2.0 < high
    assert ax.get_aspect() == 1.0


def test_instants_of_events_are_strong_and_told_and_the_others_light():
    ax = plot_stick_figure(HOPPER, TIMES, STATES, {}, events=EVENTS)
    strong = [line.get_xdata()[0] for line in by_gid(ax, "leg") if line.get_alpha() in (None, 1.0)]
    np.testing.assert_allclose(strong, [0.0, 1.0, 2.0])
    told = [text.get_text() for text in ax.texts if text.get_gid() != "scenery"]
    assert told == ["landing  0.000 s", "landing  1.000 s", "landing  2.000 s"]
    feet = [foot.get_alpha() for foot in by_gid(ax, "foot")]
    assert max(feet) < 1.0  # areas over one another


def test_scenery_is_there_once_and_its_texts_are_not_cut():
    ax = plot_stick_figure(HOPPER, TIMES, STATES, {}, events=EVENTS)
    assert len(by_gid(ax, "scenery")) == 2  # the line and the text
    frame = ax.get_window_extent()
    for text in by_gid(ax, "scenery")[1:]:
        box = text.get_window_extent()
        assert not text.get_visible() or frame.x0 <= box.x0 <= box.x1 <= frame.x1


def test_the_names_that_the_plugin_gives_are_in_the_legend_once():
    ax = plot_stick_figure(HOPPER, TIMES, STATES, {}, events=EVENTS, title="a walk")
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["leg"]
    assert ax.figure.get_suptitle() == "a walk"
    ax.figure.canvas.draw()
    assert ax.get_legend().get_window_extent().y1 <= ax.bbox.y0


def test_colours_that_matplotlib_chooses_are_the_same_at_each_instant():
    axes = plot_stick_figure(CLOCK, TURN_TIMES, TURN_STATES, {})
    assert len({line.get_color() for line in by_gid(axes, "hand")}) == 1


def test_a_long_way_has_a_long_figure():
    long_times = np.concatenate([TIMES, TIMES + 2.0, TIMES + 4.0])
    long_states = np.concatenate([STATES] * 3)
    events = [(float(k), "landing") for k in range(7)]
    long = plot_stick_figure(HOPPER, long_times, long_states, {}, events=events)
    short = plot_stick_figure(HOPPER, TIMES[:11], STATES[:11], {}, events=EVENTS[:2])
    assert long.figure.get_size_inches()[0] > short.figure.get_size_inches()[0]


def test_a_short_way_fills_its_figure():
    ax = plot_stick_figure(HOPPER, TIMES[:6], STATES[:6], {})
    ax.figure.canvas.draw()
    drawn, whole = ax.get_window_extent(), ax.figure.bbox
    assert drawn.width * drawn.height > 0.5 * whole.width * whole.height


def test_given_axes_keep_their_figure():
    ax = new_axes("machine")
    size = tuple(ax.figure.get_size_inches())
    assert plot_stick_figure(HOPPER, TIMES, STATES, {}, ax, "walk", events=EVENTS) is ax
    assert tuple(ax.figure.get_size_inches()) == size
    assert ax.get_title(loc="left") == "walk"


def test_slanted_texts_keep_apart_and_in_order():
    wanted = np.array([0.0, 1.0, 2.0, 300.0])
    found = spread(wanted)
    assert np.diff(found).min() >= APART * (1.0 - 1e-12)
    assert found[:3].mean() == pytest.approx(wanted[:3].mean())
    assert found[3] == 300.0


def test_texts_of_events_at_one_place_do_not_overlap():
    # Many events nearly at once: the hopper does not get away.
    times = np.repeat(np.linspace(0.0, 0.07, 8), 2)[1:-1]
    states = 1e-3 * np.arange(len(times))[:, None]
    events = [(float(t), "landing") for t in np.unique(times)]
    ax = plot_stick_figure(HOPPER, times, states, {}, events=events)
    ax.figure.canvas.draw()
    told = [text for text in ax.texts if text.get_gid() != "scenery"]
    starts = [text.get_transform().transform(text.get_position()) for text in told]
    scale = ax.figure.dpi / 72.0
    assert min(abs(a[0] - b[0]) for a, b in combinations(starts, 2)) >= 0.99 * APART * scale


def test_a_machine_that_stays_has_panels_on_equal_scales():
    axes = plot_stick_panels(CLOCK, TURN_TIMES, TURN_STATES, {"height": 1.0}, title="a turn")
    assert len(axes) == 8  # the states are not the first ones again, to the plugin's eyes: the end is shown
    assert len({ax.get_xlim() for ax in axes}) == len({ax.get_ylim() for ax in axes}) == 1
    assert [ax.get_title(loc="left") for ax in axes[:3]] == ["0 s", "0.5714 s", "1.143 s"]
    tips = [by_gid(ax, "hand")[0].get_xdata()[1] for ax in axes]
    np.testing.assert_allclose(tips, np.cos(np.linspace(0.0, 2.0 * np.pi, 8)), atol=1e-12)


def test_a_motion_that_comes_back_is_not_shown_twice():
    states = 0.1 * np.sin(TURN_STATES)
    axes = plot_stick_panels(CLOCK, TURN_TIMES, states, {})
    assert [ax.get_title(loc="left") for ax in axes] == [f"{0.5 * k:.4g} s" for k in range(8)]
    # A computed orbit closes but for its error; an angle is where it was after a turn.
    assert len(plot_stick_panels(CLOCK, TURN_TIMES, states + 1e-5 * TURN_STATES, {})) == 8
    angle = replace(CLOCK, states=(State("x", "rad", period=2.0 * np.pi),))
    axes = plot_stick_panels(angle, TURN_TIMES, TURN_STATES, {})
    assert axes[-1].get_title(loc="left") == "3.5 s"


@pytest.mark.parametrize(("width", "height"), [(1.0, 8.0), (8.0, 1.0), (1.0, 1.0), (1.0, 100.0)])
def test_panels_have_the_proportions_of_what_they_show(width, height):
    def draw(axes, t, x, p):
        axes.plot([0.0, width], [0.0, height])
        axes.set(xlim=(0.0, width), ylim=(0.0, height))

    axes = plot_stick_panels(machine(draw), TURN_TIMES, TURN_STATES, {})
    axes[0].figure.canvas.draw()
    figure = axes[0].figure.bbox
    for ax in axes:
        box = ax.get_window_extent()
        assert box.width / box.height == pytest.approx(width / height, rel=0.02)  # whole pixels
    shown = sum(ax.get_window_extent().width * ax.get_window_extent().height for ax in axes)
    # What is between them is titles, numbers, and the least width of a title.
    assert shown > (0.25 if height / width < 50.0 else 0.02) * figure.width * figure.height
    assert figure.width / axes[0].figure.dpi < 12.0


def test_events_are_told_above_panels():
    axes = plot_stick_panels(CLOCK, TURN_TIMES, TURN_STATES, {}, events=[(2.0, "noon")])
    assert "2 s, noon" in [ax.get_title(loc="left") for ax in axes]


def test_what_is_a_marker_is_one_in_the_legend():
    def draw(axes, t, x, p, so_far=None):
        axes.plot([x[0]], [0.0], "o", label="ball")
        axes.set(xlim=(-1.0, 2.0), ylim=(-1.0, 1.0))

    (entry,) = plot_stick_figure(machine(draw), TIMES, STATES, {}).get_legend().get_lines()
    assert (entry.get_marker(), entry.get_linestyle()) == ("o", "None")


def test_a_motion_of_one_instant():
    ax = plot_stick_figure(HOPPER, [0.0], [[0.5]], {})
    assert places(ax) == [0.5]


@pytest.mark.parametrize(
    ("times", "states", "parameters", "words"),
    [
        ([0.0, 1.0], [[0.0]], {}, r"times of shape \(2,\) and states of shape \(1, 1\)"),
        ([], np.zeros((0, 1)), {}, r"times of shape \(0,\)"),
        ([1.0, 0.0], [[0.0], [1.0]], {}, "fall"),
        ([0.0], [[0.0]], {"hight": 1.0}, "Did you mean 'height'"),
    ],
)
def test_what_does_not_fit_is_told(times, states, parameters, words):
    with pytest.raises(ContwalkError, match=words):
        plot_stick_figure(HOPPER, times, states, parameters)


def test_a_system_without_draw_and_one_whose_draw_fails():
    with pytest.raises(ContwalkError, match="declares no draw"):
        plot_stick_figure(machine(None), TIMES, STATES, {})

    def broken(axes, t, x, p, so_far=None):
        raise RuntimeError("no ink")

    with pytest.raises(PluginError, match="no ink"):
        plot_stick_figure(machine(broken), TIMES, STATES, {})


def test_many_events_are_marks_in_rows_and_not_names():
    """A step of two knees and feet, ten times over: 40 names would stand over one another."""
    names = ("foot1_on", "foot2_off", "knee1_locks", "clicks")
    times = np.linspace(0.0, 2.0, 40, endpoint=False)
    events = [(float(time), names[k % 4]) for k, time in enumerate(times)]
    ax = plot_stick_figure(HOPPER, TIMES, STATES, {}, events=events)
    rows = [text.get_text() for text in ax.texts if text.get_gid() == "row"]
    assert rows == ["knee1", "foot2", "foot1", "clicks"]  # the first of the alphabet on top
    marks = {kind: by_gid(ax, f"mark-{kind}")[0] for kind in ("on", "off", "locks", "event")}
    # Each is above where the machine is then, which goes on by one in a second.
    np.testing.assert_allclose(marks["on"].get_xdata(), times[::4], atol=0.02)
    levels = [float(marks[kind].get_ydata()[0]) for kind in ("event", "on", "off", "locks")]
    assert levels == sorted(levels, reverse=True)
    assert not [text for text in ax.texts if text.get_text().startswith("foot1_on")]
    shown = [text.get_text() for text in ax.get_legend().get_texts()]
    assert {"on", "off", "locks", "event", "leg"} == set(shown)

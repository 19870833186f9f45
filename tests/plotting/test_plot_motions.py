"""Figures of motions: phase portraits and time series."""

from __future__ import annotations

import numpy as np
import pytest

from contwalk.errors import ContwalkError
from contwalk.plotting import new_axes, plot_phase_portrait, plot_time_series, plot_time_series_panels

TURN = np.linspace(0.0, 2.0 * np.pi, 50)
CIRCLE = np.stack([np.cos(TURN), np.sin(TURN)], axis=1)
TIMES = np.linspace(0.0, 3.0, 20)
SERIES = np.stack([np.sin(TIMES), np.cos(TIMES), TIMES], axis=1)


def by_gid(ax, gid):
    return [artist for artist in ax.get_children() if artist.get_gid() == gid]


def legend(ax):
    return [text.get_text() for text in ax.get_legend().get_texts()]


def test_stable_orbits_are_solid_unstable_dashed_and_thin():
    ax = plot_phase_portrait(
        [CIRCLE, 2.0 * CIRCLE], ("x", "v"), labels=["inner", "outer"], stable=[True, False], periods=[1, 2]
    )
    (inner,), (outer,) = by_gid(ax, "orbit-0"), by_gid(ax, "orbit-1")
    assert (inner.get_linestyle(), outer.get_linestyle()) == ("-", "--")
    assert inner.get_linewidth() > outer.get_linewidth()
    assert inner.get_color() != outer.get_color()
    np.testing.assert_array_equal(outer.get_xydata(), 2.0 * CIRCLE)
    assert legend(ax) == ["inner, period 1", "outer, period 2"]


def test_an_equilibrium_is_a_dot_and_an_unstable_one_a_ring():
    points = [np.array([[1.0, 2.0]]), np.array([[3.0, 4.0]])]
    ax = plot_phase_portrait(points, ("x", "v"), stable=[True, False], units={"x": "m"})
    (dot,), (ring,) = by_gid(ax, "orbit-0"), by_gid(ax, "orbit-1")
    assert (dot.get_fillstyle(), ring.get_fillstyle()) == ("full", "none")
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x (m)", "v")
    assert ax.get_legend() is None


def test_jumps_are_thin_dotted_connections_in_the_colour_of_the_orbit():
    broken = np.insert(CIRCLE, 25, np.nan, axis=0)
    jumps = [np.array([[CIRCLE[24], CIRCLE[25]], [CIRCLE[-1], CIRCLE[0]]]), np.zeros((0, 2, 2))]
    ax = plot_phase_portrait([broken, 2.0 * CIRCLE], ("x", "v"), jumps=jumps)
    (orbit,), connections = by_gid(ax, "orbit-0"), by_gid(ax, "jump-0")
    assert len(connections) == 2
    assert not by_gid(ax, "jump-1")
    for line in connections:
        assert line.is_dashed()
        assert line.get_linewidth() < orbit.get_linewidth()
        assert line.get_color() == orbit.get_color()
    assert legend(ax) == ["jump at an event"]


def test_orbits_that_are_not_admissible_are_light():
    orbits, names = [CIRCLE, 2.0 * CIRCLE], ("x", "v")
    ax = plot_phase_portrait(orbits, names, admissible=[True, False])
    plain = plot_phase_portrait(orbits, names)
    colors = [[by_gid(each, f"orbit-{k}")[0].get_color() for k in (0, 1)] for each in (ax, plain)]
    assert colors[0][0] == colors[1][0]
    assert colors[0][1] != colors[1][1]
    assert legend(ax) == ["light: not admissible"]
    assert legend(plot_phase_portrait(orbits, names, admissible=[False, False])) == ["all: not admissible"]


def test_long_names_stand_below_the_axes_of_a_taller_figure():
    name = "PD1:  alpha = 0.0982189 rad,  T = 1.459 s"
    ax = plot_phase_portrait([CIRCLE], ("x", "v"), labels=[name])
    ax.figure.canvas.draw()
    assert ax.get_legend().get_window_extent().y1 < ax.bbox.y0
    assert ax.figure.get_size_inches()[1] > new_axes("phase_portrait").figure.get_size_inches()[1]


def test_three_names_make_axes_in_space():
    helix = np.column_stack([CIRCLE, TURN])
    ax = plot_phase_portrait([helix], ("x", "y", "t"), units={"t": "s"}, periods=[0])
    assert ax.name == "3d"
    assert ax.get_zlabel() == "t (s)"
    assert legend(ax) == ["does not close"]
    ax.figure.canvas.draw()


@pytest.mark.parametrize(
    ("orbits", "names", "options", "words"),
    [
        ([], ("x", "v"), {}, "no orbit"),
        ([CIRCLE], ("x",), {}, "two or three axes, not 1"),
        ([CIRCLE], ("x", "v", "w"), {}, r"shape \(50, 2\)"),
        ([CIRCLE[:0]], ("x", "v"), {}, r"shape \(0, 2\)"),
        ([CIRCLE], ("x", "v"), {"labels": ["a", "b"]}, "1 orbits but 2 labels"),
    ],
)
def test_what_does_not_fit_a_portrait_is_told(orbits, names, options, words):
    with pytest.raises(ContwalkError, match=words):
        plot_phase_portrait(orbits, names, **options)


def test_series_have_their_names_and_events_their_lines():
    ax = plot_time_series(
        TIMES, SERIES[:, :2], ("x", "y"), events={"touch": [0.5, 2.5]}, units={"x": "m", "y": "m"}
    )
    (x,) = by_gid(ax, "series-x")
    np.testing.assert_array_equal(x.get_ydata(), SERIES[:, 0])
    assert [line.get_xdata()[0] for line in by_gid(ax, "event-touch")] == [0.5, 2.5]
    assert legend(ax) == ["x", "y", "touch (2)"]
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("time (s)", "x, y (m)")
    assert ax.get_xlim() == (0.0, 3.0)


def test_many_events_are_ticks_that_cover_no_curve():
    at = np.linspace(0.0, 3.0, 100)
    ax = plot_time_series(TIMES, SERIES[:, :1], ("x",), events={"touch": at})
    (ticks,) = by_gid(ax, "event-touch")
    np.testing.assert_array_equal(ticks.get_xdata(), at)
    assert max(ticks.get_ydata()) < 0.05  # of the height of the axes


def test_given_axes_are_drawn_on():
    ax = new_axes("time_series")
    assert plot_time_series(TIMES, SERIES[:, :1], ("x",), ax) is ax
    assert ax.get_legend() is None


def test_each_unit_has_a_panel_and_the_first_names_the_events():
    panels = plot_time_series_panels(
        TIMES, SERIES, ("x", "angle", "y"), units={"x": "m", "angle": "rad", "y": "m"}, events={"hit": [1.0]}
    )
    assert [ax.get_ylabel() for ax in panels] == ["x, y (m)", "angle (rad)"]
    assert [ax.get_xlabel() for ax in panels] == ["", "time (s)"]
    assert legend(panels[0]) == ["x", "y", "hit (1)"]
    assert all(len(by_gid(ax, "event-hit")) == 1 for ax in panels)
    assert panels[0].figure.get_size_inches()[1] > new_axes("time_series").figure.get_size_inches()[1]
    panels[0].figure.canvas.draw()


def test_shapes_that_do_not_fit_are_told():
    with pytest.raises(ContwalkError, match=r"times of shape \(20,\), values of shape \(20, 3\) and 2 names"):
        plot_time_series(TIMES, SERIES, ("x", "y"))

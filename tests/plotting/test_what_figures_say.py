"""What stands on axes and in legends: names, meanings and marks of what is there, and of nothing else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from synthetic_branches import branch, fold, pitchfork

from contwalk.branch import Branch, SpecialPoint
from contwalk.errors import ContwalkError, SystemDefinitionError
from contwalk.plotting import (
    plot_bifurcation_diagram,
    plot_eigenvalues,
    plot_locus,
    plot_multipliers,
    plot_phase_portrait,
    units_of,
)
from contwalk.plotting.quantities import axis_label
from contwalk.special_point import told_what
from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = p.delta - x[0]


def units(**of):
    parameter = Parameter("delta", 1.0, unit="rad", **of)
    return units_of(System("drag", (State("x", latex="x_1"),), (parameter,), (Mode("m", field),)))


@pytest.mark.parametrize(
    ("of", "label"),
    [
        ({}, "delta (rad)"),
        ({"about": "drag"}, "drag delta (rad)"),
        ({"about": "drag", "latex": r"\delta_1"}, r"drag $\delta_1$ (rad)"),
        ({"about": "drag of the ring, in units of the suspension"}, "delta (rad)"),
        ({"about": "price in $ or $"}, r"price in \$ or \$ delta (rad)"),
    ],
)
def test_axes_tell_what_a_plugin_says_of_a_name(of, label):
    assert axis_label("delta", units(**of)) == label
    ax = plot_bifurcation_diagram([branch({"delta": np.arange(3.0), "x": np.arange(3.0)}, free=("delta",))])
    assert ax.get_xlabel() == "delta"  # without units nobody has told


def test_the_place_of_an_orbit_stands_before_the_unit():
    assert axis_label("delta", units(), " at impact") == "delta at impact (rad)"
    assert axis_label("x", units(), " at impact") == "$x_1$ at impact"


def test_a_name_that_no_figure_can_write_is_told():
    with pytest.raises(ContwalkError, match="'delta' is declared as"):
        axis_label("delta", units(latex=r"\frac{1"))
    with pytest.raises(SystemDefinitionError, match="latex"):
        State("x", latex=3)


@pytest.mark.parametrize(
    ("mark", "kind", "words"),
    [
        ({"name": "max_re", "value": None}, "extremum", "marked value (extremum of max_re)"),
        ({"name": "mu", "value": 0.5}, "parameter", "marked value (mu = 0.5)"),
        ({}, None, "marked value"),
    ],
)
def test_a_marked_value_says_of_what(mark, kind, words):
    point = SpecialPoint("UZ", 2.0, kind=kind, mark=mark)
    assert told_what(point) == words
    assert told_what(replace(point, status="unlocated")) == f"{words}, NOT LOCATED"
    ax = plot_bifurcation_diagram([branch({"mu": np.arange(5.0), "x": np.arange(5.0)}, special=(point,))])
    told = "\n".join(text.get_text() for text in ax.get_legend().get_texts())
    assert words.removeprefix("marked value").strip(" ()") in told


def test_a_legend_tells_what_is_within_the_axes():
    def told(**limits):
        legend = plot_bifurcation_diagram(pitchfork(), **limits).get_legend()
        return [text.get_text().split()[0] for text in legend.get_texts()]

    assert {"stable", "unstable", "BP"} <= set(told())
    assert told(xlim=(-0.9, -0.5)) == ["stable"]
    assert told(xlim=(0.3, 0.9), ylim=(-0.1, 0.1)) == ["unstable"]


def test_marks_of_starts_that_are_no_ends_of_a_curve_are_not_in_the_legend():
    """Where a branch goes on in another one is a joint: the first start and the last end are marked."""
    mu = np.linspace(0.0, 1.0, 6)
    first = branch({"mu": mu, "x": mu}, spectrum=np.stack([mu - 2.0 + 0j], axis=1))
    second = branch(
        {"mu": mu + 1.0, "x": mu}, spectrum=np.stack([mu - 1.0 + 0j], axis=1), name="b2", parent=("b1", 5.0)
    )
    texts = [text.get_text() for text in plot_eigenvalues([first, second]).get_legend().get_texts()]
    assert texts == ["start: mu = 0", "end: mu = 2"]


@pytest.mark.parametrize("largest", [0.5, 2.0, 40.0])
def test_the_plane_of_multipliers_is_as_wide_and_as_high_as_what_is_there(largest):
    mu = np.linspace(0.0, 1.0, 5)
    spectrum = np.stack([largest * mu + 0j], axis=1)
    ax = plot_multipliers([branch({"mu": mu, "x": mu}, spectrum=spectrum, problem="periodic_orbit")])
    (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
    shown = min(max(largest, 1.0), 3.0)
    assert left < -1.0 < shown < right < shown + 0.2 * (shown + 1.0)
    assert low == -high
    assert 1.0 < high < 1.5


def test_dashes_of_an_orbit_that_goes_back_on_its_own_way_are_drawn_once():
    way = np.stack([np.linspace(0.0, 1.0, 50), np.linspace(0.0, 1.0, 50) ** 2], axis=1)
    orbit = np.concatenate([way, way[::-1]])
    length = np.hypot(*np.diff(way, axis=0).T).sum()
    for stable, times in ((True, 2.0), (False, 1.0)):
        ax = plot_phase_portrait([orbit], ["x", "y"], stable=[stable])
        drawn = sum(np.hypot(*np.diff(line.get_xydata(), axis=0).T).sum() for line in ax.lines)
        assert drawn == pytest.approx(times * length, rel=0.1)  # but for where it turns


def test_a_part_that_is_looked_at_closely_has_no_corners():
    """x = mu^2 in steps of 0.1, whose chords are 0.0025 off it: a step alone is drawn to 1e-3 of it."""
    mu = np.linspace(-1.0, 1.0, 21)
    made = branch({"mu": mu, "x": mu**2}, s=mu)
    made.points["tangent"] = np.stack([2.0 * mu, np.ones(21)], axis=1)
    ax = plot_bifurcation_diagram([made], xlim=(0.4, 0.5), ylim=(0.16, 0.25))
    (line,) = [line for line in ax.lines if (line.get_gid() or "").startswith("b1-stable")]
    x, y = line.get_xydata().T
    middle = 0.5 * (x[1:] + x[:-1])
    near = (middle > 0.4) & (middle < 0.5)
    assert np.abs(0.5 * (y[1:] + y[:-1]) - middle**2)[near].max() < 1e-3 * 0.09


def curve_of_folds(order) -> list[Branch]:
    """Folds of a - x^2 + b = 0 on the line b = -a, begun from a fold at a = 0 that is met at b = 0."""
    parent = fold()
    point = next(p for p in parent.special_points if p.label == "LP")
    parent = Branch(replace(parent.info, name="b7"), parent.points, parent.special_points, parent.outcome)
    a = parent["mu"][point.index] + np.linspace(-1.0, 1.0, 41)[::order]
    columns = {"mu": a, "b": -(a - parent["mu"][point.index]), "x": 0.0 * a}
    made = branch(
        columns, free=("mu", "b"), name="b8", problem="locus", s=order * (a - a[20]), parent=("b7", point.s)
    )
    info = replace(made.info, settings={"of": "LP", "of_problem": "equilibrium"})
    return [parent, Branch(info, made.points, made.special_points, made.outcome)]


@pytest.mark.parametrize("order", [1, -1])
@pytest.mark.parametrize("axes", [("mu", "b"), ("b", "mu")])
def test_ticks_of_a_curve_point_to_where_something_is_stable(order, axes):
    branches = curve_of_folds(order)
    ax = plot_locus(branches, *axes)
    (ticks,) = [line for line in ax.lines if line.get_gid() == "b8-ticks"]
    (effect,) = ticks.get_path_effects()
    parent = branches[0]
    point = next(p for p in parent.special_points if p.label == "LP")
    way = np.sign(parent["mu"][0] - parent["mu"][point.index])  # solutions are on one side of the fold
    along = np.diff(ticks.get_xydata()[:2], axis=0)[0]
    left = np.array([-along[1], along[0]])
    assert np.sign(effect._angle) == np.sign(left[axes.index("mu")] * way)
    assert any("stable on this side" in text.get_text() for text in ax.get_legend().get_texts())


def test_a_curve_beyond_which_nobody_knows_has_no_ticks():
    alone = plot_locus(curve_of_folds(1)[1:])
    unstable = curve_of_folds(1)
    unstable[1].points["unstable"] = 1
    for ax in (alone, plot_locus(unstable)):
        assert not [line for line in ax.lines if (line.get_gid() or "").endswith("ticks")]
        assert not any("stable" in text.get_text() for text in ax.get_legend().get_texts())

"""Charts of systems whose equilibria are known everywhere."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest
from small_systems import small_system

import contwalk as cw
from contwalk import plotting
from contwalk.branch import Branch
from contwalk.chart import Chart
from contwalk.errors import ContwalkError
from contwalk.studies.charts import chart


def cusp(t, x, p, dx):
    dx[0] = p.b1 + p.b2 * x[0] - x[0] ** 3


def brusselator(t, x, p, dx):
    dx[0] = p.A - (p.B + 1.0) * x[0] + x[0] ** 2 * x[1]
    dx[1] = p.B * x[0] - x[0] ** 2 * x[1]


def pitchfork(t, x, p, dx):
    dx[0] = x[0] * (p.a - p.b - x[0] ** 2)


def spiral_on_a_fold(t, x, p, dx):
    """Folds where m = 0, and on both branches Hopf points where m = 1.2 - b^2."""
    growth = p.m + p.b**2 - 1.2 - x[0] ** 2 - x[1] ** 2
    dx[0] = growth * x[0] - x[1]
    dx[1] = growth * x[1] + x[0]
    dx[2] = p.m - x[2] ** 2


def study(field, states, parameters, state, points, ranges) -> tuple[list[Branch], Chart]:
    system = small_system(field, states, parameters)
    free = next(iter(ranges))
    branch = cw.continue_branch(cw.Equilibrium(system, parameters, free), state, range=ranges[free])
    branches = [branch, *(cw.continue_locus(system, branch, point, ranges) for point in points)]
    return branches, chart(system, branches)


def test_three_equilibria_inside_the_cusp() -> None:
    ranges = {"b1": (-1.5, 1.5), "b2": (-1.0, 2.0)}
    _, found = study(cusp, "x", {"b1": -1.0, "b2": 1.0}, [-1.3], ["LP1"], ranges)
    assert found.names == ("b1", "b2")
    assert not found.notes
    counts = {(27.0 * r.at[0] ** 2 < 4.0 * r.at[1] ** 3 and r.at[1] > 0.0): r.counts for r in found.regions}
    assert counts == {True: (0, 0, 1), False: (0,)}
    for region in found.regions:
        for solution in region.solutions:
            x = solution.state["x"]
            assert abs(region.at[0] + region.at[1] * x - x**3) < 1e-13
            assert solution.unstable == (region.at[1] - 3.0 * x**2 > 0.0)


@pytest.mark.long
def test_a_chart_says_where_solutions_change_and_no_curve_was_followed() -> None:
    """Along m at b = 0 the Hopf points are beyond the range: one number was told of both their sides."""
    ranges = {"m": (-1.0, 1.0), "b": (0.0, 2.0)}
    start = [0.0, 0.0, math.sqrt(0.5)]
    _, found = study(spiral_on_a_fold, "xyz", {"m": 0.5, "b": 0.0}, start, ["LP1"], ranges)
    beyond = next(region for region in found.regions if region.at[0] > 0.0)
    (note,) = found.notes
    assert f"HB at m = {1.2 - beyond.at[1] ** 2:.6g}, b = {beyond.at[1]:.6g}" in note
    assert "LP" not in note


@pytest.mark.long
def test_a_chart_has_the_ranges_that_curves_were_looked_for_in() -> None:
    """The folds end at the cusp, b2 = 0: below it there is one equilibrium, and the chart shows that."""
    ranges = {"b1": (-1.4, 1.3), "b2": (-1.0, 2.0)}
    branches, found = study(cusp, "x", {"b1": -1.0, "b2": 1.0}, [-1.3], ["LP1"], ranges)
    assert (found.low, found.high) == ((-1.4, -1.0), (1.3, 2.0))
    old = [replace(b, info=replace(b.info, settings=without_ranges(b))) for b in branches]
    spanned = chart(small_system(cusp, "x", {"b1": -1.0, "b2": 1.0}), old)
    assert spanned.low[1] == pytest.approx(0.0, abs=1e-2)
    assert {region.counts for region in spanned.regions} == {(0, 0, 1), (0,)}


def without_ranges(branch: Branch) -> dict[str, Any]:
    return {key: value for key, value in branch.info.settings.items() if key != "ranges"}


@pytest.mark.long
def test_both_sides_of_hopf_points() -> None:
    ranges = {"B": (0.5, 4.0), "A": (0.3, 1.6)}
    _, found = study(brusselator, "xy", {"A": 1.0, "B": 1.0}, [1.0, 1.0], ["HB1"], ranges)
    assert {
        region.at[1] > 0.0 and region.at[0] > 1.0 + region.at[1] ** 2: region.counts
        for region in found.regions
    } == {
        True: (2,),
        False: (0,),
    }


def test_branches_that_leave_branch_points_count() -> None:
    ranges = {"a": (-1.0, 1.0), "b": (-0.8, 0.8)}
    (_, pitchforks), found = study(pitchfork, "x", {"a": -0.5, "b": 0.1}, [0.0], ["BP1"], ranges)
    # Rounding of the start's tangent, 1e-16 in x, made an orientation that changed and a point, or crept.
    assert {point.label for point in pitchforks.special_points} == {"EP"}
    assert {region.at[0] > region.at[1]: region.counts for region in found.regions} == {
        True: (0, 0, 1),
        False: (0,),
    }


def test_the_figure_tells_what_is_in_its_regions() -> None:
    ranges = {"b1": (-1.5, 1.5), "b2": (-1.0, 2.0)}
    branches, found = study(cusp, "x", {"b1": -1.0, "b2": 1.0}, [-1.3], ["LP1"], ranges)
    ax = plotting.plot_chart(branches, found)
    texts = {text.get_text() for text in ax.texts}
    assert {"0", "0 0 1", "CP"} <= texts
    assert [text.get_text() for text in ax.get_legend().get_texts()][-1] == "stable"
    assert (ax.get_xlim(), ax.get_ylim()) == (pytest.approx((-1.5, 1.5)), pytest.approx((found.low[1], 2.0)))


def test_a_chart_needs_curves() -> None:
    system = small_system(cusp, "x", {"b1": -1.0, "b2": 1.0})
    branch = cw.continue_branch(cw.Equilibrium(system, system.defaults(), "b1"), [-1.3], range=(-1.5, 1.5))
    with pytest.raises(ContwalkError, match="no curve in two parameters to make a chart of"):
        chart(system, [branch])

"""What orbits are drawn by, and the curves through the points of branches, by their artists."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from synthetic_branches import branch, hopf

from contwalk.branch import Branch, SpecialPoint
from contwalk.plotting import plot_bifurcation_diagram
from contwalk.plotting.smooth_curves import akima

NAMES = ("max:x", "min:x", "max_abs")


def lines(ax, start):
    return [line for line in ax.lines if (line.get_gid() or "").startswith(start)]


def words(ax):
    return sorted(text.get_text() for text in ax.texts)


def cycles(reported: str = "", visits: int = 1, name: str = "b2", at: float | None = None) -> Branch:
    """A family of cycles: x between 1 - r and 1 + r, r = sqrt(mu); reported somewhere between."""
    mu = np.linspace(0.0, 1.0, 11)
    r = np.sqrt(mu)
    later = tuple(f"x@{k}" for k in range(2, visits + 1))
    columns = {"mu": mu, "x": 1.0 + 0.3 * r if at is None else np.full(11, at)}
    columns |= {"max:x": 1.0 + r, "min:x": 1.0 - r, "max_abs": mu}
    columns |= {each: 1.0 + 0.3 * r + k for k, each in enumerate(later, start=1)}
    made = branch(
        columns,
        observables=(*NAMES[:2], *later, NAMES[2]),
        problem="hybrid_orbit" if reported else "periodic_orbit",
        name=name,
        special=(SpecialPoint("PD", 8.0),),
    )
    made.info = replace(made.info, settings={"reported": reported})
    return made


def test_cycles_are_drawn_by_largest_and_least_value():
    made = cycles()
    ax = plot_bifurcation_diagram([made], units={"x": "m"})
    upper, lower = lines(ax, "b2-stable")
    np.testing.assert_array_equal(upper.get_ydata(), made["max:x"])
    np.testing.assert_array_equal(lower.get_ydata(), made["min:x"])
    assert ax.get_ylabel() == "x, largest and least (m)"
    # A marker on each curve, one name for both.
    marks = lines(ax, "b2-PD1")
    assert [mark.get_ydata()[0] for mark in marks] == [made["max:x"][8], made["min:x"][8]]
    assert words(ax) == ["PD1"]


def test_equilibria_beside_them_are_drawn_by_their_value():
    mu = np.linspace(-1.0, 0.0, 5)
    rest = branch({"mu": mu, "x": np.ones(5)})
    ax = plot_bifurcation_diagram([rest, cycles()])
    (line,) = lines(ax, "b1-stable")
    np.testing.assert_array_equal(line.get_ydata(), rest["x"])
    assert len(lines(ax, "b2-stable")) == 2


def test_orbits_with_events_are_drawn_by_all_values_there():
    made = cycles("before impact", visits=4)
    ax = plot_bifurcation_diagram([made], units={"x": "m"})
    drawn = [line.get_ydata() for line in lines(ax, "b2-stable")]
    assert len(drawn) == 4
    for line, name in zip(drawn, ("x", "x@2", "x@3", "x@4"), strict=True):
        np.testing.assert_array_equal(line, made[name])
    assert ax.get_ylabel() == "x before impact (m)"


@pytest.mark.parametrize("others", [(), ("free",)])
def test_where_the_value_at_the_event_tells_nothing_extremes_are_drawn(others):
    """The place of a stop is the same for all orbits; and beside an orbit without events, extremes do."""
    made = cycles("before impact", at=0.25) if not others else cycles("before impact")
    ax = plot_bifurcation_diagram([made, *(cycles(name="b3") for _ in others)])
    assert ax.get_ylabel() == "x, largest and least"
    assert len(lines(ax, "b2-stable")) == 2


def test_where_the_run_says_where_to_look_that_is_drawn():
    made = cycles("at a section")
    ax = plot_bifurcation_diagram([made])
    (line,) = lines(ax, "b2-stable")
    np.testing.assert_array_equal(line.get_ydata(), made["x"])
    assert ax.get_ylabel() == "x at a section"


def test_one_extreme_can_be_asked_for():
    made = cycles()
    ax = plot_bifurcation_diagram([made], x="min:x", y="amp:x", units={"x": "m"})
    (line,) = lines(ax, "b2-stable")
    np.testing.assert_allclose(line.get_ydata(), np.sqrt(made["mu"]), rtol=1e-15)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("min:x (m)", "amp:x (m)")


def test_databases_without_extremes_are_drawn_as_they_are():
    made = cycles()
    old = branch({"mu": made["mu"], "x": made["x"]}, problem="periodic_orbit", name="b2")
    (line,) = lines(plot_bifurcation_diagram([old]), "b2-stable")
    np.testing.assert_array_equal(line.get_ydata(), made["x"])


def test_a_name_that_several_branches_have_tells_the_branch():
    ax = plot_bifurcation_diagram([cycles(name="b2"), cycles(name="b3"), hopf("b1")], y="x")
    assert {"b2/PD1; b3/PD1", "HB1"} <= set(words(ax)) | {w for t in words(ax) for w in t.split(", ")}
    assert "PD1" not in words(ax)


# -- smooth curves -----------------------------------------------------------------------------------------


def parabola(points: int, known: bool = True) -> Branch:
    """mu = -x^2 over x from -1 to 1, its own arclength parameter x, with exact tangents."""
    x = np.linspace(-1.0, 1.0, points)
    made = branch({"mu": -(x**2), "x": x, "swing": x**3}, observables=("swing",), s=x)
    made.points["unknowns"][:, 0] = x
    if known:
        made.points["tangent"] = np.stack([np.ones_like(x), -2.0 * x], axis=1)
    return made


def test_curves_follow_the_stored_tangents():
    """A cubic meets a parabola exactly."""
    made = parabola(4)
    (line,) = lines(plot_bifurcation_diagram([made], y="x"), "b1-stable")
    mu, x = line.get_data()
    assert len(x) > 30
    np.testing.assert_allclose(mu, -(x**2), rtol=0, atol=1e-15)
    assert set(made["x"]) <= set(x.tolist())  # the points themselves are on it


def test_without_tangents_points_are_joined_by_lines():
    (line,) = lines(plot_bifurcation_diagram([parabola(4, known=False)], y="x"), "b1-stable")
    assert len(line.get_xdata()) == 4


def test_a_quantity_without_a_stored_slope_is_smooth_too():
    """x^3 at 9 points: Akima's slopes leave an error of the third order in the step, some 1e-3 here."""
    (line,) = lines(plot_bifurcation_diagram([parabola(9)], y="swing"), "b1-stable")
    mu, swing = line.get_data()
    assert len(mu) > 50
    np.testing.assert_allclose(np.abs(swing), np.abs(mu) ** 1.5, rtol=0, atol=0.01)


def test_a_tangent_that_leads_elsewhere_bends_nothing():
    made = parabola(4)
    made.points["tangent"][1] = [40.0, -90.0]
    (line,) = lines(plot_bifurcation_diagram([made], y="x"), "b1-stable")
    assert line.get_ydata().min() == -1.0
    assert line.get_ydata().max() == 1.0
    assert np.all(np.diff(line.get_ydata()) > 0.0)


def test_beside_a_kink_there_are_no_waves():
    s = np.arange(-4.0, 5.0)
    slopes = akima(s, np.abs(s))
    np.testing.assert_array_equal(slopes[s < 0], -1.0)
    np.testing.assert_array_equal(slopes[s > 0], 1.0)
    assert abs(slopes[4]) <= 1.0
    np.testing.assert_allclose(akima(s, 3.0 * s), 3.0, rtol=1e-15)
    np.testing.assert_array_equal(akima(s[:2], 2.0 * s[:2]), 2.0)


def test_styles_still_change_at_special_points():
    made = parabola(5)
    x = made["x"]
    special = SpecialPoint("LP", 0.0, unstable_before=0, unstable_after=1, name="LP1", index=2)
    made.points["special"][2] = True
    made.points["unstable"] = x > 1e-9
    made.points["stable"] = x <= 1e-9
    made.special_points = [special]
    ax = plot_bifurcation_diagram([made], y="x")
    (stable,), (unstable,) = lines(ax, "b1-stable"), lines(ax, "b1-unstable")
    assert stable.get_ydata()[-1] == unstable.get_ydata()[0] == 0.0
    assert (stable.get_ydata()[0], unstable.get_ydata()[-1]) == (-1.0, 1.0)

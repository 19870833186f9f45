"""The bifurcation diagram, by its artists."""

from __future__ import annotations

from itertools import combinations, pairwise

import numpy as np
import pytest
from synthetic_branches import branch, fold, hopf, pitchfork

from contwalk.branch import LABELS, SpecialPoint
from contwalk.errors import ContwalkError
from contwalk.plotting import new_axes, plot_bifurcation_diagram


def lines(ax, start):
    """Lines whose gid starts so, in the order of drawing."""
    return [line for line in ax.lines if (line.get_gid() or "").startswith(start)]


def words(ax):
    return [text.get_text() for text in ax.texts]


def overlaps(ax):
    """Pairs of texts whose boxes overlap on the drawn figure."""
    ax.figure.canvas.draw()
    boxes = [(text.get_text(), text.get_window_extent()) for text in ax.texts]
    return [(a, b) for (a, one), (b, two) in combinations(boxes, 2) if one.overlaps(two)]


def crowd(count=40):
    """One smooth branch with `count` special points of all labels but EP close together."""
    t = np.linspace(0, 6 * np.pi, 400)
    labels = [label for label in LABELS if label != "EP"]
    special = tuple(SpecialPoint(labels[i % 9], 150.0 + 2 * i) for i in range(count))
    return branch({"mu": 0.2 * t + np.sin(t), "x": np.cos(t) * np.exp(-t / 20)}, special=special)


def test_pitchfork_changes_style_exactly_at_the_branch_point():
    ax = plot_bifurcation_diagram(pitchfork())
    stable, unstable = lines(ax, "b1-stable")[0], lines(ax, "b1-unstable")[0]
    assert (stable.get_linestyle(), unstable.get_linestyle()) == ("-", "--")
    # Row 20 is mu = 0 exactly.
    assert stable.get_xdata()[-1] == unstable.get_xdata()[0] == 0.0
    assert stable.get_xdata()[0] == -1.0
    assert unstable.get_xdata()[-1] == 1.0
    assert [line.get_linestyle() for line in lines(ax, "b2-")[:1]] == ["-"]


@pytest.mark.parametrize("case", [fold, hopf])
def test_every_segment_has_the_style_of_its_regular_end(case):
    made = case()
    ax = plot_bifurcation_diagram([made])
    styles = {}
    for line in (*lines(ax, "b1-stable"), *lines(ax, "b1-unstable")):
        x = line.get_xdata()
        styles |= dict.fromkeys(pairwise(x), line.get_linestyle())
    x = made["mu"]
    for i in range(len(made) - 1):
        end = i + 1 if made["special"][i] else i
        expected = "--" if made["unstable"][end] else "-"
        assert styles[x[i], x[i + 1]] == expected
    assert len(styles) == len(made) - 1


def test_a_change_that_was_not_located_is_drawn_unstable():
    made = branch({"mu": np.arange(4.0), "x": np.arange(4.0)}, unstable=np.array([0, 0, 1, 1]))
    ax = plot_bifurcation_diagram([made])
    np.testing.assert_array_equal(lines(ax, "b1-stable")[0].get_xdata(), [0, 1])
    np.testing.assert_array_equal(lines(ax, "b1-unstable")[0].get_xdata(), [1, 2, 3])


def test_between_two_neighbouring_special_rows_their_records_decide():
    special = (
        SpecialPoint("HB", 1.0, unstable_before=0, unstable_after=2),
        SpecialPoint("HB", 2.0, unstable_before=2, unstable_after=0),
    )
    made = branch({"mu": np.arange(4.0), "x": np.arange(4.0)}, special=special)
    ax = plot_bifurcation_diagram([made])
    np.testing.assert_array_equal(lines(ax, "b1-unstable")[0].get_xdata(), [1, 2])
    assert [list(line.get_xdata()) for line in lines(ax, "b1-stable")] == [[0, 1], [2, 3]]


def test_an_unstable_branch_between_two_end_points_is_unstable():
    ends = (SpecialPoint("EP", 0.0), SpecialPoint("EP", 1.0))
    made = branch({"mu": np.arange(2.0), "x": np.arange(2.0)}, unstable=1, special=ends)
    ax = plot_bifurcation_diagram([made])
    assert lines(ax, "b1-unstable")
    assert not lines(ax, "b1-stable")


def test_inadmissible_parts_are_light_and_thin_on_hatching():
    admissible = np.array([True, True, True, False, False])
    made = branch({"mu": np.arange(5.0), "x": np.arange(5.0)}, admissible=admissible)
    ax = plot_bifurcation_diagram([made])
    (hatching,) = lines(ax, "b1-inadmissible")
    assert hatching.get_linewidth() > 4.0
    np.testing.assert_array_equal(hatching.get_xdata(), [2, 3, 4])
    first, second = lines(ax, "b1-stable")
    assert first.get_color() != second.get_color()
    assert first.get_linewidth() > second.get_linewidth()
    assert hatching.get_zorder() < second.get_zorder()
    assert "not admissible" in [text.get_text() for text in ax.get_legend().get_texts()]
    whole = plot_bifurcation_diagram([branch({"mu": np.arange(5.0), "x": np.arange(5.0)})])
    assert "not admissible" not in [text.get_text() for text in whole.get_legend().get_texts()]


def test_what_is_not_admissible_is_still_stable_or_not():
    made = branch({"mu": np.arange(4.0), "x": np.arange(4.0)}, unstable=1, admissible=False)
    (line,) = lines(plot_bifurcation_diagram([made]), "b1-unstable")
    assert line.get_linestyle() == "--"


def test_many_names_have_a_larger_figure_unless_the_axes_are_given():
    few, many = plot_bifurcation_diagram([crowd(9)]), plot_bifurcation_diagram([crowd(30)])
    assert many.figure.get_size_inches()[1] > few.figure.get_size_inches()[1]
    given = new_axes("bifurcation_diagram")
    plot_bifurcation_diagram([crowd(30)], ax=given)
    assert tuple(given.figure.get_size_inches()) == tuple(few.figure.get_size_inches())


def test_special_points_are_labelled_once_and_end_points_not():
    special = (
        SpecialPoint("EP", 0.0),
        SpecialPoint("HB", 10.0, unstable_after=2),
        SpecialPoint("LP", 20.0, status="unlocated"),
        SpecialPoint("HB", 30.0, unstable_before=2),
        SpecialPoint("EP", 40.0),
    )
    mu = np.linspace(0, 1, 41)
    unstable = np.where((mu > mu[10]) & (mu < mu[30]), 2, 0)
    ax = plot_bifurcation_diagram([branch({"mu": mu, "x": mu**2}, unstable=unstable, special=special)])
    assert sorted(words(ax)) == ["HB1", "HB2", "LP1"]
    (located,), (unlocated,) = lines(ax, "b1-HB1"), lines(ax, "b1-LP1")
    assert located.get_marker() != unlocated.get_marker()
    assert unlocated.get_markerfacecolor() == "white"
    assert located.get_markerfacecolor() != "white"
    assert located.get_xdata()[0] == mu[10]
    legend = [text.get_text() for text in ax.get_legend().get_texts()]
    assert "HB  Hopf point" in legend
    assert "LP  fold" in legend
    assert "hollow: not located" in legend
    assert {"stable", "unstable"} <= set(legend)


@pytest.mark.parametrize("count", [0, 1])
def test_the_row_at_which_a_branch_is_born_decides_nothing(count):
    # Its multiplier is on the unit circle, and rounding decides on which side.
    unstable = np.array([1 - count, count, count])
    columns = {"mu": np.arange(3.0), "x": np.arange(3.0)}
    ax = plot_bifurcation_diagram([branch(columns, unstable=unstable, parent=("b0", 1.0))])
    kind, other = ("unstable", "stable") if count else ("stable", "unstable")
    np.testing.assert_array_equal(lines(ax, f"b1-{kind}")[0].get_xdata(), [0, 1, 2])
    assert not lines(ax, f"b1-{other}")
    # Of a start, which is no bifurcation, the worse end counts.
    ax = plot_bifurcation_diagram([branch(columns, unstable=unstable)])
    np.testing.assert_array_equal(lines(ax, "b1-unstable")[0].get_xdata(), [0, 1, 2] if count else [0, 1])


def test_an_unlocated_point_between_rows_lies_between_them():
    special = (SpecialPoint("BP", 1.5, status="unlocated"),)
    made = branch({"mu": np.array([0.0, 1.0, 3.0]), "x": np.array([0.0, 2.0, 2.0])}, special=special)
    ax = plot_bifurcation_diagram([made])
    (mark,) = lines(ax, "b1-BP1")
    assert (mark.get_xdata()[0], mark.get_ydata()[0]) == (2.0, 2.0)


def test_markers_of_all_labels_differ():
    ax = plot_bifurcation_diagram([crowd(9)])
    marks = [line.get_marker() for line in ax.lines if line.get_linestyle() == "None"]
    assert len(marks) == len(set(marks)) == 9


def test_names_at_one_place_share_a_text():
    # There and back on the same curve, as along a mirror image; rows 10 and 30 are one point of the plane.
    mu = np.concatenate([np.linspace(0, 1, 21), np.linspace(1, 0, 21)[1:]])
    special = (SpecialPoint("UZ", 10.0), SpecialPoint("BP", 20.0), SpecialPoint("UZ", 30.0))
    twice = branch({"mu": mu, "x": mu**2}, special=special)
    ax = plot_bifurcation_diagram([twice])
    assert sorted(words(ax)) == ["BP1", "UZ1, UZ2"]
    assert len(lines(ax, "b1-UZ")) == 2
    # With another branch's name at the same place the text is of no branch's colour.
    other = branch({"mu": mu[:21], "x": mu[:21] ** 2}, special=special[:1], name="b2")
    ax = plot_bifurcation_diagram([twice, other])
    assert sorted(set(words(ax)) - {"b1", "b2"}) == ["BP1", "b1/UZ1, UZ2; b2/UZ1"]
    (shared,) = (text for text in ax.texts if ";" in text.get_text())
    own = {text.get_color() for text in ax.texts if text.get_text() in ("b1", "b2")}
    assert shared.get_color() not in own
    assert overlaps(ax) == []


def test_branches_at_different_parameters_are_told_apart_in_the_legend():
    ax = plot_bifurcation_diagram([hopf("b1", 1.0), hopf("b2", 2.0)], units={"c": "N s/m"})
    legend = [text.get_text() for text in ax.get_legend().get_texts()]
    assert legend[-2:] == ["b1\nc = 1 N s/m", "b2\nc = 2 N s/m"]
    colors = [line.get_color() for line in ax.get_legend().get_lines()[-2:]]
    assert colors == [lines(ax, f"{name}-stable")[0].get_color() for name in ("b1", "b2")]


def test_units_are_written_with_signs():
    ax = plot_bifurcation_diagram([fold()], units={"mu": "sqrt(k/M)", "x": "kg m2/s2 l1"})
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("mu (√(k/M))", "x (kg m²/s² l1)")


def test_forty_crowded_names_appear_once_inside_the_axes_without_overlap():
    ax = plot_bifurcation_diagram([crowd()])
    assert len(words(ax)) == len(set(words(ax))) == 40
    assert overlaps(ax) == []
    for text in ax.texts:
        box = text.get_window_extent()
        assert ax.bbox.x0 <= box.x0 <= box.x1 <= ax.bbox.x1
        assert ax.bbox.y0 <= box.y0 <= box.y1 <= ax.bbox.y1


def nest(count):
    """A branch with so many special points in a place as large as one of their markers."""
    t = np.linspace(0.0, 1.0, 201)
    special = tuple(SpecialPoint("LP", 101.0 + k) for k in range(count))
    x = np.where(t < 0.5, t, 0.5 + 0.05 * (t - 0.5))
    return branch({"mu": x, "x": np.where(t < 0.5, 0.0, 0.02 * np.sin(40.0 * t))}, special=special)


def test_names_without_room_are_left_out_and_told():
    said = []
    ax = plot_bifurcation_diagram([nest(70)], report=said.append)
    assert overlaps(ax) == []
    written = [name for text in words(ax) for name in text.split(" + ")[0].split(", ")]
    assert written[0] == "LP1"  # the first ones stay
    (sentence,) = said
    left_out = sentence.partition(": ")[2].partition(".")[0].replace("b1/", "").split(", ")
    assert sorted([*written, *left_out]) == sorted(f"LP{k + 1}" for k in range(70))
    (entry,) = [t.get_text() for t in ax.get_legend().get_texts() if "left out" in t.get_text()]
    assert entry == f"names left out: {len(left_out)}"
    quiet = []
    plot_bifurcation_diagram([crowd()], report=quiet.append)
    assert quiet == []


def test_of_many_names_at_one_place_some_are_written_and_the_others_counted():
    mu = np.linspace(0.0, 1.0, 2001)
    special = tuple(SpecialPoint("UZ", 1000.0 + k) for k in range(6))
    said = []
    ax = plot_bifurcation_diagram([branch({"mu": mu, "x": mu}, special=special)], report=said.append)
    assert words(ax) == ["UZ1, UZ2, UZ3 + 3"]
    assert "b1/UZ4, b1/UZ5, b1/UZ6" in said[0]


def test_names_of_branches_of_one_colour_at_one_place_tell_whose_they_are():
    mu = np.linspace(0.0, 1.0, 21)
    special = (SpecialPoint("UZ", 10.0), SpecialPoint("LP", 10.0))
    one = branch({"mu": mu, "x": mu}, special=special[:1])
    eighth = branch({"mu": mu, "x": mu}, special=special[1:], name="b8")
    between = [branch({"mu": mu, "x": mu + k}, name=f"b{k}") for k in range(2, 8)]
    ax = plot_bifurcation_diagram([one, *between, eighth])
    assert "b1/UZ1; b8/LP1" in words(ax)


def test_branches_of_one_name_are_told_apart():
    mu = np.linspace(0.0, 1.0, 21)
    special = (SpecialPoint("UZ", 10.0),)
    same = [branch({"mu": mu, "x": k * mu + k}, special=special) for k in range(3)]
    ax = plot_bifurcation_diagram(same)
    assert {"b1", "b2", "b3", "b1/UZ1", "b2/UZ1", "b3/UZ1"} == set(words(ax))
    assert [len(lines(ax, f"b{k}-stable")) for k in (1, 2, 3)] == [1, 1, 1]


def test_many_branches_have_names_and_colours():
    mu = np.linspace(0, 2, 30)
    made = [
        branch(
            {"mu": mu, "x": np.sin(mu * (1 + j / 5))},
            name=f"b{j + 1}",
            special=(SpecialPoint("HB", 12.0 + j, unstable_after=2),),
        )
        for j in range(8)
    ]
    ax = plot_bifurcation_diagram(made)
    assert {f"b{j + 1}" for j in range(8)} <= set(words(ax))
    assert overlaps(ax) == []
    colors = [lines(ax, f"b{j + 1}-stable")[0].get_color() for j in range(7)]
    assert len(set(colors)) == 7
    crowded = [branch({"mu": mu, "x": mu + j}, name=f"b{j}") for j in range(13)]
    assert words(plot_bifurcation_diagram(crowded)) == []


def test_legend_lies_outside_the_axes_and_inside_the_figure():
    ax = plot_bifurcation_diagram([crowd()])
    ax.figure.canvas.draw()
    box = ax.get_legend().get_window_extent()
    assert box.x0 >= ax.bbox.x1
    assert box.x1 <= ax.figure.bbox.x1
    assert box.y0 >= ax.figure.bbox.y0


def test_axis_labels_carry_units_and_defaults_are_the_free_parameter_and_own_observable():
    ax = plot_bifurcation_diagram([hopf()], units={"mu": "N s/m", "amplitude": "m"})
    assert ax.get_xlabel() == "mu (N s/m)"
    assert ax.get_ylabel() == "amplitude (m)"
    assert plot_bifurcation_diagram([fold()], units={"x": "1"}).get_ylabel() == "x"
    assert plot_bifurcation_diagram([fold()], y="period").get_ylabel() == "period"
    assert (
        plot_bifurcation_diagram([fold()], y="period", units={"period": "ms"}).get_ylabel() == "period (ms)"
    )


def test_parameters_are_stated_with_units():
    ax = plot_bifurcation_diagram([fold()], parameters={"omega": 5.0}, units={"omega": "rad/s"})
    assert ax.get_title(loc="left") == "omega = 5 rad/s"


def test_a_fixed_parameter_can_be_an_axis():
    ax = plot_bifurcation_diagram([hopf("b1", 1.0), hopf("b2", 2.0)], x="c", y="mu")
    assert set(lines(ax, "b2-stable")[0].get_xdata()) == {2.0}


@pytest.mark.parametrize("k", [0, 1])
def test_branches_without_a_segment(k):
    ax = plot_bifurcation_diagram([branch({"mu": np.ones(k), "x": np.ones(k)}, unstable=1)])
    assert len(lines(ax, "b1-unstable")) == k
    assert ("no points" in words(ax)) == (k == 0)
    if k:
        assert lines(ax, "b1-unstable")[0].get_fillstyle() == "none"
    ax.figure.canvas.draw()


def test_nan_breaks_the_line_and_loses_no_label_of_finite_points():
    mu = np.linspace(0, 1, 21)
    x = mu**2
    x[[5, 6]] = np.nan
    special = (SpecialPoint("HB", 5.0), SpecialPoint("LP", 10.0))
    ax = plot_bifurcation_diagram([branch({"mu": mu, "x": x}, special=special)])
    assert words(ax) == ["LP1"]
    assert np.isnan(lines(ax, "b1-stable")[0].get_ydata()[5])
    ax.figure.canvas.draw()


def test_labels_of_a_branch_that_leaves_given_limits_far_behind():
    made = branch(
        {"mu": np.arange(3.0), "x": np.array([0.0, 1.0, 1e250])}, special=(SpecialPoint("LP", 1.0),)
    )
    ax = new_axes("bifurcation_diagram")
    ax.set_ylim(0.0, 2.0)
    assert words(plot_bifurcation_diagram([made], ax=ax)) == ["LP1"]
    assert ax.get_ylim() == (0.0, 2.0)


@pytest.mark.parametrize(("level", "limits"), [(0.0, (-1.0, 1.0)), (2.0, (1.8, 2.2))])
def test_rounding_noise_of_a_constant_branch_is_not_magnified(level, limits):
    noise = 1e-16 * np.sin(np.arange(20.0))
    ax = plot_bifurcation_diagram([branch({"mu": np.arange(20.0), "x": level + noise})])
    assert ax.get_ylim() == pytest.approx(limits, rel=1e-9)  # the noise shifts the limits by 1e-16


def test_branches_that_lack_a_name_are_left_out():
    other = branch({"nu": np.arange(3.0), "z": np.arange(3.0)}, free=("nu",), states=("z",), name="b9")
    ax = plot_bifurcation_diagram([fold(), other])
    assert not lines(ax, "b9")
    with pytest.raises(ContwalkError, match="No branch has all of mu, z"):
        plot_bifurcation_diagram([fold(), other], x="mu", y="z")


def test_bad_names_are_answered_with_the_nearest():
    with pytest.raises(ContwalkError, match=r"'amplitud'.*Did you mean 'amplitude'\?"):
        plot_bifurcation_diagram([hopf()], y="amplitud")
    with pytest.raises(ContwalkError, match="No branch has a quantity named 'spectrum'"):
        plot_bifurcation_diagram([hopf()], y="spectrum")
    with pytest.raises(ContwalkError, match="no branches"):
        plot_bifurcation_diagram([])


def test_draws_on_the_axes_it_is_given():
    ax = new_axes("bifurcation_diagram")
    assert plot_bifurcation_diagram([fold()], ax=ax) is ax


def test_does_not_change_the_branch():
    made = hopf()
    before = made.points.copy()
    plot_bifurcation_diagram([made])
    assert before.tobytes() == made.points.tobytes()


def test_what_branches_tell_of_themselves_is_not_what_is_drawn_by_default():
    mu = np.linspace(0.0, 1.0, 11)
    columns = {"mu": mu, "x": mu, "clearance": mu, "split": mu}
    margin = (SpecialPoint("EP", 10.0, margin={"clearance": 0.5}),)
    made = branch(columns, observables=("clearance", "split"), special=margin)
    assert plot_bifurcation_diagram([made]).get_ylabel() == "x"
    own = branch({**columns, "height": mu}, observables=("clearance", "split", "height"), special=margin)
    assert plot_bifurcation_diagram([own]).get_ylabel() == "height"


def going_round():
    """Orbits of a pendulum that goes round: its angle has no largest and no least value."""
    mu = np.linspace(1.0, 2.0, 11)
    nowhere = np.full(11, np.nan)
    return branch(
        {
            "mu": mu,
            "angle": mu,
            "rate": mu,
            "max:angle": nowhere,
            "max:rate": 2.0 * mu,
            "min:angle": nowhere,
            "min:rate": mu,
        },
        states=("angle", "rate"),
        observables=("max:angle", "max:rate", "min:angle", "min:rate"),
        problem="periodic_orbit",
    )


def test_by_default_a_quantity_is_drawn_that_has_values():
    told = []
    ax = plot_bifurcation_diagram([going_round()], report=told.append)
    assert ax.get_ylabel() == "rate, largest and least"
    assert "no points" not in words(ax)
    assert told == []


def test_a_diagram_without_points_says_so():
    told = []
    ax = plot_bifurcation_diagram([going_round()], y="angle", report=told.append)
    assert "no points" in words(ax)
    (sentence,) = told
    assert "no point has finite values of both mu and angle" in sentence
    assert "Draw another quantity" in sentence


def test_more_branches_than_a_legend_names_are_told_of():
    mu = np.linspace(0.0, 1.0, 5)
    many = [
        branch({"mu": mu, "x": k * mu}, name=f"b{k + 1}", parameters={"mu": 0.0, "c": 1.0 * k})
        for k in range(13)
    ]
    said: list[str] = []
    plot_bifurcation_diagram(many, report=said.append)
    assert any("13 branches are drawn" in each and "which of them are at which c" in each for each in said)
    said.clear()
    plot_bifurcation_diagram(many[:12], report=said.append)
    assert not any("branches are drawn" in each for each in said)

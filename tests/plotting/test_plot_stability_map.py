"""The stability map over sweeps with known borders."""

from __future__ import annotations

import numpy as np
import pytest
from synthetic_branches import branch, fold, hopf

from contwalk.branch import SpecialPoint
from contwalk.errors import ContwalkError
from contwalk.plotting import plot_stability_map
from contwalk.plotting.net import triangulate
from contwalk.plotting.sweep import Row, gather


def sweep(levels=(0.0, 1.0, 2.0, 3.0, 4.0), border=lambda c: 1.0 + 0.5 * c, start=lambda c: 0.0):
    """max_re = border(c) - mu over mu in [start, 5], HB on the border."""
    made = []
    for j, c in enumerate(levels):
        mu = np.sort(np.append(np.linspace(start(c), 5.0, 26), border(c)))
        row = float(np.searchsorted(mu, border(c)))
        made.append(
            branch(
                {"mu": mu, "x": mu, "max_re": border(c) - mu},
                observables=("max_re",),
                unstable=2 * (mu < border(c)),
                special=(SpecialPoint("HB", row, unstable_before=2, unstable_after=0),),
                name=f"b{j + 1}",
                parameters={"c": c},
            )
        )
    return made


def border_of(ax):
    (border,) = [artist for artist in ax.get_children() if artist.get_gid() == "border"]
    return np.concatenate([path.vertices for path in border.get_paths()])


def covered(branches, x, y):
    """Whether the unmasked triangles cover these points."""
    net, _ = triangulate(gather(branches, "mu", "c", "max_re"))
    return net.get_trifinder()(x, y) >= 0


def test_border_is_the_line_through_the_hopf_points():
    ax = plot_stability_map(sweep(), "mu", "c", units={"mu": "N s/m", "c": "kg"})
    points = border_of(ax)
    # The field is linear, and so is its interpolation: only rounding is left.
    np.testing.assert_allclose(points[:, 0], 1.0 + 0.5 * points[:, 1], atol=1e-12)
    assert (points[:, 1].min(), points[:, 1].max()) == (0.0, 4.0)
    marks = [line for line in ax.lines if (line.get_gid() or "").endswith("-HB1")]
    assert [(mark.get_xdata()[0], mark.get_ydata()[0]) for mark in marks] == [
        (1.0 + 0.5 * c, c) for c in (0.0, 1.0, 2.0, 3.0, 4.0)
    ]
    assert ax.get_xlabel() == "mu (N s/m)"
    assert ax.get_ylabel() == "c (kg)"
    assert [other.get_ylabel() for other in ax.figure.axes if other is not ax] == ["max_re"]
    legend = [text.get_text() for text in ax.get_legend().get_texts()]
    assert legend == ["unstable", "HB  Hopf point"]


def test_border_is_straight_between_rows_even_if_steep():
    # Between rows the border moves by fifteen times the spacing along a branch.
    points = border_of(plot_stability_map(sweep(levels=(0.0, 1.0), border=lambda c: 1 + 3 * c), "mu", "c"))
    np.testing.assert_allclose(points[:, 0], 1.0 + 3.0 * points[:, 1], atol=1e-12)


def test_stable_is_blue_and_unstable_grey():
    ax = plot_stability_map(sweep(), "mu", "c")
    filled = next(artist for artist in ax.collections if artist.get_gid() is None)
    middle = (filled.levels[:-1] + filled.levels[1:]) / 2
    assert 0.0 in filled.levels
    for value, (red, _, blue, _) in zip(middle, filled.get_facecolor(), strict=True):
        assert (blue > red) == (value < 0)


def test_a_missing_branch_leaves_a_hole():
    levels = (0.0, 1.0, 2.0, 3.0, 6.0, 7.0)
    inside = covered(sweep(levels, border=lambda c: 2.5), np.full(3, 3.3), np.array([2.5, 4.5, 6.5]))
    np.testing.assert_array_equal(inside, [True, False, True])


def test_a_sweep_in_even_ratios_has_no_hole():
    levels = (0.1, 0.2, 0.4, 0.8, 1.6, 3.2)
    assert covered(sweep(levels), np.full(5, 3.3), np.array([0.15, 0.3, 0.6, 1.2, 2.4])).all()


def test_missing_values_along_branches_leave_a_hole():
    branches = sweep()
    for each in branches:
        each.points["observables"][15:19] = np.nan
    x = np.array([branches[2]["mu"][17], branches[2]["mu"][5]])
    np.testing.assert_array_equal(covered(branches, x, np.array([2.5, 2.5])), [False, True])


def test_ranges_that_differ_are_not_bridged():
    branches = sweep(start=lambda c: 0.0 if c < 2 else 0.8)
    np.testing.assert_array_equal(
        covered(branches, np.array([0.2, 0.2, 1.5]), np.array([0.5, 3.5, 3.5])), [True, False, True]
    )


def rows(*each):
    """Rows at 0, 1, ... from (x, value) pairs."""
    return [
        Row(float(i), np.array(x, dtype=float), np.array(v, dtype=float), np.ones(len(x) - 1, dtype=bool))
        for i, (x, v) in enumerate(each)
    ]


def edges(net):
    return {frozenset(map(tuple, np.stack([net.x, net.y], axis=1)[edge])) for edge in net.edges.tolist()}


def test_the_edge_of_the_data_runs_straight_between_the_ends_of_neighbouring_rows():
    # The data end at a fold, x = 1 + c^2: steps would be up to 0.9 wide.
    levels = np.linspace(0.0, 3.0, 7)
    x = [np.linspace(1 + c**2, 12.0, 40) for c in levels]
    net, _ = triangulate(
        [Row(c, each, -each, np.ones(39, dtype=bool)) for c, each in zip(levels, x, strict=True)]
    )
    found = edges(net)
    for i in range(6):
        for end in (0, -1):
            assert frozenset({(x[i][end], levels[i]), (x[i + 1][end], levels[i + 1])}) in found
    a, b = np.array([1.0, 0.0]), np.array([1.25, 0.5])
    middle = (a + b) / 2
    trifinder = net.get_trifinder()
    assert trifinder(middle[0] + 1e-6, middle[1]) >= 0
    assert trifinder(middle[0] - 1e-6, middle[1]) < 0


def test_no_sliver_beside_the_border_is_left_out():
    # The covered area is that between the rows, whatever the border does in between.
    net, _ = triangulate(gather(sweep(border=lambda c: 2.5 + 2.0 * np.sin(2 * c)), "mu", "c", "max_re"))
    corners = np.stack([net.x, net.y], axis=1)[net.triangles]
    (u, v) = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas = (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2
    assert net.mask is None
    # 5 wide, 4 high; sums of some 300 areas leave a few rounding units each.
    assert np.abs(areas).sum() == pytest.approx(20.0, rel=1e-12)


def test_a_border_that_begins_between_two_rows_joins_no_other():
    # The upper row has two zeros more, 5 and 6; the one of both moves from 2 to 3.
    net, value = triangulate(
        rows(([0, 1, 3, 8], [2, 1, -1, -2]), ([0, 2, 4, 4.5, 5.5, 6.5, 8], [2, 1, -1, -1, 1, -1, -2]))
    )
    zeros = {(a, b) for a, b, v in zip(net.x, net.y, value, strict=True) if v == 0.0}
    assert zeros == {(2.0, 0.0), (3.0, 1.0), (5.0, 1.0), (6.0, 1.0)}
    joined = [edge for edge in edges(net) if edge <= zeros and len({y for _, y in edge}) == 2]
    assert frozenset({(2.0, 0.0), (3.0, 1.0)}) in joined
    assert frozenset({(2.0, 0.0), (6.0, 1.0)}) not in joined


def test_kinks_of_neighbouring_rows_are_joined():
    # V-shaped rows whose corner moves; the level lines would zigzag along it otherwise.
    kink = [3.0, 3.4, 3.8]
    x = [np.union1d(np.linspace(0, 8, 17), [k]) for k in kink]
    net, _ = triangulate(rows(*((each, np.abs(each - k) - 9) for each, k in zip(x, kink, strict=True))))
    for i in (0, 1):
        assert frozenset({(kink[i], float(i)), (kink[i + 1], i + 1.0)}) in edges(net)


def test_a_scale_above_the_axis_keeps_off_the_legend():
    small = sweep(levels=(0.0, 1e-5, 2e-5), border=lambda c: 1 + 1e5 * c)
    ax = plot_stability_map(small, "mu", "c")
    ax.figure.canvas.draw()
    offset = ax.yaxis.get_offset_text()
    assert offset.get_text() == "1e\N{MINUS SIGN}5" or offset.get_text() == "1e-5"
    assert not offset.get_window_extent().overlaps(ax.get_legend().get_window_extent())


def test_where_solutions_coexist_the_most_stable_counts():
    t = np.linspace(-1, 1, 41)
    folded = [
        branch(
            {"mu": t**2, "x": t, "max_re": t},
            observables=("max_re",),
            parameters={"c": c},
            unstable=(t > 0).astype(int),
        )
        for c in (0.0, 1.0)
    ]
    for row in gather(folded, "mu", "c", "max_re"):
        # The lower sheet of the fold is x = -sqrt(mu).
        np.testing.assert_allclose(row.value, -np.sqrt(row.x), atol=1e-15)
        assert row.covered.all()


@pytest.mark.parametrize("value", [-1.0, 0.0, 2.0])
def test_a_constant_field_and_one_sign(value):
    branches = [
        branch(
            {"mu": np.arange(4.0), "x": np.arange(4.0), "max_re": np.full(4, value)},
            observables=("max_re",),
            parameters={"c": c},
        )
        for c in (0.0, 1.0)
    ]
    ax = plot_stability_map(branches, "mu", "c")
    ax.figure.canvas.draw()
    assert not [artist for artist in ax.get_children() if artist.get_gid() == "border"]


def test_what_is_no_sweep_is_refused():
    with pytest.raises(ContwalkError, match="two of its values"):
        plot_stability_map([hopf()], "mu", "c")
    with pytest.raises(ContwalkError, match="free on no branch"):
        plot_stability_map(sweep(), "c", "mu")
    with pytest.raises(ContwalkError, match="'max_re' varies along branch b1"):
        plot_stability_map(sweep(), "mu", "max_re")
    with pytest.raises(ContwalkError, match="No branch has a quantity named 'max_re'"):
        plot_stability_map([fold()], "mu", "x")
    with pytest.raises(ContwalkError, match="Did you mean 'mu'"):
        plot_stability_map(sweep(), "muu", "c")
    lonely = [
        branch(
            {"mu": np.array([c]), "x": np.array([c]), "max_re": np.array([c])},
            observables=("max_re",),
            parameters={"c": c},
        )
        for c in (0.0, 1.0)
    ]
    with pytest.raises(ContwalkError, match="do not lie next to each other"):
        plot_stability_map(lonely, "mu", "c")

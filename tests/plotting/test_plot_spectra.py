"""Eigenvalues and multipliers in the complex plane."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, pairwise

import numpy as np
import pytest
from synthetic_branches import branch, hopf

from contwalk.branch import SpecialPoint
from contwalk.errors import ContwalkError
from contwalk.plotting import (
    plot_eigenvalues,
    plot_multiplier_moduli,
    plot_multiplier_panels,
    plot_multipliers,
)
from contwalk.plotting.multiplier_moduli import KINDS
from contwalk.plotting.spectrum import track


def by_gid(ax, gid):
    (artist,) = [artist for artist in ax.get_children() if artist.get_gid() == gid]
    return artist


def test_tracking_undoes_a_shuffle():
    t = np.linspace(0, 1, 30)
    loci = np.stack([t + 1j, t - 1j, -1 - t + 0j, -0.5 + 0.2 * t + 0j], axis=1)
    rng = np.random.default_rng(7)
    shuffled = np.array([rng.permutation(row) for row in loci])
    tracked = track(shuffled)
    # Neighbouring values of one locus are 1/29 apart, those of two loci at least 0.5.
    assert np.abs(np.diff(tracked, axis=0)).max() < 0.04
    assert [set(row) for row in tracked.tolist()] == [set(row) for row in loci.tolist()]


def test_tracking_is_the_same_in_both_directions():
    made = hopf()["spectrum"]
    forth, back = track(made), track(made[::-1])[::-1]
    assert {tuple(column) for column in forth.T.tolist()} == {tuple(column) for column in back.T.tolist()}


def test_tracking_keeps_every_value_where_eigenvalues_come_and_go():
    nan = np.nan
    spectrum = np.array(
        [[1, 2, nan], [2.1, 1.1, 5], [5.1, 1.2, nan], [nan, nan, nan], [3, nan, nan]], dtype=complex
    )
    tracked = track(spectrum)
    np.testing.assert_array_equal(tracked[1].real, [1.1, 2.1, 5])
    np.testing.assert_array_equal(tracked[2].real, [1.2, nan, 5.1])
    assert np.isnan(tracked[3]).all()
    assert np.isfinite(tracked[4]).sum() == 1


def test_start_is_a_cross_and_end_a_ring_at_the_first_and_last_spectrum():
    made = hopf()
    ax = plot_eigenvalues([made], units={"mu": "N s/m"})
    start, end = by_gid(ax, "b1-start"), by_gid(ax, "b1-end")
    assert (start.get_marker(), end.get_marker()) == ("x", "o")
    assert end.get_markerfacecolor() == "none"
    assert set(start.get_xdata() + 1j * start.get_ydata()) == set(made["spectrum"][0])
    assert set(end.get_xdata() + 1j * end.get_ydata()) == set(made["spectrum"][-1])
    legend = [text.get_text() for text in ax.get_legend().get_texts()]
    assert legend == ["start: mu = -1.5", "end: mu = 1"]
    assert [other.get_ylabel() for other in ax.figure.axes if other is not ax] == ["mu (N s/m)"]
    assert ax.get_xlabel() == "real part"


def test_a_branch_walked_backward_starts_where_s_is_zero():
    made = hopf()
    made.points["s"] -= made.points["s"][-1]
    ax = plot_eigenvalues([made])
    start, end = by_gid(ax, "b1-start"), by_gid(ax, "b1-end")
    assert set(start.get_xdata() + 1j * start.get_ydata()) == set(made["spectrum"][-1])
    assert set(end.get_xdata() + 1j * end.get_ydata()) == set(made["spectrum"][0])
    legend = [text.get_text() for text in ax.get_legend().get_texts()]
    assert legend == ["start: mu = 1", "end: mu = -1.5"]


def test_lines_are_coloured_by_the_free_parameter_and_the_imaginary_axis_is_there():
    made = hopf()
    ax = plot_eigenvalues([made])
    loci = by_gid(ax, "b1-loci")
    assert len(loci.get_segments()) == 50 * 3
    assert loci.get_clim() == (-1.5, 1.0)
    assert by_gid(ax, "imaginary-axis").get_xdata() == [0.0, 0.0]
    low, high = ax.get_xlim()
    assert low < -2.0
    assert high > 1.0


def test_stable_spectra_still_show_the_imaginary_axis():
    mu = np.linspace(0, 1, 5)
    made = branch({"mu": mu, "x": mu}, spectrum=(-5 - mu)[:, None].astype(complex))
    low, high = plot_eigenvalues([made]).get_xlim()
    assert low < -6 < 0 < high


@pytest.mark.parametrize("k", [0, 1, 3])
def test_few_points_and_nan(k):
    spectrum = np.full((k, 2), np.nan, dtype=complex)
    spectrum[:1] = [1j, -1j]
    ax = plot_eigenvalues([branch({"mu": np.ones(k), "x": np.ones(k)}, spectrum=spectrum)])
    ax.figure.canvas.draw()
    assert len([line for line in ax.lines if line.get_gid() == "b1-start"]) == (k > 0)


def test_multipliers_have_the_unit_circle_and_eigenvalues_leave_orbits_out():
    mu = np.linspace(0, 1, 5)
    spectrum = (-0.5 - mu)[:, None].astype(complex)
    orbit = branch({"mu": mu, "x": mu}, spectrum=spectrum, problem="periodic_orbit", name="b2")
    ax = plot_multipliers([hopf(), orbit])
    assert by_gid(ax, "unit-circle").get_radius() == 1.0
    assert ax.get_aspect() == 1.0
    assert not [artist for artist in ax.get_children() if (artist.get_gid() or "").startswith("b1")]
    with pytest.raises(ContwalkError, match="figure `multipliers`"):
        plot_eigenvalues([orbit])
    with pytest.raises(ContwalkError, match="figure `eigenvalues`"):
        plot_multipliers([hopf()])


def doubling(admissible=True):
    """A multiplier that passes -1 at mu = 0 (row 20), one that changes its sign, and a pair that meets."""
    mu = np.linspace(-1.0, 1.0, 41)
    pair = np.sqrt((mu - 0.525).astype(complex))  # imaginary before, real after
    spectrum = np.stack([-1.0 - mu / 2, 0.2 * (mu + 0.025) + 0j, 0.4 + pair / 4, 0.4 - pair / 4], axis=1)
    special = (SpecialPoint("PD", 20.0, unstable_before=0, unstable_after=1),)
    return branch(
        {"mu": mu, "x": mu},
        spectrum=spectrum,
        problem="hybrid_orbit",
        unstable=(mu > 1e-9).astype(int),
        admissible=admissible,
        special=special,
    )


def test_moduli_tell_the_kinds_of_multipliers_apart():
    ax = plot_multiplier_moduli([doubling()], units={"mu": "m"})
    kinds = {"positive": [], "negative": [], "complex pair": []}
    for artist in ax.collections:
        kind = (artist.get_gid() or "").removeprefix("b1-")
        kinds.setdefault(kind, []).extend(artist.get_segments())
    negative = np.concatenate(kinds["negative"])
    np.testing.assert_allclose(negative[:, 1].max(), 1.5)  # |-1 - mu / 2|
    assert np.concatenate(kinds["complex pair"])[:, 0].max() < 0.6
    # Where a real multiplier changes its sign there is a gap: it passes zero.
    steps = [line[k : k + 2] for kind in KINDS[:2] for line in kinds[kind] for k in range(len(line) - 1)]
    crossing = [s for s in steps if s[0, 0] < -0.025 < s[1, 0]]
    assert crossing
    assert all(abs(s[:, 1]).min() > 0.3 for s in crossing)
    (mark,) = [line for line in ax.lines if line.get_gid() == "b1-PD1"]
    assert mark.get_ydata()[0] == 1.0
    assert mark.get_xdata()[0] == pytest.approx(0.0, abs=1e-15)
    assert [text.get_text() for text in ax.texts] == ["PD1"]
    legend = [text.get_text() for text in ax.get_legend().get_texts()]
    assert legend == ["positive", "negative", "complex pair"]
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("mu (m)", "modulus of multipliers")


def test_neighbouring_segments_of_a_multiplier_are_one_line():
    ax = plot_multiplier_moduli([doubling()])
    lines = {(c.get_gid() or "").removeprefix("b1-"): c.get_segments() for c in ax.collections}
    # Where the orbit is unstable: one that is negative, one that is positive, a pair, and what it becomes.
    assert [len(lines[kind]) for kind in KINDS] == [3, 1, 2]
    assert all(len(line) > 2 for kind in KINDS for line in lines[kind])


def test_moduli_and_loci_of_what_is_not_admissible_are_told():
    half = np.arange(41) < 10
    ax = plot_multiplier_moduli([doubling(half)])
    assert "light: not admissible" in [text.get_text() for text in ax.get_legend().get_texts()]
    plane = plot_multipliers([doubling(half)])
    assert "thin: not admissible" in [text.get_text() for text in plane.get_legend().get_texts()]
    widths = by_gid(plane, "b1-loci").get_linewidths()
    assert len(set(np.asarray(widths))) == 2
    whole = plot_multipliers([doubling()])
    assert len(whole.get_legend().get_texts()) == 2


def test_a_pair_meets_on_the_real_axis():
    segments = by_gid(plot_multipliers([doubling()]), "b1-loci").get_segments()
    bent = [s for s in segments if len(s) == 3]
    assert len(bent) == 2  # both of the pair, once
    for piece in bent:
        assert piece[1, 1] == 0.0
        assert piece[1, 0] == pytest.approx(0.4)


def test_moduli_need_orbits():
    with pytest.raises(ContwalkError, match="figure `eigenvalues`"):
        plot_multiplier_moduli([hopf()])


@pytest.mark.parametrize("k", [0, 1, 2])
def test_moduli_of_few_points(k):
    made = branch(
        {"mu": np.arange(float(k)), "x": np.ones(k)},
        spectrum=np.zeros((k, 1), dtype=complex),
        problem="hybrid_orbit",
    )
    ax = plot_multiplier_moduli([made])
    ax.figure.canvas.draw()
    # Multipliers that are zero are below the axis: the unit modulus is drawn, and what is missing is told.
    assert by_gid(ax, "unit-modulus").get_ydata()[0] == 1.0
    assert [text.get_text() for text in ax.texts if text.get_gid() == "left-out"] == (
        ["not shown: 1 of modulus below 0.0001"] if k else []
    )


# -- spectra of widely different size ----------------------------------------------------------------------

MU = np.linspace(0.0, 1.0, 21)


def orbits(*multipliers):
    spectrum = np.stack(
        [np.broadcast_to(np.asarray(m, dtype=complex), MU.shape) for m in multipliers], axis=1
    )
    return branch({"mu": MU, "x": MU}, spectrum=spectrum, problem="periodic_orbit")


def points_at_rest(*eigenvalues):
    spectrum = np.stack(
        [np.broadcast_to(np.asarray(m, dtype=complex), MU.shape) for m in eigenvalues], axis=1
    )
    return branch({"mu": MU, "x": MU}, spectrum=spectrum)


def drawn_width(ax, low, high):
    """Share of the axes' width that an interval of real parts takes."""
    (left, _), (right, _) = ax.transData.transform([(low, 0.0), (high, 0.0)])
    return (right - left) / ax.bbox.width


def test_eigenvalues_that_decide_are_seen_beside_stiff_ones():
    ax = plot_eigenvalues([points_at_rest(-1e6 * (1 + MU), MU - 0.5 + 1j, MU - 0.5 - 1j)])
    assert ax.get_xscale() == "symlog"
    assert ax.get_yscale() == "linear"
    # On a linear axis these would be 5e-7 of it.
    assert drawn_width(ax, -0.5, 0.5) > 0.2
    low, high = ax.get_xlim()
    assert low < -2e6
    assert high > 0.5
    assert "logarithmic beyond ±0.1" in ax.get_xlabel()
    boxes = [label.get_window_extent() for label in ax.get_xticklabels()]
    assert not any(a.overlaps(b) for a, b in pairwise(boxes))


def test_eigenvalues_of_like_size_keep_a_linear_axis():
    ax = plot_eigenvalues([points_at_rest(-100.0, MU - 0.5, 0.0)])  # a zero eigenvalue is no small one
    assert ax.get_xscale() == "linear"
    assert "logarithmic" not in ax.get_xlabel()


def test_multipliers_that_are_zero_do_not_stretch_the_axis():
    ax = plot_multiplier_moduli([orbits(0.5 + MU, 0.0, 1e-9)])
    low, high = ax.get_ylim()
    assert 0.3 < low < 0.5
    assert 1.5 < high < 2.0
    assert by_gid(ax, "left-out").get_text() == "not shown: 2 of modulus below 0.0001"


def test_nothing_is_left_out_without_a_word():
    assert [
        t for t in plot_multiplier_moduli([orbits(0.5 + MU, 0.1)]).texts if t.get_gid() == "left-out"
    ] == []
    ax = plot_multiplier_moduli([orbits(np.where(MU > 0.9, np.inf, 1.0 + MU), 0.2)])
    assert by_gid(ax, "left-out").get_text() == "not shown: some infinite"
    assert ax.get_ylim()[1] < 3.0


def test_all_multipliers_zero_still_shows_the_circle_and_says_so():
    ax = plot_multiplier_moduli([orbits(0.0, 0.0)])
    low, high = ax.get_ylim()
    assert low < 1.0 < high
    assert "2 of modulus below" in by_gid(ax, "left-out").get_text()


def test_names_of_many_points_lie_within_the_axes_and_the_others_are_told():
    special = tuple(SpecialPoint(label, 10.0 + k) for k in range(12) for label in ("PD", "LP"))
    many = [
        branch(
            {"mu": np.linspace(0.2, 0.21 + j, 61), "x": np.linspace(0.0, 1.0, 61)},
            spectrum=np.linspace(0.5, 2.0, 61)[:, None].astype(complex),
            problem="periodic_orbit",
            special=special,
            name=f"b{j + 1}",
        )
        for j in range(9)
    ]
    said = []
    ax = plot_multiplier_moduli(many, report=said.append)
    ax.figure.canvas.draw()
    names = [text for text in ax.texts if "/" in text.get_text()]
    assert len(names) > 5
    for text in names:
        box = text.get_window_extent()
        assert ax.bbox.x0 <= box.x0 <= box.x1 <= ax.bbox.x1
        assert ax.bbox.y0 <= box.y0 <= box.y1 <= ax.bbox.y1
    assert not any(a.get_window_extent().overlaps(b.get_window_extent()) for a, b in combinations(names, 2))
    assert any("left out" in text.get_text() for text in ax.get_legend().get_texts())
    assert "no room for the names" in said[0]


def test_multipliers_of_branches_of_one_name_are_told_apart():
    axes = plot_multiplier_panels([orbits(0.5 + MU), orbits(0.4 + MU)])
    assert [axes[k].get_title("left").split(",")[0] for k in (0, 2)] == ["b1", "b2"]


def test_multipliers_of_full_orbits_are_powers_of_those_of_their_closures():
    """Of half an orbit that a mirror closes up, fold 2, the multiplier -0.9 is 0.81 of the whole."""
    half = orbits(-0.9)
    half = replace(half, info=replace(half.info, settings={"fold": 2}))
    for full, value in ((False, -0.9), (True, 0.81)):
        plane, _ = plot_multiplier_panels([half], full=full)
        dots = by_gid(plane, "b1-dots").get_offsets()
        np.testing.assert_allclose(dots, np.tile([value, 0.0], (len(MU), 1)), rtol=1e-15)


def test_branches_that_go_on_as_others_may_share_one_pair_of_panels():
    some = [orbits(0.5 + MU), orbits(0.4 + MU)]
    assert [len(plot_multiplier_panels(some, together=together)) for together in (False, True)] == [4, 2]


def test_a_branch_that_goes_on_as_another_one_has_no_end_there():
    first = orbits(0.5 + MU)
    second = orbits(0.4 + MU)
    parent = ("b1", float(first.points["s"][-1]))
    second = replace(second, info=replace(second.info, name="b2", parent=parent))
    plane = plot_multipliers([first, second])
    marks = [
        artist.get_gid() for artist in plane.get_lines() if str(artist.get_gid()).endswith(("-start", "-end"))
    ]
    assert marks == ["b1-start", "b2-end"]

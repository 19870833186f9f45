"""Histograms of samples, the tradeoff of time and error, and multipliers far outside the circle."""

from __future__ import annotations

import numpy as np
import pytest
from synthetic_branches import branch

from contwalk.errors import ContwalkError
from contwalk.plotting import plot_histogram, plot_multipliers, plot_tradeoff


def by_gid(ax, gid):
    return [artist for artist in ax.get_children() if artist.get_gid() == gid]


def test_mean_and_standard_error_are_drawn_and_told():
    samples = np.arange(10.0)  # mean 4.5, deviation sqrt(55 / 6), error 0.957
    ax = plot_histogram(samples, label="turns", never_settled=2)
    (mean,) = by_gid(ax, "mean")
    assert mean.get_xdata()[0] == 4.5
    (bars,) = by_gid(ax, "bars")
    assert bars.get_data().values.sum() == 10
    told = ax.get_title(loc="left")
    for words in ("10 samples", "4.50 ± 0.96", "standard deviation 3.028", "never settled: 2"):
        assert words in told
    assert ax.get_xlabel() == "turns"


def test_a_long_tail_is_one_bar_and_no_sample_is_lost():
    samples = np.concatenate([np.linspace(0.0, 1.0, 998), [50.0, 60.0, 70.0]])
    ax = plot_histogram(samples)
    (bars,) = by_gid(ax, "bars")
    edges = bars.get_data().edges
    shown = samples <= edges[-1]
    assert edges[-1] <= 1.0
    assert bars.get_data().values.sum() == shown.sum()
    (tail,) = by_gid(ax, "tail")
    assert tail.get_height() == (~shown).sum()
    assert any(f"{(~shown).sum()} beyond" in text.get_text() for text in ax.texts)


@pytest.mark.parametrize("samples", [[3.0], [3.0, 3.0, 3.0]])
def test_equal_samples_have_no_error(samples):
    ax = plot_histogram(np.array(samples))
    assert "mean 3 " in ax.get_title(loc="left") + " "
    assert not by_gid(ax, "error")
    ax.figure.canvas.draw()


@pytest.mark.parametrize(("samples", "words"), [([], "missing"), ([1.0, np.nan], "not finite")])
def test_what_is_no_sample_is_refused(samples, words):
    with pytest.raises(ContwalkError, match=words):
        plot_histogram(np.array(samples))


def test_methods_have_lines_and_exact_results_stay_on_the_page():
    ax = plot_tradeoff({"slow": [(1.0, 1e-3), (2.0, 0.0)], "fast": [(0.1, 1e-5)]}, notes={"slow": ["1e-3"]})
    (slow,) = by_gid(ax, "method-slow")
    np.testing.assert_allclose(slow.get_ydata(), [1e-3, 2.0**-53])
    (exact,) = by_gid(ax, "exact-slow")
    assert exact.get_xdata().tolist() == [2.0]
    assert (ax.get_xscale(), ax.get_yscale()) == ("log", "log")
    assert by_gid(ax, "rounding")
    assert [text.get_text() for text in ax.texts] == ["1e-3"]
    ax.figure.canvas.draw()


@pytest.mark.parametrize(
    ("series", "words"),
    [
        ({}, "nothing to draw"),
        ({"a": [(np.nan, 1.0)]}, "nothing to draw"),
        ({"a": [(0.0, 1.0)]}, "not positive"),
        ({"a": [(1.0, -1.0)]}, "negative"),
    ],
)
def test_what_has_no_logarithm_is_refused(series, words):
    with pytest.raises(ContwalkError, match=words):
        plot_tradeoff(series)


def test_large_multipliers_do_not_hide_the_unit_circle():
    mu = np.linspace(0.0, 1.0, 5)
    spectrum = np.stack([0.5 + 0j * mu, 300.0 * mu + 0.1 + 0j], axis=1)
    ax = plot_multipliers([branch({"mu": mu, "x": mu}, spectrum=spectrum, problem="periodic_orbit")])
    # From the circle to the modulus beyond which nothing is shown, and no higher than the circle.
    assert -2.0 < ax.get_xlim()[0] < -1.0 < 3.0 < ax.get_xlim()[1] < 4.0
    assert max(ax.get_ylim()) < 1.6
    (told,) = by_gid(ax, "outside")
    assert told.get_text() == "moduli up to 300 lie outside"

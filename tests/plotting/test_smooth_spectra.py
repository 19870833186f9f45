"""Eigenvalues between the points of a branch, against those of known matrices."""

from __future__ import annotations

import numpy as np
import pytest
from synthetic_branches import branch

from contwalk.plotting import plot_multiplier_moduli, plot_multipliers
from contwalk.plotting.smooth_spectra import smooth_loci
from contwalk.plotting.spectrum import track

S = np.linspace(-1.0, 1.0, 9)


def meeting(s):
    """Roots of z^2 - 0.4 z + 0.1 + s: a complex pair that meets at s = -0.06 and goes on as two real ones."""
    root = np.sqrt((-0.06 - s).astype(complex))
    return np.stack([0.2 + root, 0.2 - root], axis=1)


def loci(values):
    return smooth_loci(S, track(values(S)), S, np.ones_like(S))


def test_where_two_meet_they_are_the_roots_of_what_is_smooth():
    fine = loci(meeting)
    # Sum and product are linear in s, and cubics have linear functions as they are: rounding is left, whose
    # root is 1e-8. Two segments away from where they meet, each is a cubic of its own.
    exact, near = meeting(fine.across), np.abs(fine.across + 0.06) < 0.25
    np.testing.assert_allclose(np.sort_complex(fine.values)[near], np.sort_complex(exact)[near], atol=1e-7)
    np.testing.assert_allclose(np.sort_complex(fine.values), np.sort_complex(exact), atol=5e-3)
    assert len(fine.across) > 30
    np.testing.assert_array_equal(fine.values[np.diff(fine.rows, prepend=-1) > 0], track(meeting(S)))


def test_a_pair_goes_round_in_a_circle_not_in_a_polygon():
    def turning(s):
        return 2.0 * np.exp(1j * np.pi * np.stack([0.5 + 0.4 * s, -0.5 - 0.4 * s], axis=1))

    fine = loci(turning)
    # The sum is 4 cos; a cubic with Akima's slopes over a twentieth of a turn misses it by some thousandths.
    assert np.abs(np.abs(fine.values) - 2.0).max() < 1e-12  # the product is exact
    np.testing.assert_allclose(fine.values[:, 0], turning(fine.across)[:, 0], atol=2e-2)
    steps = np.abs(np.diff(fine.values[:, 0]))
    assert steps.max() < 0.25  # of an arc of 5


def test_a_real_one_that_bends_is_a_curve_and_a_straight_one_needs_no_points():
    bent = loci(lambda s: np.exp(3.0 * s)[:, None].astype(complex))
    np.testing.assert_allclose(bent.values[:, 0], np.exp(3.0 * bent.across), rtol=5e-2)
    assert len(bent.across) > 2 * len(S)
    straight = loci(lambda s: (2.0 + s)[:, None].astype(complex))
    np.testing.assert_array_equal(straight.across, S)


def test_what_is_not_finite_interrupts_and_spoils_nothing_else():
    values = np.stack([np.exp(S), np.where(S > 0.5, np.nan, S), np.where(S < -0.5, np.inf, S)], axis=1)
    fine = smooth_loci(S, values.astype(complex), S, np.ones_like(S))
    assert np.isfinite(fine.values[:, 0]).all()
    np.testing.assert_allclose(fine.values[:, 0], np.exp(fine.across), rtol=5e-3)


@pytest.mark.parametrize("k", [0, 1, 2, 3])
def test_few_points(k):
    fine = smooth_loci(S[:k], track(meeting(S[:k])), S[:k], np.ones(k))
    assert len(fine.across) >= k
    assert np.isfinite(fine.values).all()


def test_drawn_loci_have_no_corners():
    made = branch({"mu": S, "x": S}, spectrum=meeting(S), problem="periodic_orbit", s=S)
    (lines,) = [c for c in plot_multipliers([made]).collections if c.get_gid() == "b1-loci"]
    lengths = [np.hypot(*(piece[-1] - piece[0])) for piece in lines.get_segments()]
    assert max(lengths) < 0.15  # of a curve from 0.2 - i to 0.2, and to -0.8 and 1.2
    ax = plot_multiplier_moduli([made])
    for piece in [p for c in ax.collections if c.get_gid() for p in c.get_segments()]:
        exact = np.abs(meeting(piece[:, 0]))
        assert np.abs(exact - piece[:, 1:]).min(axis=1).max() < 5e-3  # as above

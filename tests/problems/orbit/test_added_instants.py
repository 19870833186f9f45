"""Instants at which states are largest and smallest, added to the samples of a motion."""

from __future__ import annotations

import numpy as np
import pytest

from contwalk.problems.orbit.extrema import with_extrema


@pytest.mark.parametrize("top", [0.0005, 0.003, 0.008, 0.013, 0.1, 0.48, 0.97, 0.994, 0.9995])
def test_the_instants_of_extremes_are_added(top):
    """Of a cosine that is largest at `top`, and smallest half a round later, between samples."""

    def at(times):
        return np.column_stack([np.cos(2.0 * np.pi * (times - top)), times])

    times = np.linspace(0.0, 1.0, 129)
    found, states = with_extrema(at, times, at(times))
    assert np.all(np.diff(found) >= 0.0)
    assert set(times) <= set(found)
    np.testing.assert_array_equal(states, at(found))
    # The second parabola is 3e-4 of a round wide: the fourth power of its angle.
    assert [states[:, 0].max(), states[:, 0].min()] == pytest.approx([1.0, -1.0], abs=1e-12)


@pytest.mark.parametrize("samples", [20, 33, 60])
def test_of_peaks_of_almost_one_height_the_highest_is_found(samples):
    """The second and higher of two peaks is within the last of 20 samples, where the first is larger."""

    def at(times):
        return np.column_stack([np.cos(2.0 * times + 0.3) + 1e-6 * np.cos(times), np.ones_like(times)])

    times = np.linspace(0.0, 2.0 * np.pi, samples)
    found, states = with_extrema(at, times, at(times))
    assert np.all(np.diff(found) > 0.0)
    assert len(found) <= samples + 5
    largest = 1.0 + 1e-6 * np.cos(np.pi - 0.15 + np.pi)  # to 1e-12: its cosine is flat there
    assert states[:, 0].max() == pytest.approx(largest, abs=1e-11)

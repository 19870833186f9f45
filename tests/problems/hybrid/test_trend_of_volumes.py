"""The slope by which volumes along a motion are told to stay or to go."""

import numpy as np
import pytest

from contwalk.problems.initial.volume import _trend


def test_events_that_happen_at_once_at_the_ends_of_a_motion_weigh_nothing() -> None:
    """As where a switch acts as soon as a clock has ticked (a buck converter); warnings are errors here."""
    times = np.array([0.0, 0.0, 1.0, 2.0, 4.0, 4.0])
    assert _trend(times, 3.0 - 2.0 * times) == pytest.approx(-2.0, rel=1e-14)  # roundings

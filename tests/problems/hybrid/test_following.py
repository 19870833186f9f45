"""Whether the machine itself, by simulation, does what an orbit's itinerary says."""

from __future__ import annotations

import numpy as np
import pytest
from hybrid_machines import orbit

from contwalk.problems.hybrid.simulated_round import follows
from contwalk.problems.hybrid.softness import _pieces


@pytest.mark.parametrize("name", ["guard of both directions", "different numbers of states"])
def test_a_motion_of_several_legs_is_followed_and_others_are_not(name):
    problem, z = orbit(name)
    assert follows(problem, z) is None
    moved = z.copy()
    moved[problem.layout.durations] *= np.array([1.05, *([0.95] * (problem.layout.legs - 1))])
    assert "happens at another time" in (follows(problem, moved) or "")


def test_a_stretch_without_duration_is_one_leg_without_duration():
    x = np.array([0.3, -1.0])
    (piece,), last = _pieces(None, "free", 0.5, x, 0.5, np.ones(2))
    assert (piece[0].mode, piece[2]) == ("free", 0.0)
    assert last is x

"""A start costs a bounded number of right-hand sides, and says so where these were not enough."""

from __future__ import annotations

import numpy as np
import pytest
from forced_mirrors import block, half
from hybrid_runs import opened, solution

from contwalk.branch import Outcome
from contwalk.errors import NotFinite, StartError
from contwalk.problems.orbit import effort
from contwalk.problems.orbit.meshing import LEAST_MOST, MOST_STEPS, most_steps


def start() -> dict:
    own = half(2.8, 3, rocks=True)
    return {
        "state": list(own.at_zero),
        "parameters": {"beta": 2.8},
        "mode": "right" if own.at_zero[0] > 0.0 else "left",
    }


def test_only_a_start_is_bounded() -> None:
    tally = effort.Effort()
    tally.spend(10**12)
    with tally.of_start(10):
        tally.spend(10 * effort.START)
        with pytest.raises(StartError, match="right-hand sides"):
            tally.spend(1)
    tally.spend(10**12)
    assert tally.spent == 2 * 10**12 + 10 * effort.START + 1


def test_a_start_that_costs_too_much_ends_with_what_was_tried_and_what_to_do(monkeypatch) -> None:
    monkeypatch.setattr(effort, "START", 1)  # any correction takes more than one evaluation
    found = opened(block(), "beta", **start())
    assert isinstance(found, Outcome)
    assert (found.status, found.reason) == ("failed", "no_convergence")
    assert "far from the guess" in found.message
    assert "until: settled" in found.message
    assert "(itinerary: " in found.message
    settled = opened(block(), "beta", **start(), until="settled")
    assert "far from the guess" in settled.message
    assert "until: settled" not in settled.message


def test_a_usual_start_costs_far_less_than_it_may() -> None:
    problem, _ = solution(block(), "beta", **start())
    # The start, its steps for the branch, and everything that was told of it.
    assert problem.effort.spent < 0.5 * effort.START * problem.cost


def test_motions_beside_a_known_orbit_are_given_up_where_they_take_very_many_steps() -> None:
    problem, z = solution(block(), "beta", **start())
    assert most_steps(None, 1e-6) == MOST_STEPS
    assert most_steps(problem.mesh, problem.mesh.tolerance) == LEAST_MOST
    far = z.copy()
    far[problem.layout.durations] = 1e7  # a million periods of the forcing
    before = problem.effort.spent
    with pytest.raises(NotFinite, match=r"more steps than are allowed|not finite"):
        problem.adapted_to(far, np.ones(len(z)))
    assert problem.effort.spent > before  # what has failed is counted, too

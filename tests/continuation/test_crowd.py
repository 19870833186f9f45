"""Special points that crowd within what solutions are known to end a walk; others do not."""

from __future__ import annotations

from dataclasses import replace

import pytest
from made_up import line

from contwalk.branch import Outcome
from contwalk.continuation import pseudo_arclength
from contwalk.continuation.crowd import IN_A_ROW, Crowd
from contwalk.continuation.locating import Disagreement
from contwalk.continuation.marks import observer_of
from contwalk.continuation.pseudo_arclength import End, walk
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState
from contwalk.continuation.step import Step, _unlocated, take_step


def test_ten_that_lie_within_errors_are_noise_and_nine_are_not():
    crowd = Crowd((False, 1e-8 * k, 1e-6) for k in range(IN_A_ROW - 1))
    assert not crowd.is_noise
    crowd.tell(False, 0.0, 1e-7)
    assert crowd.is_noise
    assert crowd.error == 1e-6


def test_one_that_is_located_begins_the_count_anew():
    crowd = Crowd((k == 5, 1e-8 * k, 1e-6) for k in range(IN_A_ROW + 5))
    assert not crowd.is_noise


def test_points_that_lie_apart_are_none():
    """They may be real: only that they could not be located is known of them."""
    assert not Crowd((False, 0.1 * k, 1e-3) for k in range(3 * IN_A_ROW)).is_noise


@pytest.mark.parametrize("error", [1e-6, 1.0])
def test_a_walk_over_rounding_ends_and_one_whose_points_lie_apart_goes_on(monkeypatch, error):
    """Each step tells a point that is not located; what solutions are known to decides what these are."""

    def doubtful(problem, state, settings, observer) -> Step | Outcome:
        step = take_step(problem, state, settings, observer)
        if isinstance(step, Outcome):
            return step
        kind = problem.point_types[0]
        found = _unlocated(step.segment, Disagreement(kind, "Not found."))
        return replace(step, found=[replace(found, sample=replace(found.sample, error=error))])

    monkeypatch.setattr(pseudo_arclength, "take_step", doubtful)
    problem, settings = line(lambda z: [-1.0]), Settings(range=(0.0, 3.0), max_step=0.1)
    state = ContinuationState(problem.sample((0.0, 0.0), (0.0, 1.0)), 0.0, 0.01)
    events = list(walk(problem, state, settings, observer_of(problem), 1.0, 1000))
    last = events[-1]
    assert isinstance(last, End)
    if error == 1.0:
        assert (last.outcome.status, last.outcome.reason) == ("failed", "step_too_small")
        assert f"the last {IN_A_ROW} special points were not located" in last.outcome.message
        assert len(events) == 2 * IN_A_ROW + 1
    else:
        assert last.outcome.reason == "bound"

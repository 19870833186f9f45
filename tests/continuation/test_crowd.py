"""Points that crowd within what solutions are known to end a walk; others do not."""

from __future__ import annotations

from dataclasses import replace

import pytest
from made_up import line

from contwalk.branch import Outcome
from contwalk.continuation import pseudo_arclength
from contwalk.continuation.ends import CREEPING, IN_A_ROW, Crowd
from contwalk.continuation.locating import unlocated
from contwalk.continuation.marks import observer_of
from contwalk.continuation.pseudo_arclength import End, walk
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState
from contwalk.continuation.step import Step, take_step


def test_ten_that_lie_within_errors_are_noise_and_nine_are_not():
    crowd = Crowd((False, 1e-8 * k, 1e-6) for k in range(IN_A_ROW - 1))
    assert crowd.noise(0.1) is None
    crowd.tell(False, 0.0, 1e-7)
    noise = crowd.noise(0.1)
    assert noise is not None
    assert noise[1] == 1e-6


def test_one_that_is_located_begins_the_count_anew():
    crowd = Crowd((k == 5, 1e-8 * k, 1e-6) for k in range(IN_A_ROW + 5))
    assert crowd.noise(0.1) is None


def test_points_that_lie_apart_are_none():
    """They may be real: only that they could not be located is known of them."""
    assert Crowd((False, 0.1 * k, 1e-3) for k in range(3 * IN_A_ROW)).noise(0.1) is None


@pytest.mark.parametrize(
    ("count", "step", "error", "noise"),
    [
        (CREEPING, 1e-9, 1.0, True),
        (CREEPING - 1, 1e-9, 1.0, False),
        (CREEPING, 1e-9, 1e-8, False),  # known better than the way along all of them
        (CREEPING, 1e-9, float("nan"), False),  # the start of a branch may not tell
        (CREEPING, 1e-5, 1.0, False),  # they get on, and errors may be pessimistic
    ],
)
def test_a_hundred_points_within_a_thousandth_of_a_step_are_noise(count, step, error, noise):
    crowd = Crowd(points=((step * k, error) for k in range(count)))
    assert crowd.noise(0.1) == ((f"the last {CREEPING} points", error) if noise else None)


@pytest.mark.parametrize("error", [1e-6, 1.0])
def test_a_walk_over_rounding_ends_and_one_whose_points_lie_apart_goes_on(monkeypatch, error):
    """Each step tells a point that is not located; what solutions are known to decides what these are."""

    def doubtful(problem, state, settings, observer) -> Step | Outcome:
        step = take_step(problem, state, settings, observer)
        if isinstance(step, Outcome):
            return step
        found = unlocated(1.0, problem.point_types[0], step.segment.b, 0.0, "Not found.")
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

"""What is done at a limit of an orbit's word: what is asked for, unless it cannot be."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from made_up import at

from contwalk.continuation.limits import policy, stopping, up_to
from contwalk.continuation.locating import Found
from contwalk.problems.hybrid.limits import Limit

GRAZES = Limit("GR", "terminal", "impact", 0, "dip")
TOUCHES = Limit("GR", "interior", "wall", 0, "dip")
WATCHED = Limit("AZ", "middle", "middle", 0, "dip", acts=False)
COMES_NEAR = Limit("GR", "interior", "middle", 0, "dip", acts=False)


def found(which: int, theta: float) -> Found:
    return Found(theta, "limit", at(0.0, 0.0, limit=which), None)


@pytest.mark.parametrize(
    ("limit", "asked", "done"),
    [
        (TOUCHES, "stop", "stop"),
        (TOUCHES, "switch", "switch"),
        (TOUCHES, "ignore", "ignore"),
        (TOUCHES, None, "ignore"),
        (GRAZES, "switch", "switch"),
        (GRAZES, "ignore", "stop"),  # beyond it no orbit of this word is the machine's
        (GRAZES, None, "stop"),
        (COMES_NEAR, "switch", "ignore"),  # nothing happens there
        (COMES_NEAR, "stop", "stop"),
        (WATCHED, "stop", "stop"),
        (WATCHED, "ignore", "ignore"),
    ],
)
def test_what_is_done_at_a_limit(limit, asked, done):
    problem = SimpleNamespace(limited=SimpleNamespace(limits=(TOUCHES, limit)))
    events = {} if asked is None else {limit.label: asked}
    assert policy(problem, found(1, 0.0), events) == done


VANISHES = Limit("OC", "order_change", "impact", 0, "duration")
SWITCHES = {"OC": "switch", "GR": "stop", "AZ": "ignore"}


@pytest.mark.parametrize("rounding", [-1e-12, 0.0, 1e-12])
def test_what_is_at_its_limit_where_the_branch_ends_is_told_on_either_side_of_the_end(rounding):
    """A watched guard on a leg that vanishes: its limit coincides with the end to the last digits."""
    problem = SimpleNamespace(limited=SimpleNamespace(limits=(VANISHES, WATCHED, COMES_NEAR)))
    reached = sorted([found(0, 0.5), found(1, 0.5 + rounding), found(1, 0.7)], key=lambda point: point.theta)
    end = stopping(problem, reached, SWITCHES)
    assert end is not None
    told = sorted(up_to(problem, reached, end, SWITCHES), key=lambda point: point.theta)
    assert [point.located.limit for point in told] == [1, 0]
    assert told[-1] is end
    assert told[0].theta == min(0.5, 0.5 + rounding)


@pytest.mark.parametrize("rounding", [-1e-12, 0.0, 1e-12])
def test_of_two_ends_at_one_place_the_same_is_told_whichever_comes_first(rounding):
    limits = VANISHES, GRAZES
    problem = SimpleNamespace(limited=SimpleNamespace(limits=limits))
    reached = sorted([found(0, 0.5), found(1, 0.5 + rounding)], key=lambda point: point.theta)
    end = stopping(problem, reached, SWITCHES)
    assert end is not None
    assert end.located.among(limits) is min(limits, key=lambda limit: limit.rank)
    assert up_to(problem, reached, end, SWITCHES) == [end]

"""What is done at a limit of an orbit's word: what is asked for, unless it cannot be."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from made_up import at

from contwalk.continuation.limits import policy
from contwalk.problems.hybrid.limits import Limit

GRAZES = Limit("GR", "terminal", "impact", 0, "dip")
TOUCHES = Limit("GR", "interior", "wall", 0, "dip")
WATCHED = Limit("AZ", "middle", "middle", 0, "dip", acts=False)
COMES_NEAR = Limit("GR", "interior", "middle", 0, "dip", acts=False)


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
    assert policy(problem, at(0.0, 0.0, vectors={"limit": 1}), events) == done

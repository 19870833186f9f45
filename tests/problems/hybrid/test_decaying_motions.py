"""Motions that come back to their events ever smaller, or ever larger: no orbit is at the end of either."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hybrid_runs import machine

from contwalk.errors import StartError
from contwalk.problems.hybrid.mirrors import Span
from contwalk.problems.initial.decaying import decaying
from contwalk.problems.initial.event_recurrence import recurrence_from
from contwalk.problems.orbit.itinerary import Leg
from contwalk.system import System, Transition


def spiral() -> System:
    """A rotation with r' = g r (r < 1) or towards a circle of radius a, in halves of the plane."""

    def turns(t, x, p, dx):
        r = np.sqrt(x[0] ** 2 + x[1] ** 2)
        dx[0] = p.g * (x[0] - p.a * x[0] / r) - x[1]
        dx[1] = p.g * (x[1] - p.a * x[1] / r) + x[0]

    def height(t, x, p):
        return x[1]

    return machine(
        ["x", "y"],
        {"g": -0.05, "a": 0.0},
        {"upper": turns, "lower": turns},
        [
            Transition("down", "upper", "lower", height),
            Transition("up", "lower", "upper", height, "rising"),
        ],
    )


def halves(sizes) -> list[Span]:
    """Stretches of half a turn each, of these sizes one after the other."""
    ends = [np.array([(-1.0) ** k * size, 0.0]) for k, size in enumerate(sizes)]
    return [Span(Leg("upper"), float(k), *pair) for k, pair in enumerate(_with_times(ends))]


def _with_times(ends):
    return [(a, 1.0, b) for a, b in pairwise(ends)]


@pytest.mark.parametrize(("left", "decays"), [(0.0, True), (0.1, False)])
def test_what_shrinks_alike_from_return_to_return_decays(left, decays) -> None:
    stretches = halves(1e-3 * (left + 0.9 ** np.arange(7)))
    assert decaying(spiral(), stretches, 2, np.ones(2)) == decays


def test_what_has_decayed_is_refused() -> None:
    with pytest.raises(StartError, match=r"decays to rest through events: each return moves 0\.81"):
        decaying(spiral(), halves(1e-11 * 0.9 ** np.arange(7)), 2, np.ones(2))


def test_a_motion_that_decays_is_not_told_to_be_one_of_a_family() -> None:
    with pytest.raises(StartError, match="to rest"):
        recurrence_from(spiral(), {"g": -0.05, "a": 0.0}, np.array([1.0, 0.0]), "upper")


def test_a_small_orbit_that_is_left_over_is_found() -> None:
    found = recurrence_from(spiral(), {"g": -0.05, "a": 1e-4}, np.array([1.0, 0.0]), "upper")
    assert abs(found.stretches[0].state[0]) < 2e-4


def test_a_motion_that_grows_is_not_the_plugins_fault() -> None:
    with pytest.raises(StartError, match="grows without bound") as caught:
        recurrence_from(spiral(), {"g": 0.3, "a": 0.0}, np.array([1.0, 0.0]), "upper")
    assert "mend the plugin" not in str(caught.value)

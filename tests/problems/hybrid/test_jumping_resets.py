"""A spiral that is begun anew further in where it gets to a line: at a tangency it misses that for a turn.

r' = k r, at the angle t: x = c exp(k t) cos t gets to x = 2 in its turn number n as long as it reaches that
far there, for c above 2 exp(-k t) / cos t with t = 2 pi n + atan k. Below, orbits of the same itinerary take
one turn more.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from hybrid_runs import assert_met, diagram, machine

from contwalk.system import Transition

K = 0.1


def spiral(kept: float = 0.0):
    """`kept`: the part of y that stays when the spiral is begun anew."""

    def turns(t, x, p, dx):
        dx[0] = K * x[0] - x[1]
        dx[1] = K * x[1] + x[0]

    def begins(t, x, p, y):
        y[0] = p.c
        y[1] = kept * x[1]

    out = Transition("out", "turn", "turn", lambda t, x, p: x[0] - 2.0, "rising", begins)
    return machine(["x", "y"], {"c": 1.5}, {"turn": turns}, [out])


def tangent(n: int) -> float:
    t = 2.0 * math.pi * n + math.atan(K)
    return 2.0 * math.exp(-K * t) / math.cos(t)


def walked(system, lowest: float, depth: int):
    chosen = {"follow": ["GR"], "depth": depth, "max_step": 1.0, "direction": "down"}
    return diagram(system, "c", (lowest, 1.6), [1.5, 0.0], events={"GR": "switch"}, **chosen)


def test_the_orbit_with_one_more_turn_is_followed_from_the_tangency():
    first, second, *more = walked(spiral(), 0.9, 3)
    assert not more
    assert first.outcome.reason == second.outcome.reason == "grazing"
    for branch in (first, second):
        (grazing,) = [point for point in branch.special_points if point.label == "GR"]
        assert branch.info.signature == ("out",)
        assert_met(grazing, "c", tangent(1), 1e-8)
    assert first["period"].max() == pytest.approx(2.0 * math.pi + math.atan(K))
    assert second["c"].min() == 0.9
    assert second["c"].max() == pytest.approx(tangent(1))  # up to the point itself
    assert np.all(second["period"] > 4.0 * math.pi - 1.1)
    assert f"{first['period'].max():.6g}" in first.outcome.message  # which period is whose


def test_where_the_reset_keeps_some_of_the_state_the_motion_beyond_settles_on_orbits_that_mix_turns():
    first, *beyond = walked(spiral(kept=-0.1), 1.056, 2)
    assert first.outcome.reason == "grazing"
    assert "settles on an orbit of signature [out out]" in first.outcome.message
    assert [branch.info.signature for branch in beyond] == [("out", "out")]

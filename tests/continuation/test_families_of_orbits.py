"""Starts that no correction can isolate: a family of orbits, two events at once."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hybrid_runs import machine

from contwalk.branch import Outcome
from contwalk.continuation.opening_orbits import opened_orbit
from contwalk.continuation.settings import Settings
from contwalk.system import Neutral, Transition

# A shaken mass on a spring (x, v), and a ball in a cage on it (y, w) that nothing moves between impacts.


def shaken(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = math.cos(1.3 * t) - 0.2 * x[1] - x[0]
    dx[2] = x[3]
    dx[3] = 0.0


def knock(t, x, p, after):
    after[0], after[1], after[2], after[3] = x[0], x[1], x[2], 2.0 * x[1] - x[3]


def along(t, x, p, v):
    v[0], v[1], v[2], v[3] = 0.0, 0.0, 1.0, 0.0


@pytest.mark.parametrize(("neutral", "differ"), [((), "y"), ((Neutral("along", along, pin="y"),), "w")])
def test_orbits_that_come_in_a_family_are_told_to(neutral, differ):
    """With the place held the speed is left: one who drifts along sees another orbit."""
    system = machine(
        ["x", "v", "y", "w"],
        {"half": 9.0},
        {"free": shaken},
        [
            Transition("right", "free", "free", lambda t, x, p: p.half - (x[2] - x[0]), reset=knock),
            Transition("left", "free", "free", lambda t, x, p: p.half + (x[2] - x[0]), reset=knock),
        ],
        period=lambda p: 2.0 * math.pi / 1.3,
        neutral=neutral,
    )
    outcome = opened_orbit(
        system, {"half": 9.0}, "half", np.zeros(4), Settings(range=(8.0, 12.0)), until="settled"
    )
    assert isinstance(outcome, Outcome)
    assert outcome.message.startswith("The start leads to no solution. Orbits come in a family there")
    assert f"they differ in {differ}." in outcome.message
    assert "Neutral" in outcome.message
    assert "Give a state nearer" not in outcome.message


def twins(t, x, p, dx):
    for k in (0, 2):
        dx[k] = x[k + 1]
        dx[k + 1] = math.cos(1.3 * t) - 0.2 * x[k + 1] - x[k]


def hits(k):
    def hit(t, x, p, after):
        for i in range(4):
            after[i] = -0.8 * x[i] if i == k + 1 else x[i]

    return hit


def test_two_events_at_once_are_named():
    system = machine(
        ["a", "va", "b", "vb"],
        {"gap": 1.0},
        {"free": twins},
        [
            Transition("ka", "free", "free", lambda t, x, p: 1.0 - x[0], reset=hits(0)),
            Transition("kb", "free", "free", lambda t, x, p: p.gap - x[2], reset=hits(2)),
        ],
        period=lambda p: 2.0 * math.pi / 1.3,
    )
    outcome = opened_orbit(
        system, {"gap": 1.0}, "gap", np.zeros(4), Settings(range=(0.5, 1.6)), until="settled"
    )
    assert isinstance(outcome, Outcome)
    assert "'ka' and 'kb' happen at once" in outcome.message
    assert "another value of a parameter" in outcome.message

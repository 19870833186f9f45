"""Multipliers that run into each other, and are beyond the unit circle in a window between two points."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hybrid_runs import diagram, machine
from scipy.linalg import expm
from scipy.optimize import brentq

from contwalk.branch import SpecialPoint
from contwalk.system import Mode, State, System, Transition

DAMPING = 0.01


def kicked(kick: float) -> System:
    """An oscillator that is kicked against its place once in a unit of time."""

    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -DAMPING * x[1] - p.stiffness * x[0] - x[0] ** 3
        dx[2] = 1.0

    def kicks(t, x, p, after):
        after[0] = x[0]
        after[1] = x[1] - kick * x[0]
        after[2] = 0.0

    return machine(
        [State("x", scale=1.0), State("v", scale=1.0), "clock"],
        {"stiffness": 5.0},
        [Mode("only", field)],
        [Transition("tick", "only", "only", lambda t, x, p: 1.0 - x[2], "falling", reset=kicks)],
    )


def beyond(kick: float, stiffness: float) -> float:
    """How far the larger multiplier of the motion at rest is beyond the circle, in closed form."""
    wait = expm(np.array([[0.0, 1.0], [-stiffness, -DAMPING]]))
    return float(np.abs(np.linalg.eigvals(np.array([[1.0, 0.0], [-kick, 1.0]]) @ wait)).max() - 1.0)


def edges(measure: Callable[[float], float], low: float, high: float) -> list[float]:
    """Where a measure changes its sign between two values."""
    places = np.linspace(low, high, 3001)
    values = [measure(place) for place in places]
    return [
        brentq(measure, places[k], places[k + 1], xtol=1e-13)
        for k in range(len(places) - 1)
        if values[k] * values[k + 1] < 0.0
    ]


def points(system: System, low: float, high: float, state: list[float]) -> list[SpecialPoint]:
    """What is told of the motion at rest between two values of the stiffness."""
    (branch, *_) = diagram(
        system, "stiffness", (low, high), state, {"stiffness": low}, mode="only", until=0.0
    )
    return [point for point in branch.special_points if point.label != "EP"]


# The first tongue, at half a turn in a unit of time, and the second, at a whole one. A kick just above what
# damping allows makes them as narrow as one likes: 2 % to 0.05 % of the range.
@pytest.mark.parametrize(
    ("label", "kick", "low", "high"),
    [
        ("PD", 0.08, 5.0, 15.0),
        ("PD", 0.03146, 5.0, 14.0),
        ("BP", 0.13, 30.0, 50.0),
        ("BP", 0.0631, 33.0, 47.0),
    ],
)
def test_both_edges_of_a_narrow_tongue_are_found(label, kick, low, high):
    """Outside of it moduli are flat: that two multipliers run into each other tells."""
    found = points(kicked(kick), low, high, [0.0, 0.0, 0.0])
    expected = edges(lambda stiffness: beyond(kick, stiffness), low, high)
    assert len(expected) == 2
    assert [(p.label, p.unstable_before, p.unstable_after) for p in found] == [(label, 0, 1), (label, 1, 0)]
    for point, place in zip(found, expected, strict=True):
        assert abs(point.parameters["stiffness"] - place) <= 2.0 * point.error


@pytest.mark.parametrize("kick", [0.02, 0.0313])
def test_a_tongue_that_damping_closes_has_no_edges(kick):
    assert edges(lambda stiffness: beyond(kick, stiffness), 5.0, 15.0) == []
    assert points(kicked(kick), 5.0, 15.0, [0.0, 0.0, 0.0]) == []


def test_both_edges_of_a_combination_resonance_are_found():
    """Two oscillators whose kicks are each other's places: two pairs meet where both turn by a whole turn."""
    kick, other = 0.1, 9.0

    def field(t, x, p, dx):
        dx[0], dx[1] = x[2], x[3]
        dx[2] = -0.02 * x[2] - p.stiffness * x[0] - x[0] ** 3
        dx[3] = -0.02 * x[3] - other * x[1] - x[1] ** 3
        dx[4] = 1.0

    def kicks(t, x, p, after):
        after[0], after[1] = x[0], x[1]
        after[2], after[3] = x[2] - kick * x[1], x[3] - kick * x[0]
        after[4] = 0.0

    system = machine(
        [*(State(name, scale=1.0) for name in ("x", "y", "u", "v")), "clock"],
        {"stiffness": 5.0},
        [Mode("only", field)],
        [Transition("tick", "only", "only", lambda t, x, p: 1.0 - x[4], "falling", reset=kicks)],
    )

    def measure(stiffness: float) -> float:
        flow = np.zeros((4, 4))
        flow[:2, 2:] = np.eye(2)
        flow[2:, :2] = -np.diag([stiffness, other])
        flow[2:, 2:] = -0.02 * np.eye(2)
        jump = np.eye(4)
        jump[2:, :2] = -kick * np.eye(2)[::-1]
        return float(np.abs(np.linalg.eigvals(jump @ expm(flow))).max() - 1.0)

    found = points(system, 6.0, 16.0, [0.0] * 5)
    expected = edges(measure, 6.0, 16.0)
    assert len(expected) == 2
    near = (2.0 * math.pi - math.sqrt(other)) ** 2
    assert abs(np.mean(expected) - near) < 0.1
    assert [(p.label, p.unstable_before, p.unstable_after) for p in found] == [("NS", 0, 2), ("NS", 2, 0)]
    for point, place in zip(found, expected, strict=True):
        assert abs(point.parameters["stiffness"] - place) <= 2.0 * point.error

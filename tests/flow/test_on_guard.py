"""A state that is said to be the one right before a transition must be on its guard."""

import numpy as np
import pytest
from hybrid_runs import machine

from contwalk.continuation.settings import Settings
from contwalk.errors import StartError
from contwalk.flow.hybrid.machine import hybrid_machine
from contwalk.flow.hybrid.on_guard import check_on_guard
from contwalk.studies.opening_orbits import opened_orbit
from contwalk.system import Transition


def drifting(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -x[0]


def turned(t, x, p, after):
    after[0] = x[0]
    after[1] = -x[1]


def at_wall(t, x, p):
    return p.wall - x[0]


def at_hour(t, x, p):
    return np.sin(1e3 * t) - 0.5


SYSTEM = machine(
    ["x", "v"],
    {"wall": 2.0},
    {"free": drifting},
    [
        Transition("hit", "free", "free", at_wall, reset=turned),
        Transition("rings", "free", "free", at_hour, direction="rising", reset=turned),
    ],
)
SIZES = np.array([2.0, 5.0])


def checked(name: str, t: float, x: list[float]) -> None:
    there = hybrid_machine(SYSTEM, {"wall": 2.0})
    check_on_guard(there, there.transition(name), t, np.array(x), SIZES)


@pytest.mark.parametrize(
    ("name", "t", "x"),
    [
        ("hit", 0.0, [2.0, 5.0]),
        ("hit", 0.0, [1.99, 5.0]),  # as it may be printed
        ("hit", 0.0, [2.01, 5.0]),
        # No state moves this guard: it is zero as far as rounding shows.
        ("rings", (np.pi / 6.0 + 200.0 * np.pi) / 1e3, [0.0, 0.0]),
    ],
)
def test_a_state_on_the_guard_is_taken(name, t, x):
    checked(name, t, x)


@pytest.mark.parametrize(
    ("name", "t", "x", "value"),
    [("hit", 0.0, [0.0, 0.0], "2"), ("hit", 0.0, [2.5, 5.0], "-0.5"), ("rings", 0.0, [0.0, 0.0], "-0.5")],
)
def test_a_state_off_the_guard_is_refused_with_its_value(name, t, x, value):
    with pytest.raises(StartError, match=f"the guard of that transition is {value} there") as raised:
        checked(name, t, x)
    assert f"leave out at: {name}" in raised.value.remedy


def test_no_orbit_starts_off_the_guard():
    outcome = opened_orbit(
        SYSTEM, {"wall": 2.0}, "wall", np.zeros(2), Settings(range=(1.0, 3.0)), event="hit"
    )
    assert outcome.status == "failed"
    assert "the guard of that transition is 2 there" in outcome.message


def test_a_state_on_the_way_back_is_refused_with_its_rate():
    with pytest.raises(
        StartError, match=r"zero there with a rate of 5, and .* where it is falling"
    ) as raised:
        checked("hit", 0.0, [2.0, -5.0])
    assert "in place of at: hit" in raised.value.remedy

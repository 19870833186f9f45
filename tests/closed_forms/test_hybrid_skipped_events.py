"""An event that comes just when another one happens, after which it makes no difference: a current of a
converter that is zero at the tick of the clock.

On for half a cycle i' = 1 + i, off i' = i - b until the current is zero. With g = e^(1/2) a cycle that begins
with i ends with ((1 + i) g - 1 - b) g + b, or with none where that is negative.
"""

from __future__ import annotations

import math

import pytest
from hybrid_runs import ACCURACY, assert_met, diagram, machine

from contwalk.branch import Branch
from contwalk.system import Mode, System, Transition

GROWTH = math.exp(0.5)
# At the tick the current comes to zero of itself: (GROWTH - 1 - b) GROWTH + b = 0.
BORDER = GROWTH
CURRENT, CLOCK = range(2)


def converter() -> System:
    def on(t, x, p, dx):
        dx[CURRENT], dx[CLOCK] = 1.0 + x[CURRENT], 1.0

    def off(t, x, p, dx):
        dx[CURRENT], dx[CLOCK] = x[CURRENT] - p.b, 1.0

    def idle(t, x, p, dx):
        dx[CLOCK] = 1.0

    def half(t, x, p):
        return 0.5 - x[CLOCK]

    def current(t, x, p):
        return x[CURRENT]

    def whole(t, x, p):
        return 1.0 - x[CLOCK]

    def tick(t, x, p, after):
        after[CURRENT], after[CLOCK] = x[CURRENT], 0.0

    return machine(
        ["i", "clock"],
        {"b": 2.0},
        [Mode("on", on), Mode("off", off), Mode("idle", idle, states=("clock",))],
        [
            Transition("opens", "on", "off", half),
            Transition("empties", "off", "idle", current),
            Transition("tick", "off", "on", whole, reset=tick),
            Transition("tick", "idle", "on", whole, reset=tick),
        ],
    )


def continuous(b: float) -> float:
    """The current at the tick of the orbit that is never empty: i = ((1 + i) g - 1 - b) g + b."""
    g = GROWTH
    return ((1.0 + b - g) * g - b) / (g * g - 1.0)


def converters(b: float, i: float, until: str | None) -> list[Branch]:
    return diagram(
        converter(),
        "b",
        (1.0, 2.5),
        [i, 0.0],
        {"b": b},
        mode="on",
        until=until,
        events={"OC": "switch"},
        depth=2,
    )


@pytest.mark.drawn(1)
@pytest.mark.parametrize("continuously", [False, True])
def test_both_orbits_end_where_the_current_is_zero_at_the_tick(continuously) -> None:
    """The orbit that is empty for a while is stable, the other one is not; both live above the border."""
    found = converters(2.0, continuous(2.0) if continuously else 0.0, None)
    assert sorted(len(b.info.signature) for b in found) == [2, 3]
    for branch in found:
        empty = len(branch.info.signature) == 3
        assert branch["b"].min() == pytest.approx(BORDER, abs=100.0 * ACCURACY)
        assert branch["b"].max() == pytest.approx(2.5, abs=100.0 * ACCURACY)
        inside = ~branch["special"]
        assert (branch["unstable"][inside] == (0 if empty else 1)).all()
        assert branch["admissible"][inside].all()
    (point,) = [p for b in found for p in b.special_points if p.label == "OC"]
    assert_met(point, "b", BORDER)

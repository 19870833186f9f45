"""Contacts that are left where their force is zero and closed where their distance is, as of a body that is
thrown off what carries it and caught without a rebound.

At the release distance, speed and force are zero: the flight lasts in proportion to the third derivative of
the distance, and where the force only touches zero it lasts no time. The forces are closed forms.
"""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from hybrid_runs import ACCURACY, assert_met, branch_of, diagram, machine

from contwalk.branch import Branch
from contwalk.system import Mode, System, Transition

PERIOD = 2.0 * math.pi
G, DAMPING, STIFFNESS = 1.0, 0.2, 3.0
SWITCHES = {"OC": "switch", "GR": "switch"}


# -- a block on a table that is shaken through a spring: q'' = F sin t - c q' - k q ---------------------


def block_on_a_table() -> System:
    """Of the block the distance from the table and its rate; it is light, and the table does not feel it."""

    def push(t, x, p):
        return p.F * math.sin(t) - DAMPING * x[3] - STIFFNESS * x[2]

    def rides(t, x, p, dx):
        dx[2] = x[3]
        dx[3] = push(t, x, p)

    def flies(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -G - push(t, x, p)
        dx[2] = x[3]
        dx[3] = push(t, x, p)

    def force(t, x, p):
        return G + push(t, x, p)

    def distance(t, x, p):
        return x[0]

    def leaves(t, x, p, after):
        after[0] = 0.0 * x[2]
        after[1] = 0.0 * x[2]
        after[2] = x[2]
        after[3] = x[3]

    def lands(t, x, p, after):
        after[2] = x[2]
        after[3] = x[3]

    return machine(
        ["z", "v", "q", "r"],
        {"F": 3.0},
        [Mode("rides", rides, states=("q", "r")), Mode("flies", flies)],
        [
            Transition("leaves", "rides", "flies", force, "falling", reset=leaves, level=True),
            Transition("lands", "flies", "rides", distance, reset=lands),
        ],
        period=lambda p: PERIOD,
    )


THROWN = G * math.hypot(STIFFNESS - 1.0, DAMPING)


def thrown(start: float) -> list[Branch]:
    return diagram(
        block_on_a_table(), "F", (1.5, 2.6), [0.0, 0.0, 0.0, 0.0], {"F": start}, mode="rides",
        until="settled", events=SWITCHES, depth=3,
    )  # fmt: skip


@pytest.mark.drawn(1)
@pytest.mark.parametrize("start", [1.7, 2.4])
def test_a_block_is_thrown_off_its_table(start) -> None:
    """From either side: the flights begin, or cease, where the table's acceleration is that of gravity."""
    found = thrown(start)
    assert sorted(b.info.signature for b in found) == [(), ("leaves", "lands")]
    for branch in found:
        rides = not branch.info.signature
        assert branch["F"].min() == pytest.approx(1.5 if rides else THROWN, abs=1e2 * ACCURACY)
        assert branch["F"].max() == pytest.approx(THROWN if rides else 2.6, abs=1e2 * ACCURACY)
        assert np.all(branch["admissible"][~branch["special"]])
        for point in branch.special_points:
            if point.label != "EP":
                assert_met(point, "F", THROWN)


# -- a block on a table that accelerates as a (cos 2t + 0.05 cos t): it is thrown once or twice a period ---


def block_thrown_twice() -> System:
    def push(t, p):
        return p.a * (math.cos(2.0 * t) + 0.05 * math.cos(t))

    def rides(t, x, p, dx):
        dx[0] = 0.0 * x[0]

    def flies(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = push(t, p) - G

    def force(t, x, p):
        return G - push(t, p)

    def distance(t, x, p):
        return x[0]

    def leaves(t, x, p, after):
        after[0] = x[0]
        after[1] = 0.0 * x[0]

    def lands(t, x, p, after):
        after[0] = 0.0 * x[0]

    return machine(
        ["z", "v"],
        {"a": 1.2},
        [Mode("rides", rides, states=("z",)), Mode("flies", flies)],
        [
            Transition("leaves", "rides", "flies", force, "falling", reset=leaves, level=True),
            Transition("lands", "flies", "rides", distance, reset=lands),
        ],
        period=lambda p: PERIOD,
    )


@pytest.mark.long
def test_one_of_two_flights_ceases() -> None:
    """The smaller hump, cos 2t + 0.05 cos t at t = pi, is 0.95 high."""
    found = diagram(
        block_thrown_twice(), "a", (1.0, 1.2), [0.0, 0.0], {"a": 1.15}, mode="rides", until="settled",
        events=SWITCHES, depth=3,
    )  # fmt: skip
    assert [len(b.info.signature) for b in found] == [4, 2]
    assert found[0]["a"].min() == pytest.approx(1.0 / 0.95, abs=1e2 * ACCURACY)
    assert found[1]["a"].max() == pytest.approx(1.0 / 0.95, abs=1e2 * ACCURACY)
    assert found[1]["a"].min() == pytest.approx(1.0, abs=ACCURACY)
    (point,) = [p for p in found[0].special_points if p.label != "EP"]
    assert_met(point, "a", 1.0 / 0.95)


# -- a follower on a cam: y'' = -k y - g - b y' in the air, y = e cos(w t) on the cam --------------------

SPRING, LOSS = 0.3, 0.1


def follower() -> System:
    def cam(t, p):
        return math.cos(p.w * t)

    def rate(t, p):
        return -p.w * math.sin(p.w * t)

    def rides(t, x, p, dx):
        dx[0] = rate(t, p) + 0.0 * x[0]

    def lifted(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -SPRING * x[0] - G - LOSS * x[1]

    def gap(t, x, p):
        return x[0] - cam(t, p)

    def force(t, x, p):
        return -p.w * p.w * cam(t, p) + LOSS * rate(t, p) + SPRING * cam(t, p) + G

    def lands(t, x, p, after):
        after[0] = cam(t, p)

    def lifts(t, x, p, after):
        after[0] = cam(t, p)
        after[1] = rate(t, p)

    return machine(
        ["y", "v"],
        {"w": 1.5},
        [Mode("rides", rides, states=("y",)), Mode("lifted", lifted)],
        [
            Transition("leaves", "rides", "lifted", force, "falling", reset=lifts, level=True),
            Transition("strikes", "lifted", "rides", gap, reset=lands),
        ],
        period=lambda p: 2.0 * math.pi / p.w,
    )


# (w^2 - k)^2 + (b w)^2 = g^2
LIFTED = math.sqrt(
    0.5 * (2.0 * SPRING - LOSS**2 + math.sqrt((2.0 * SPRING - LOSS**2) ** 2 - 4.0 * (SPRING**2 - G**2)))
)


def test_a_follower_that_stays_on_its_cam() -> None:
    """On the cam the mode only keeps the follower's height: no branch of such orbits, and why, is told."""
    branch = branch_of(
        follower(), "w", (0.8, 1.6), [1.0, 0.0], {"w": 1.5}, mode="rides", until="settled", events=SWITCHES,
        direction="down",
    )  # fmt: skip
    (point,) = [p for p in branch.special_points if p.label != "EP"]
    assert point.label == "OC"
    assert_met(point, "w", LIFTED)
    # Orbits right beside the point are not found: up to where its other points were looked for is told.
    told = re.search(r"PD, NS were not looked for between w = ([0-9.]+) and here", point.note)
    assert told is not None, point.note
    assert LIFTED < float(told[1]) < LIFTED + 0.3 * (1.5 - LIFTED)
    end = branch.special_points[-1]
    assert end.kind == "order_change"
    assert "no branch to follow" in end.note
    assert branch["w"].min() == pytest.approx(LIFTED, abs=1e2 * ACCURACY)

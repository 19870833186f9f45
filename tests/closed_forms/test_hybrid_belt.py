"""A block on a belt: it sticks between two limits of the spring's force, and slips with smaller friction.

x' = V while it sticks. Slower than the belt x'' = f - x, faster x'' = -g - x. It slips back at x = s and
sticks again at 2 f - s. Where that is below -r it cannot be held: it runs ahead of the belt at once, and
sticks again at s - 2 (f + g). Since r > g it runs ahead for a finite time from the beginning: where
s = 2 f + r the motion jumps to an orbit of another signature.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from hybrid_runs import ACCURACY, assert_met, diagram, machine

from contwalk.branch import Branch
from contwalk.system import System, Transition

F, G, R, V = 0.4, 0.3, 0.5, 1.0
JUMPS = 2.0 * F + R
WALKED = 100.0 * ACCURACY


def belt() -> System:
    def held(t, x, p, dx):
        dx[0] = V
        dx[1] = 0.0 * x[1]

    def slower(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = F - x[0]

    def faster(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -G - x[0]

    def speed(t, x, p):
        return x[1] - V

    return machine(
        ["x", "v"],
        {"s": 1.0},
        {"stick": held, "back": slower, "ahead": faster},
        [
            Transition("slips", "stick", "back", lambda t, x, p: x[0] - p.s, "rising", level=True),
            Transition("runs", "stick", "ahead", lambda t, x, p: x[0] + R, "falling", level=True),
            Transition("sticks", "back", "stick", speed, "rising"),
            Transition("catches", "ahead", "stick", speed, "falling"),
        ],
    )


def period(s: float, runs: bool) -> float:
    slips = math.pi + 2.0 * math.atan(V / (s - F))
    at = 2.0 * F - s
    if not runs:
        return slips + (s - at) / V
    ahead, at_last = math.pi - 2.0 * math.atan(V / -(at + G)), -2.0 * G - at
    return slips + ahead + (s - at_last) / V


@pytest.mark.drawn(1)
@pytest.mark.parametrize("start", [1.0, 1.8])
def test_where_a_block_cannot_be_held_it_goes_on_in_another_order(start) -> None:
    found: list[Branch] = diagram(
        belt(), "s", (0.6, 2.5), [0.0, V], {"s": start}, mode="stick", until="settled",
        events={"OC": "switch"}, depth=3,
    )  # fmt: skip
    assert len(found) == 2
    for branch in found:
        runs = "runs" in branch.info.signature
        assert branch["s"].min() == pytest.approx(JUMPS if runs else 0.6, abs=WALKED)
        assert branch["s"].max() == pytest.approx(2.5 if runs else JUMPS, abs=WALKED)
        rows = branch.points[~branch["special"]]
        assert np.all(rows["admissible"])
        for row in rows:
            assert float(row["period"]) == pytest.approx(period(float(row["free"][0]), runs), abs=WALKED)
        assert {p.label for p in branch.special_points} == {"OC", "EP"}
        assert_met(next(p for p in branch.special_points if p.label == "OC"), "s", JUMPS)
    assert {"runs" in branch.info.signature for branch in found} == {True, False}

"""A stone that is tossed anew at each tick, under a ceiling above which it weighs more: the field jumps.

It flies x(t) = v t - t^2/2 for a time T, and above x = 1 it falls with 1 + pre. Its speed is kept there, and
with the speed w = sqrt(v^2 - 2) of its passage it comes back earlier than it would, by 2 w - 2 w / (1 + pre).
The next toss has the speed v = s + c x, x being where it is at the tick.
"""

from __future__ import annotations

import math
from functools import cache

import mpmath
import numpy as np
import pytest
from hybrid_runs import ACCURACY, assert_met, diagram, machine

from contwalk.branch import Branch
from contwalk.system import System, Transition

T, PRE, LOWEST = 4.0, 0.5, 1.0


def stone() -> System:
    def below(t, x, p, dx):
        dx[0], dx[1] = x[1], -1.0

    def above(t, x, p, dx):
        dx[0], dx[1] = x[1], -1.0 - PRE

    def ceiling(t, x, p):
        return x[0] - 1.0

    def tick(t, x, p):
        return np.sin(2.0 * math.pi * t / T)

    def toss(t, x, p, after):
        after[0], after[1] = 0.0, p.s + p.c * x[0]

    return machine(
        ["x", "v"],
        {"s": 1.3, "c": 0.05},
        {"below": below, "above": above},
        [
            Transition("rises", "below", "above", ceiling, "rising"),
            Transition("falls", "above", "below", ceiling),
            Transition("tick", "below", "below", tick, "rising", reset=toss),
        ],
        period=lambda p: T,
    )


@cache
def tossed(c: float) -> list[Branch]:
    return diagram(
        stone(), "s", (LOWEST, 1.8), [0.0, 1.4], {"s": 1.4, "c": c}, mode="below", until="settled",
        events={"GR": "switch"}, follow=("PD",), depth=3,
    )  # fmt: skip


def drive(w: mpmath.mpf, c: float) -> mpmath.mpf:
    """The s at which the stone passes the ceiling with a speed w."""
    v, lasts = mpmath.sqrt(2 + w * w), T + 2 * w * (1 - 1 / (1 + mpmath.mpf(PRE)))
    return v - c * (v * lasts - lasts**2 / 2)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("c", [0.05, -0.05])
def test_orbits_below_the_ceiling_and_above_it_meet_where_it_is_touched(c) -> None:
    """On one side, or with a fold: then both lie on the same side of it."""
    found = tossed(c)
    touched = float(drive(mpmath.mpf(0), c))
    ways = {branch.info.signature: branch for branch in found}
    below = ways[("tick",)]
    assert below["s"].min() == pytest.approx(LOWEST, abs=ACCURACY)
    assert below["s"].max() == pytest.approx(touched, abs=ACCURACY)
    assert sum(len(signature) == 3 for signature in ways) == 1
    grazings = [
        p for b in (below, *found) if len(b.info.signature) < 4 for p in b.special_points if p.label == "GR"
    ]
    assert grazings
    for point in grazings:
        assert_met(point, "s", touched)
    assert not [p.name for b in found for p in b.special_points if p.status != "located"]


def test_the_fold_of_orbits_above_the_ceiling() -> None:
    (above,) = [branch for branch in tossed(-0.05) if len(branch.info.signature) == 3]
    (fold,) = [p for p in above.special_points if p.label == "LP"]
    w = mpmath.findroot(lambda w: mpmath.diff(lambda u: drive(u, -0.05), w), 0.1)
    assert_met(fold, "s", float(drive(w, -0.05)))


def test_a_visit_that_begins_is_followed_from_the_touch_itself() -> None:
    """Visits of no time solve the equations as well wherever they pass the ceiling: no branch is theirs."""
    found = tossed(0.05)
    (below,) = [branch for branch in found if branch.info.signature == ("tick",)]
    assert "The orbits with signature [tick rises falls] leave there" in below.outcome.message
    assert {p.label for b in found for p in b.special_points} <= {"GR", "PD", "EP"}


@pytest.mark.long
def test_where_every_other_passage_ceases_is_known_as_other_points_are() -> None:
    """One of two passages vanishes: its guard has a double root, which equations of the orbit tell badly."""
    c, least = mpmath.mpf("0.05"), mpmath.sqrt(2)

    touching = least * T - mpmath.mpf(T) ** 2 / 2

    def where(v):
        lasts = T + 2 * mpmath.sqrt(v * v - 2) * (1 - 1 / (1 + mpmath.mpf(PRE)))
        return v * lasts - lasts**2 / 2

    s = mpmath.findroot(lambda s: s + c * where(s + c * touching) - least, (1.54, 1.55), solver="anderson")
    (doubled,) = [
        b for b in tossed(0.05) if sorted(b.info.signature) == sorted(("tick", "rises", "falls") * 2)
    ]
    (point,) = [p for p in doubled.special_points if p.label == "GR"]
    assert_met(point, "s", float(s))

"""Modes that are visited for a while, and not any more: a relay that leaves its sliding mode twice a period,
and a block that comes to rest between two pushes in the same direction.

Where a visit begins or ceases the events at both its ends are one, at which a guard turns: the visit lasts as
the root of the distance to that point. Nobody has declared the symmetry by which visits come in pairs.
"""

from __future__ import annotations

import math
from functools import cache

import mpmath
import numpy as np
import pytest
from hybrid_runs import ACCURACY, assert_met, diagram, machine

from contwalk.branch import Branch
from contwalk.system import Conserved, System, Transition

WALKED = 100.0 * ACCURACY
PERIOD = 2.0 * math.pi


def unlocated(branches: list[Branch]) -> list[str]:
    return [p.name for b in branches for p in b.special_points if p.status != "located"]


# -- x' = -x + sin t + b - u sign x: it slides on x = 0 while |sin t + b| < u --


def relay() -> System:
    def push(t, p):
        return math.sin(t) + p.b

    def above(t, x, p, dx):
        dx[0] = -x[0] + push(t, p) - p.u

    def below(t, x, p, dx):
        dx[0] = -x[0] + push(t, p) + p.u

    def slides(t, x, p, dx):
        dx[0] = 0.0 * x[0]

    def position(t, x, p):
        return x[0]

    def too_high(t, x, p):
        return push(t, p) - p.u

    def too_low(t, x, p):
        return push(t, p) + p.u

    return machine(
        ["x"],
        {"u": 0.7, "b": 0.1},
        {"slide": slides, "plus": above, "minus": below},
        [
            Transition("down", "plus", "slide", position),
            Transition("up", "minus", "slide", position, "rising"),
            Transition("leaves_up", "slide", "plus", too_high, "rising", level=True),
            Transition("leaves_down", "slide", "minus", too_low, "falling", level=True),
        ],
        period=lambda p: PERIOD,
    )


def relays(u: float, b: float, highest: float) -> list[Branch]:
    return diagram(
        relay(), "u", (0.5, highest), [0.0], {"u": u, "b": b}, mode="slide", until="settled",
        events={"OC": "switch", "GR": "switch"}, depth=4,
    )  # fmt: skip


@pytest.mark.drawn(1)
@pytest.mark.parametrize("start", [0.7, 1.0])
def test_a_relay_leaves_its_sliding_mode_less_often(start) -> None:
    """On the way down it does so while u < 1 - b, on the way up while u < 1 + b."""
    found = relays(start, 0.1, 1.5)
    assert not unlocated(found)
    assert sorted(len(b.info.signature) for b in found) == [2, 4]
    for branch in found:
        twice = len(branch.info.signature) == 4
        assert branch["u"].min() == pytest.approx(0.5 if twice else 0.9, abs=WALKED)
        assert branch["u"].max() == pytest.approx(0.9 if twice else 1.1, abs=WALKED)
        assert np.all(branch["admissible"][~branch["special"]])
        limits = [p for p in branch.special_points if p.label in ("GR", "OC")]
        for point in limits:
            assert_met(point, "u", min((0.9, 1.1), key=lambda u: abs(u - point.parameters["u"])))
        assert limits


def test_two_visits_that_vanish_together_are_both_told() -> None:
    found = relays(0.8, 0.0, 1.5)
    assert not unlocated(found)
    assert len(found) == 1
    (point,) = [p for p in found[0].special_points if p.label in ("GR", "OC")]
    assert_met(point, "u", 1.0)
    assert found[0]["u"].max() == pytest.approx(1.0, abs=WALKED)


# -- v' = F(t) - f sign v with F = sin t + 0.6 sin 3t, which has two humps each way --


def block() -> System:
    def push(t):
        return math.sin(t) + 0.6 * math.sin(3.0 * t)

    def up(t, x, p, dx):
        dx[0] = push(t) - p.f

    def down(t, x, p, dx):
        dx[0] = push(t) + p.f

    def rests(t, x, p, dx):
        dx[0] = 0.0 * x[0]

    def speed(t, x, p):
        return x[0]

    def stop(t, x, p, after):
        after[0] = 0.0 * x[0]

    def too_high(t, x, p):
        return push(t) - p.f

    def too_low(t, x, p):
        return push(t) + p.f

    return machine(
        ["v"],
        {"f": 0.7},
        {"rest": rests, "up": up, "down": down},
        [
            Transition("stops", "up", "rest", speed, reset=stop),
            Transition("halts", "down", "rest", speed, "rising", reset=stop),
            Transition("goes_up", "rest", "up", too_high, "rising", level=True),
            Transition("goes_down", "rest", "down", too_low, "falling", level=True),
        ],
        period=lambda p: PERIOD,
    )


@cache
def stops_between() -> float:
    """The friction at which the block comes to rest for an instant between the two humps."""

    def way(t):
        return -mpmath.cos(t) - mpmath.mpf("0.2") * mpmath.cos(3 * t)

    def push(t):
        return mpmath.sin(t) + mpmath.mpf("0.6") * mpmath.sin(3 * t)

    with mpmath.workdps(30):
        _, _, friction = mpmath.findroot(
            lambda a, b, f: [push(a) - f, push(b) - f, way(b) - way(a) - f * (b - a)], (0.25, 2.2, 0.75)
        )
        return float(friction)


@pytest.mark.long
@pytest.mark.parametrize("start", [0.74, 0.95])
def test_a_block_comes_to_rest_between_two_pushes(start) -> None:
    found = diagram(
        block(), "f", (0.72, 1.0), [0.0], {"f": start}, mode="rest", until="settled",
        events={"OC": "switch", "GR": "switch"}, depth=4,
    )  # fmt: skip
    assert not unlocated(found)
    assert {len(b.info.signature) for b in found} == {4, 8}
    for branch in found:
        often = len(branch.info.signature) == 8
        assert branch["f"].min() == pytest.approx(stops_between() if often else 0.72, abs=WALKED)
        assert branch["f"].max() == pytest.approx(1.0 if often else stops_between(), abs=WALKED)
        for point in branch.special_points:
            if point.label != "EP":
                assert_met(point, "f", stops_between())
        assert np.all(branch["admissible"][~branch["special"]])


# -- a hopper that waits for a second, and jumps with the speed u: it is in the air for 2 u --


def hopper() -> System:
    def flies(t, x, p, dx):
        dx[0], dx[1], dx[2] = x[1], -1.0, 0.0

    def waits(t, x, p, dx):
        dx[0], dx[1], dx[2] = 0.0, 0.0, 1.0

    def lands(t, x, p, after):
        after[0], after[1], after[2] = 0.0, 0.0, 0.0

    def jumps(t, x, p, after):
        after[0], after[1], after[2] = 0.0, p.u, 0.0

    return machine(
        ["y", "v", "clock"],
        {"u": 1.0},
        {"air": flies, "ground": waits},
        [
            Transition("lands", "air", "ground", lambda t, x, p: x[0], reset=lands),
            Transition("jumps", "ground", "air", lambda t, x, p: x[2] - 1.0, "rising", reset=jumps),
        ],
    )


def test_a_flight_that_ceases_has_no_rate_left_and_no_time():
    """Where both are zero the branch ends, and flights without length are no orbits beyond it."""
    state, mode = [1.0, 0.0, 0.0], {"mode": "air"}
    (branch,) = diagram(
        hopper(), "u", (-0.5, 2.0), state, events={"GR": "switch"}, follow=["GR"], until="settled", **mode
    )
    assert branch.outcome.reason == "grazing"
    np.testing.assert_allclose(branch["period"], 1.0 + 2.0 * branch["u"], rtol=0.0, atol=WALKED)
    point = next(p for p in branch.special_points if p.label == "GR")
    assert_met(point, "u", 0.0)


def spring_under_a_ball() -> System:
    def energy(stiffness):
        return lambda t, x, p: 0.5 * x[1] ** 2 + x[0] + 0.5 * stiffness * x[0] ** 2

    def flies(t, x, p, dx):
        dx[0], dx[1] = x[1], -1.0

    def rests(t, x, p, dx):
        dx[0], dx[1] = x[1], -1.0 - 4.0 * x[0]

    return machine(
        ["y", "v"],
        {"g": 1.0},
        {"air": flies, "spring": rests},
        [
            Transition("lands", "air", "spring", lambda t, x, p: x[0]),
            Transition("leaves", "spring", "air", lambda t, x, p: x[0], "rising"),
        ],
        conserved=(Conserved("energy", {"air": energy(0.0), "spring": energy(4.0)}),),
    )


@pytest.mark.long
def test_a_ball_that_does_not_leave_its_spring_any_more():
    """Below the energy 0 it swings on the spring, with half the period of 2 pi; above, it flies as well."""
    flying, swinging = diagram(
        spring_under_a_ball(),
        "energy",
        (-0.1, 2.0),
        [1.0, 0.0],
        {"energy": 1.0},
        mode="air",
        events={"GR": "switch"},
        follow=["GR"],
    )
    assert (flying.info.signature, swinging.info.signature) == (("lands", "leaves"), ())
    point = next(p for p in flying.special_points if p.label == "GR")
    # Rounding of the energies on the way, which are about 1.
    assert abs(point.parameters["energy"]) < 1e-14
    np.testing.assert_allclose(swinging["period"], math.pi, rtol=WALKED)
    assert swinging["energy"].min() == -0.1

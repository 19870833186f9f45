"""Guards that go on, after their own event, in the direction in which they have passed zero.

They are edges: what has just been passed happens again where the guard passes zero again, that is after it
has come back. What the event has stopped has not been passed, and neither has what turns round.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from hybrid_runs import ACCURACY, assert_met, branch_of, machine

from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import hybrid_machine, motion_segments
from contwalk.system import System, Transition

WALKED = 100.0 * ACCURACY


def moved(system: System, x0: list[float], t1: float, method: str, after: str | None = None) -> list:
    there, weights = hybrid_machine(system, system.defaults()), np.ones(len(x0))
    mode = system.modes[0].name
    return list(motion_segments(there, 0.0, np.array(x0), mode, t1, Control(1e-12, weights, method), after))


# -- a clock: x'' + 2 z x' + x = 0, and a push J where x rises through zero ----------------------------------

J, Z = 0.1, 0.02
W = math.sqrt(1.0 - Z * Z)
TURN = 2.0 * math.pi / W


def clock(level: bool = False) -> System:
    def swings(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -x[0] - 2.0 * Z * x[1]

    def push(t, x, p, after):
        after[0] = x[0]
        after[1] = x[1] + p.J

    tick = Transition("tick", "swing", "swing", lambda t, x, p: x[0], "rising", reset=push, level=level)
    return machine(["x", "v"], {"J": J}, {"swing": swings}, [tick])


@pytest.mark.parametrize("method", ["dop853", "radau5"])
def test_a_clock_ticks_once_a_turn(method):
    found = moved(clock(), [0.0, 1.0], 5.5 * TURN, method, "tick")
    ticks = [arc for arc in found if arc.transition is not None]
    assert [arc.transition for arc in ticks] == ["tick"] * 5
    # Local errors of 1e-12 a step, some ten steps a turn.
    np.testing.assert_allclose([arc.times[-1] for arc in ticks], TURN * np.arange(1, 6), rtol=0, atol=1e-9)
    speed = 1.0
    for arc in ticks:
        speed = speed * math.exp(-Z * TURN) + J
        assert arc.after[1] == pytest.approx(speed, abs=1e-9)


def test_the_orbits_of_a_clock_are_those_in_closed_form():
    found = branch_of(clock(), "J", (0.05, 0.2), [-0.5, 0.0], until="settled")
    assert found.info.signature == ("tick",)
    kept = math.exp(-Z * TURN)
    for row in found.points[~found["special"]]:
        assert row["admissible"]
        assert float(row["period"]) == pytest.approx(TURN, abs=WALKED)
        assert float(row["unknowns"][1]) == pytest.approx(float(row["free"][0]) / (1.0 - kept), abs=WALKED)
        assert row["spectrum"][0] == pytest.approx(kept, abs=WALKED)
    assert [(p.label, p.kind) for p in found.special_points] == [("EP", "bound"), ("EP", "bound")]


def test_declared_a_level_it_does_not_go_on():
    (last,) = moved(clock(level=True), [0.0, 1.0], 1.0, "dop853", "tick")
    assert last.status == "sticking"


# -- what comes up to zero and turns is no event, and where it does so is a grazing --------------------------


def counter() -> System:
    """x = s (1 - s) (3 - s) ((s - 2)^2 + k) since its last event: it rises through zero where s = 3 again.

    With k < 0 it does so at s = 2 - sqrt(-k).
    """

    def counts(t, x, p, dx):
        s = x[1]
        cubic, slope = s * (1.0 - s) * (3.0 - s), 3.0 - 8.0 * s + 3.0 * s * s
        dx[0] = slope * ((s - 2.0) ** 2 + p.k) + 2.0 * cubic * (s - 2.0)
        dx[1] = 1.0

    def again(t, x, p, after):
        after[0] = x[0]
        after[1] = 0.0 * x[1]

    tick = Transition("tick", "on", "on", lambda t, x, p: x[0], "rising", reset=again)
    return machine(["x", "s"], {"k": 0.5}, {"on": counts}, [tick])


@pytest.mark.parametrize("k", [0.5, -0.3])
def test_a_passed_guard_that_nearly_comes_back_grazes(k):
    found = branch_of(
        counter(), "k", (-0.6, 0.8), [0.0, 0.0], {"k": k}, until="settled", events={"GR": "stop"}
    )
    (point,) = [p for p in found.special_points if p.label == "GR"]
    assert (point.kind, found.info.signature) == ("terminal", ("tick",))
    assert_met(point, "k", 0.0)
    rows = found.points[~found["special"]]
    assert np.all(rows["admissible"])
    for row in rows:
        here = float(row["free"][0])
        assert here * k > -WALKED
        lasts = 3.0 if k > 0.0 else 2.0 - math.sqrt(max(-here, 0.0))
        # Where it grazes the instant is known to the root of what the guard is known to.
        assert float(row["period"]) == pytest.approx(lasts, abs=WALKED / max(abs(here), 1e-3))


# -- what the event has stopped, and what turns round --------------------------------------------------------


def test_a_guard_without_rate_after_its_event_has_not_been_passed():
    """A ball that does not rebound lies on the floor, and does not fall through it."""

    def falls(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -10.0

    def lands(t, x, p, after):
        after[0] = x[0]
        after[1] = 0.0 * x[1]

    impact = Transition("impact", "flight", "flight", lambda t, x, p: x[0], reset=lands)
    (last,) = moved(machine(["y", "v"], {}, {"flight": falls}, [impact]), [1.0, 0.0], 2.0, "dop853")
    assert last.status == "sticking"
    assert last.times[-1] == pytest.approx(math.sqrt(0.2), abs=1e-12)


def test_the_reverse_of_an_event_happens_where_the_guard_turns_round():
    """x' = 1 below zero, -1 above: a relay that would slide. It must not go on along x' = -1 below."""

    def up(t, x, p, dx):
        dx[0] = 1.0

    def down(t, x, p, dx):
        dx[0] = -1.0

    def guard(t, x, p):
        return x[0]

    system = machine(
        ["x"],
        {},
        {"below": up, "above": down},
        [Transition("over", "below", "above", guard, "rising"), Transition("under", "above", "below", guard)],
    )
    found = moved(system, [-1.0], 2.0, "dop853")
    assert found[-1].status == "sticking"
    assert found[-1].times[-1] == pytest.approx(1.0, abs=1e-12)

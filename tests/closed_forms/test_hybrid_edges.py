"""A hopper that takes off below the height at which it touches down: guards are events where they fall
through zero, not where they are below it.

It leaves the ground at y = -d with speed u = e v + k, v: that at touchdown, y = 0. So v^2 = u^2 - 2 g d, and
k(u) = u - e v has a fold where v = e u. The flight lasts (u + v) / g, the stance d / c.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from hybrid_runs import ACCURACY, assert_met, diagram, machine

from contwalk.branch import Branch
from contwalk.system import System, Transition

G, D, C, E = 10.0, 0.05, 1.0, 0.5
# The walk asks for a hundredth of the accuracy of special points.
WALKED = 100.0 * ACCURACY


def kick(u: float) -> float:
    """The parameter of the orbit that takes off with a speed."""
    return u - E * math.sqrt(u * u - 2.0 * G * D)


def hopper(sensor: float | None = None) -> System:
    """With a sensor, it falls over where it falls through that height."""

    def fly(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -G

    def stand(t, x, p, dx):
        dx[0] = -C
        dx[1] = 0.0 * x[1]

    def push(t, x, p, after):
        after[0] = x[0]
        after[1] = -E * x[1] + p.k

    transitions = [
        Transition("touchdown", "flight", "stance", lambda t, x, p: x[0]),
        Transition("takeoff", "stance", "flight", lambda t, x, p: x[0] + D, reset=push),
    ]
    if sensor is not None:
        transitions.append(Transition("seen", "flight", "stance", lambda t, x, p: x[0] - sensor))
    return machine(["y", "v"], {"k": 2.0}, {"flight": fly, "stance": stand}, transitions)


def branch(u: float, sensor: float | None = None) -> Branch:
    """The branch from an orbit that takes off with about this speed."""
    (found,) = diagram(
        hopper(sensor), "k", (0.8, 3.0), [0.0, -1.0], {"k": kick(u)}, mode="flight", until="settled",
        events={"GR": "stop", "OC": "stop"},
    )  # fmt: skip
    return found


def test_a_guard_that_is_below_zero_where_its_mode_is_entered_is_no_event() -> None:
    found = branch(2.0)
    assert found.info.signature == ("takeoff", "touchdown") or found.info.signature == (
        "touchdown",
        "takeoff",
    )
    rows = found.points[~found["special"]]
    # Of the unknowns the states at the starts of the legs: the flight's one is faster.
    names = {p.label: p for p in found.special_points}
    for row in rows:
        u = float(np.max(row["unknowns"][[1, 3]]))
        assert float(row["free"][0]) == pytest.approx(kick(u), abs=WALKED)
        lasts = D / C + (u + math.sqrt(u * u - 2.0 * G * D)) / G
        assert float(row["period"]) == pytest.approx(lasts, abs=WALKED)
    assert np.all(rows["admissible"])
    assert_met(names["LP"], "k", math.sqrt(2.0 * G * D * (1.0 - E * E)))
    assert_met(names["GR"], "k", math.sqrt(2.0 * G * D))
    assert names["GR"].kind == "terminal"
    assert {p.kind for p in found.special_points if p.label == "EP"} == {"bound", "grazing"}


@pytest.mark.parametrize("sensor", [0.05, 0.2])
def test_a_guard_that_comes_up_to_zero_from_below_is_a_grazing(sensor) -> None:
    """Above the speed that carries it to the sensor it is seen on its way down."""
    reaches = math.sqrt(2.0 * G * (sensor + D))
    found = branch(0.97 * reaches, sensor)
    (point,) = [p for p in found.special_points if p.label == "GR" and p.kind == "interior"]
    assert_met(point, "k", kick(reaches))
    assert "'seen' is touched" in str(point.note)
    rows = found.points[~found["special"]]
    speeds = np.max(rows["unknowns"][:, [1, 3]], axis=1)
    assert np.all(speeds <= reaches + WALKED)
    assert np.all(rows["admissible"])
    for row, u in zip(rows, speeds.tolist(), strict=True):
        assert float(row["free"][0]) == pytest.approx(kick(u), abs=WALKED)

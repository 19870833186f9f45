"""A Jeffcott rotor that rubs on a ring: a doubled orbit comes back to its parent where both differ by
little at the phase that they are compared at, and where corrections do not contract.
"""

from __future__ import annotations

import math

import pytest
from hybrid_runs import diagram

from contwalk.system import Mode, Parameter, State, System, Transition

X, Y, U, V = range(4)
SETTLED = [0.8854150564, -0.5696071915, 0.7329273599, 1.2418402115]  # nearly, at w = 1.27413


def rotor() -> System:
    def free(t, x, p, dx):
        dx[X], dx[Y] = x[U], x[V]
        dx[U] = -2.0 * p.z * x[U] - x[X] + p.e * p.w**2 * math.cos(p.w * t)
        dx[V] = -2.0 * p.z * x[V] - x[Y] + p.e * p.w**2 * math.sin(p.w * t) - p.g

    def rub(t, x, p, dx):
        pressed = p.k * (1.0 - 1.0 / math.sqrt(x[X] ** 2 + x[Y] ** 2))
        dx[X], dx[Y] = x[U], x[V]
        forced = p.e * p.w**2
        dx[U] = -2.0 * p.z * x[U] - x[X] + forced * math.cos(p.w * t) - pressed * (x[X] - p.mu * x[Y])
        dx[V] = -2.0 * p.z * x[V] - x[Y] + forced * math.sin(p.w * t) - p.g - pressed * (p.mu * x[X] + x[Y])

    def gap(t, x, p):
        return x[X] ** 2 + x[Y] ** 2 - 1.0

    values = {"z": 0.1, "e": 0.3, "k": 30.0, "mu": 0.05, "g": 0.4, "w": 1.27413}
    return System(
        name="rotor",
        states=tuple(State(name) for name in ("x", "y", "u", "v")),
        parameters=tuple(Parameter(name, value) for name, value in values.items()),
        modes=(Mode("free", free), Mode("rub", rub)),
        transitions=(
            Transition("touch", "free", "rub", gap, "rising", role="soft"),
            Transition("leave", "rub", "free", gap, "falling", role="soft"),
        ),
        period=lambda p: 2.0 * math.pi / p.w,
    )


@pytest.mark.slow
def test_the_doubled_orbit_joins_two_doublings() -> None:
    given = (rotor(), "w", (1.2735, 1.283), SETTLED)
    parent, doubled = diagram(*given, until="settled", follow=["PD"], max_points=150, direction="up")
    first, second = (point for point in parent.special_points if point.label == "PD")
    assert (first.criticality, second.criticality) == ("supercritical", "supercritical")
    assert doubled.outcome.reason == "rejoined", doubled.outcome.message
    (back,) = (point for point in doubled.special_points if point.label == "BP")
    assert abs(back.parameters["w"] - second.parameters["w"]) <= back.error + second.error
    folds = [point.parameters["w"] for point in doubled.special_points if point.label == "LP"]
    assert len(folds) == 2
    assert min(folds) < second.parameters["w"] < max(folds)

"""A resonance whose peak just reaches a stop: grazings on both sides of it, within one step."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hybrid_runs import diagram, machine
from small_systems import labelled

from contwalk.system import System, Transition

DAMPING, FORCE = 0.2, 0.1


def oscillator(gap: float) -> System:
    def free(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -2.0 * DAMPING * x[1] - x[0] + p.F * np.cos(p.w * t)

    def bounce(t, x, p, after):
        after[0], after[1] = x[0], -0.5 * x[1]

    hit = Transition("hit", "free", "free", lambda t, x, p: gap - x[0], reset=bounce)
    return machine(
        ["x", "v"], {"w": 0.7, "F": FORCE}, {"free": free}, [hit], period=lambda p: 2.0 * math.pi / p.w
    )


def grazings(gap: float) -> tuple[float, float]:
    """Where the amplitude F / |1 - w^2 + 2 i z w| is the gap."""
    middle = 1.0 - 2.0 * DAMPING**2
    half = math.sqrt(middle**2 - 1.0 + (FORCE / gap) ** 2)
    return math.sqrt(middle - half), math.sqrt(middle + half)


@pytest.mark.parametrize("part", [1e-3, 1e-6, 1e-9])
def test_a_peak_a_little_beyond_a_stop_grazes_it_twice(part):
    peak = FORCE / (2.0 * DAMPING * math.sqrt(1.0 - DAMPING**2))
    gap = peak * (1.0 - part)
    (branch,) = diagram(
        oscillator(gap),
        "w",
        (0.7, 1.5),
        [0.0, 0.0],
        {},
        until="settled",
        mode="free",
        events={"GR": "ignore"},
    )
    found = labelled(branch, "GR")
    assert [point.kind for point in found] == ["interior", "interior"]
    for point, expected in zip(found, grazings(gap), strict=True):
        assert abs(point.parameters["w"] - expected) <= 5.0 * point.error
        assert point.error < 1e-9 / math.sqrt(part)  # the gap's rounding over the rate of the amplitude there


@pytest.mark.parametrize("part", [1e-3, 1e-6])
def test_a_peak_a_little_before_it_grazes_nothing(part):
    peak = FORCE / (2.0 * DAMPING * math.sqrt(1.0 - DAMPING**2))
    (branch,) = diagram(
        oscillator(peak * (1.0 + part)), "w", (0.7, 1.5), [0.0, 0.0], {}, until="settled", mode="free"
    )
    assert labelled(branch, "GR") == []
    assert branch.points["admissible"].all()

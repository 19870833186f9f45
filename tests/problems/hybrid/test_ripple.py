"""Orbits whose states move little beside what they are, as the voltage of a converter does: coefficients of
normal forms are small in units of the ripple, and not zero.

x' = r, and at each tick u = x - 5 - r, zero on the orbit, becomes -lam u + k u^3: at lam = 1 the cubic
coefficient is k in units of x, k (r / 2)^2 in those of half the ripple.
"""

from __future__ import annotations

import math

import pytest
from hybrid_runs import branch_of, machine

from contwalk.system import System, Transition

RIPPLE = 2e-4


def rippling() -> System:
    def field(t, x, p, dx):
        dx[0] = RIPPLE + 0.0 * x[0]

    def tick(t, x, p):
        return math.sin(2.0 * math.pi * t)

    def step(t, x, p, after):
        u = x[0] - 5.0 - RIPPLE
        after[0] = 5.0 - p.lam * u + p.k * u**3

    return machine(
        ["x"],
        {"lam": 0.8, "k": 0.05},
        {"ripples": field},
        [Transition("tick", "ripples", "ripples", tick, "rising", reset=step)],
        period=lambda p: 1.0,
    )


@pytest.mark.drawn(1)
@pytest.mark.parametrize(("k", "told"), [(0.05, "supercritical"), (-0.05, "subcritical"), (0.0, None)])
def test_the_sign_of_a_coefficient_that_the_ripple_makes_small(k, told) -> None:
    branch = branch_of(rippling(), "lam", (0.5, 1.5), [5.0], {"k": k})
    (point,) = [p for p in branch.special_points if p.label == "PD"]
    assert point.parameters["lam"] == pytest.approx(1.0, abs=1e-9)
    assert point.criticality == told
    assert point.coefficients["c"] == pytest.approx(k * (0.5 * RIPPLE) ** 2, rel=1e-3, abs=1e-13)
    assert (point.note or "").startswith("degenerate") == (told is None)

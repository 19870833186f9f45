"""Special points of orbits at which the free parameter is zero: its size there is rounding, and no magnitude.

Two oscillators z' = (1 + i - (1 + 2 i) |z|^2) z + k (z_other - z) are uncoupled at k = 0, where their phases
may differ by anything. Opposite phases live on a circle of radius^2 1 - 2 k until k = 1/2.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hybrid_runs import assert_met, diagram, machine
from plugin_runs import run_text, write_plugin
from scipy.linalg import expm

from contwalk.system import System, Transition

W, Z, R = 1.3, 0.1, 0.8
TOUCHES = math.hypot(1.0 - W * W, 2.0 * Z * W)


def stopped() -> System:
    """A forced oscillator with a stop at 1; its force is counted from where it first touches that."""

    def free(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = (TOUCHES + p.d) * math.cos(W * t) - 2.0 * Z * x[1] - x[0]

    def bounce(t, x, p, after):
        after[0] = x[0]
        after[1] = -R * x[1]

    return machine(
        ["q", "v"],
        {"d": -0.6},
        {"free": free},
        [Transition("hit", "free", "free", lambda t, x, p: 1.0 - x[0], reset=bounce)],
        period=lambda p: 2.0 * math.pi / W,
    )


def fold_of_one_impact() -> float:
    """Least force of orbits with one impact a period.

    What impacts at speed v add to the forced motion closes up: y(T) - y(0) = (0, (1 + R) v). At the stop the
    forced motion's place is then 1 - alpha v, and its speed over W is beta v, up to its sign: the amplitude
    squared is quadratic in v.
    """
    turned = expm(np.array([[0.0, 1.0], [-1.0, -2.0 * Z]]) * 2.0 * math.pi / W)
    place, speed = (1.0 + R) * np.linalg.solve(turned - np.eye(2), [0.0, 1.0])
    return TOUCHES * (abs(speed + R) / W / math.hypot(place, (speed + R) / W) - 1.0)


def test_impacts_that_begin_at_zero_are_followed() -> None:
    quiet, hitting = diagram(
        stopped(), "d", (-0.7, 0.1), [0.0, 0.0], until="settled", events={"GR": "switch"}, depth=1
    )
    (touch,) = [p for p in quiet.special_points if p.label == "GR"]
    assert_met(touch, "d", 0.0)
    (fold,) = [p for p in hitting.special_points if p.label == "LP"]
    assert_met(fold, "d", fold_of_one_impact())
    assert hitting["d"].max() == 0.1


CELLS = """
for i in (0, 2):
    j = 2 - i
    r = x[i] ** 2 + x[i + 1] ** 2
    dx[i] = x[i] - x[i + 1] - r * (x[i] + 2.0 * x[i + 1]) + p.k * (x[j] - x[i])
    dx[i + 1] = x[i + 1] + x[i] - r * (x[i + 1] - 2.0 * x[i]) + p.k * (x[j + 1] - x[i + 1])
"""


def test_families_that_cross_at_zero_lead_to_each_other(tmp_path: Path) -> None:
    write_plugin(tmp_path, CELLS, "abcd", k=0.2)
    result = run_text(
        tmp_path,
        "start: {simulate: {state: {a: 0.9, b: 0.1, c: 1.0, d: 0.0}, until: settled}}\n"
        "continue: {parameter: k, range: [-0.4, 1.0]}\ndiagram: {depth: 2}\n",
    )
    _, phases, opposite = result.branches
    assert phases.outcome.reason == "closed"
    np.testing.assert_allclose(phases["k"], 0.0, atol=1e-7)  # what rows are known to
    assert opposite["k"].min() == -0.4
    assert opposite.outcome.reason in ("bound", "shrunk")
    # Its last orbit is a little before its Hopf point.
    assert opposite["k"].max() == pytest.approx(0.5, abs=1e-6)
    (other,) = [p for p in opposite.special_points if p.label == "BP"]
    # Amplitudes that differ leave where (1 - 2 k) / k = 1.
    assert abs(other.parameters["k"] - 1.0 / 3.0) <= other.error

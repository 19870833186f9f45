"""A curve of grazings with a cusp, known in closed form.

x follows w + sin t + b sin 2t exactly. Its falls through zero are watched for from a quarter of a period
before t = 0 on, where x is below zero already. A touch at t = s has b = -cos s / (2 cos 2s) and
w = -sin s - b sin 2s; at s = 0 its second rate vanishes, with b = -1/2 and w = 0.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from hybrid_runs import diagram, machine

import contwalk as cw
from contwalk.branch import Branch
from contwalk.system import Transition


def followed(t, x, p, dx):
    target = p.w + np.sin(t) + p.b * np.sin(2.0 * t)
    dx[0] = np.cos(t) + 2.0 * p.b * np.cos(2.0 * t) - (x[0] - target)


SYSTEM = machine(
    ["x"],
    {"w": 0.2, "b": -0.6},
    {"blind": followed, "watching": followed},
    [
        Transition("fall", "watching", "blind", lambda t, x, p: x[0]),
        Transition("begin", "blind", "watching", lambda t, x, p: -np.cos(t)),
    ],
    period=lambda p: 2.0 * math.pi,
)


RANGES = {"b": (-0.62, -0.4), "w": (-0.3, 0.3)}


def touching(b: np.ndarray) -> np.ndarray:
    """w at which x touches zero from above; from below it does at -w."""
    cosine = -(1.0 + np.sqrt(1.0 + 32.0 * b**2)) / (8.0 * b)
    sine = np.sqrt(np.maximum(1.0 - cosine**2, 0.0))
    return np.asarray(-sine * (1.0 + 2.0 * b * cosine))


@cache
def branch() -> Branch:
    """Orbits as w varies down to the touch."""
    return diagram(SYSTEM, "w", (0.01, 0.3), [0.1], until="settled", mode="blind")[0]


@pytest.mark.drawn(1)
@pytest.mark.slow
@pytest.mark.parametrize("order", [("b", "w"), ("w", "b")])
def test_a_curve_of_grazings_turns_in_a_cusp(order: tuple[str, str]) -> None:
    (point,) = [p for p in branch().special_points if p.label == "GR"]
    assert abs(point.parameters["w"] - touching(np.array(-0.6))) <= point.error
    ranges = {name: RANGES[name] for name in order}
    curve = cw.continue_locus(SYSTEM, branch(), point.name, ranges, max_step=0.4)
    assert curve.info.settings["limit"]["test"] == "dip"
    assert curve.outcome.status == "complete"
    (cusp,) = [p for p in curve.special_points if p.label != "EP"]
    assert (cusp.label, cusp.status) == ("GRD", "located")
    assert abs(cusp.parameters["b"] + 0.5) <= cusp.errors["b"] < 1e-9
    assert abs(cusp.parameters["w"]) <= cusp.errors["w"] < 1e-9
    np.testing.assert_allclose(np.abs(curve["w"]), touching(curve["b"]), rtol=0.0, atol=1e-7)
    assert (curve["w"][0] > 0.0) != (curve["w"][-1] > 0.0)

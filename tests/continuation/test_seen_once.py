"""A point that cannot be located is told once, however often its test changes sign on errors alone."""

from __future__ import annotations

import hashlib
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hybrid_runs import branch_of
from small_systems import small_system

from contwalk.problems.orbit import augmented
from contwalk.problems.orbit.orbit_equations import OrbitEquations

NOISE = 1e-8


def half_turn(t, x, p, dx):
    """Round a circle of radius 2: what is beside it makes half a turn a period. It doubles at a = 0.5."""
    u, v = x[0] - 2.0 * math.cos(t), x[1] - 2.0 * math.sin(t)
    cos, sin = math.cos(0.5 * t), math.sin(0.5 * t)
    first, second = cos * u + sin * v, cos * v - sin * u
    rate = (p.a - 0.5) * first - first * (first * first + second * second)
    dx[0] = cos * rate + sin * second - 0.5 * v - 2.0 * math.sin(t)
    dx[1] = sin * rate - cos * second + 0.5 * u + 2.0 * math.cos(t)


@pytest.mark.slow
def test_noise_makes_one_doubling_of_one(monkeypatch, tmp_path):
    """Multipliers with noise that hangs on every bit of the orbit, and a doubling that no steps locate."""
    exact = OrbitEquations.multipliers

    def noisy(self: Any, z: np.ndarray, jacobian: np.ndarray) -> Any:
        found = exact(self, z, jacobian)
        number = int.from_bytes(hashlib.sha256(z.tobytes()).digest()[:4], "big")
        return replace(found, values=found.values * (1.0 + NOISE * (number / 2.0**31 - 1.0)))

    monkeypatch.setattr(OrbitEquations, "multipliers", noisy)
    monkeypatch.setattr(augmented, "_refined", lambda *given: None)
    system = small_system(half_turn, "xy", {"a": 0.4}, period=lambda p: 2.0 * math.pi)
    branch = branch_of(system, "a", (0.4, 0.6), [2.0, 0.0], until="settled", accuracy=1e-6)
    assert [point.label for point in branch.special_points] == ["EP", "PD", "EP"]
    doubling = branch.special_points[1]
    assert (doubling.status, doubling.unstable_before, doubling.unstable_after) == ("unlocated", 0, 1)
    assert abs(doubling.parameters["a"] - 0.5) < NOISE

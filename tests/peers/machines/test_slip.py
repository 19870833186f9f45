"""The spring-mass runner against SciPy: the map from apex to apex, its slope by variational equations."""

from __future__ import annotations

import math

import numpy as np
import pytest
from peers.machines.slip import PEER
from scipy.integrate import solve_ivp

# Heights of the apex from which Newton's method begins.
HEIGHTS = {(0, "LP"): 1.049, (0, "PD"): 0.937, (1, "LP"): 1.014, (1, "PD"): 0.934}
MASS, LENGTH, STIFFNESS, GRAVITY = 80.0, 1.0, 20000.0, 9.81


def apex(y: float, alpha: float, energy: float) -> tuple[float, float]:
    """The next apex's height, and its derivative by this one's."""
    angle = math.radians(alpha)
    speed = math.sqrt(2.0 * (energy / MASS - GRAVITY * y))
    falls = math.sqrt(2.0 * GRAVITY * (y - LENGTH * math.sin(angle)))

    def rates(x: float, z: float) -> tuple[float, float]:
        push = STIFFNESS / MASS * (LENGTH / math.hypot(x, z) - 1.0)
        return push * x, push * z - GRAVITY

    def field(_: float, s: np.ndarray) -> list[float]:
        x, z, u, w, dx, dz, du, dw = s
        length, k = math.hypot(x, z), STIFFNESS / MASS
        push, steep = k * (LENGTH / length - 1.0), -k * LENGTH / length**3
        along = steep * (x * dx + z * dz)
        return [u, w, *rates(x, z), du, dw, push * dx + along * x, push * dz + along * z]

    def stretched(_: float, s: np.ndarray) -> float:
        return math.hypot(s[0], s[1]) - LENGTH

    stretched.terminal, stretched.direction = True, 1.0
    start = [-LENGTH * math.cos(angle), LENGTH * math.sin(angle), speed, -falls]
    start += [0.0, 0.0, -GRAVITY / speed, -GRAVITY / falls]
    found = solve_ivp(field, (0.0, 2.0), start, "DOP853", rtol=3e-14, atol=1e-14, events=stretched)
    x, z, u, w, dx, dz, _, dw = found.y_events[0][0]
    late = -(x * dx + z * dz) / (x * u + z * w)
    return z + w**2 / (2.0 * GRAVITY), dz + w * late + w / GRAVITY * (dw + rates(x, z)[1] * late)


@pytest.mark.parametrize("label", ["LP", "PD"])
@pytest.mark.parametrize("study", [0, 1])
def test_special_points_of_the_apex_map(study, label):
    """Newton's method for a fixed point with this slope comes back to the value that is listed.

    Difference quotients bound its speed, not what it converges to.
    """
    (value,) = [v.value for v in PEER.studies[study].values if v.label == label]
    fixed = {"alpha": 68.0, "energy": 0.5 * MASS * 25.0 + MASS * GRAVITY}
    free = ("alpha", "energy")[study]

    def missed(z: np.ndarray) -> np.ndarray:
        end, slope = apex(z[0], **{**fixed, free: z[1]})
        return np.array([end - z[0], slope - multiplier])

    multiplier = {"LP": 1.0, "PD": -1.0}[label]
    z, h = np.array([HEIGHTS[study, label], value]), np.array([1e-6, 1e-6 * value])
    for _ in range(6):
        columns = [(missed(z + h * e) - missed(z - h * e)) / (2.0 * h @ e) for e in np.eye(2)]
        z = z - np.linalg.solve(np.array(columns).T, missed(z))
    assert z[1] == pytest.approx(value, rel=1e-12)

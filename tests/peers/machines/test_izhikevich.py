"""Izhikevich's neuron against SciPy: the map of u from spike to spike, its slope by Liouville's formula."""

from __future__ import annotations

import numpy as np
import pytest
from peers.machines.izhikevich import PEER
from scipy.integrate import solve_ivp

A, B, RESET, CURRENT = 0.02, 0.2, -50.0, 10.0


def spike(u: float) -> tuple[float, float]:
    """u at the next spike, and its derivative: the flow's divergence, and the speeds across both sections.

    Times are stretched where v is fast, so that a spike is nothing special.
    """

    def speed(v: float, u: float) -> float:
        return 0.04 * v * v + 5.0 * v + 140.0 - u + CURRENT

    def field(_: float, y: np.ndarray) -> list[float]:
        v, u, _divergence = y
        slow = 1.0 / np.hypot(1.0, speed(v, u) / 20.0)
        return [slow * speed(v, u), slow * A * (B * v - u), slow * (0.08 * v + 5.0 - A)]

    def peak(_: float, y: np.ndarray) -> float:
        return float(y[0] - 30.0)

    peak.terminal = True
    found = solve_ivp(field, (0.0, 1e4), (RESET, u, 0.0), "DOP853", rtol=3e-14, atol=1e-13, events=peak)
    v, end, divergence = found.y_events[0][0]
    return end, float(np.exp(divergence) * speed(RESET, u) / speed(v, end))


def burst(u: float, d: float) -> tuple[float, float]:
    """Five spikes later, and the product of their slopes."""
    slope = 1.0
    for _ in range(5):
        u, one = spike(u + d)
        slope *= one
    return u, slope


@pytest.mark.parametrize(
    ("label", "multiplier", "u"), [("PD", -1.0, -7.4990152189), ("LP", 1.0, -7.4990436773)]
)
def test_special_points_of_bursts(label, multiplier, u):
    """Newton's method for a periodic point with this multiplier comes back to the value that is listed.

    Difference quotients bound its speed, not what it converges to; u is known to 1e-13, and the slope changes
    by 1e4 in a unit of u and more, so that d is right to 1e-12.
    """
    (value,) = [v.value for v in PEER.studies[1].values if v.label == label]

    def missed(z: np.ndarray) -> np.ndarray:
        end, slope = burst(z[0], z[1])
        return np.array([end - z[0], slope - multiplier])

    z, h = np.array([u, value]), 1e-7
    for _ in range(3):
        columns = [(missed(z + h * e) - missed(z - h * e)) / (2.0 * h) for e in np.eye(2)]
        z = z - np.linalg.solve(np.array(columns).T, missed(z))
    assert z[1] == pytest.approx(value, rel=1e-12)

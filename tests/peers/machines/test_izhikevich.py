"""Izhikevich's neuron against SciPy: the map of u from spike to spike, its slope by Liouville's formula."""

from __future__ import annotations

import re
from fractions import Fraction

import numpy as np
import pytest
from hybrid_runs import branch_of
from peers.machines.izhikevich import PEER
from peers.machines.izhikevich import SYSTEM as PEER_SYSTEM
from scipy.integrate import solve_ivp

pytestmark = pytest.mark.slow

A, B, RESET, CURRENT = 0.02, 0.2, -50.0, 10.0


def speed(v: float, u: float) -> float:
    """v'."""
    return 0.04 * v * v + 5.0 * v + 140.0 - u + CURRENT


def spike(u: float) -> tuple[float, float]:
    """u at the next spike, and its derivative: the flow's divergence, and the speeds across both sections.

    Times are stretched where v is fast, so that a spike is nothing special.
    """

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


@pytest.mark.drawn(1)
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


# -- beyond the special points: canards ---------------------------------------------------------------------


def halfway(v: float, u: float, level: float, back: bool = False) -> tuple[float, float]:
    """v where u passes a level between spikes, and its derivative by the u that the motion begins with."""

    def field(_: float, y: np.ndarray) -> list[float]:
        v, u, _divergence = y
        slow = (-1.0 if back else 1.0) / np.hypot(1.0, speed(v, u) / 20.0)
        return [slow * speed(v, u), slow * A * (B * v - u), slow * (0.08 * v + 5.0 - A)]

    def passes(_: float, y: np.ndarray) -> float:
        return float(y[1] - level)

    passes.terminal, passes.direction = True, 1.0 if back else -1.0
    found = solve_ivp(field, (0.0, 1e3), (v, u, 0.0), "DOP853", rtol=3e-14, atol=1e-13, events=passes)
    end, _, divergence = found.y_events[0][0]
    return end, float(np.exp(divergence) * speed(v, u) / (A * (B * end - level)))


def canard(first: float, last: float, d: float) -> tuple[np.ndarray, float]:
    """u at both ends of the leg between two bursts, and the multiplier: from both ends to its middle, where
    neither way has far to go along what repels it.
    """
    level = 0.5 * (first + last)

    def missed(ends: np.ndarray) -> tuple[np.ndarray, float]:
        u, slope = ends[1], 1.0
        for _ in range(4):
            u, one = spike(u + d)
            slope *= one
        (a, to), (b, back) = halfway(RESET, ends[0], level), halfway(30.0, ends[1], level, back=True)
        return np.array([u + d - ends[0], a - b]), slope * to / back

    ends, h = np.array([first, last]), 1e-6
    for _ in range(3):
        gap = missed(ends)[0]
        columns = [(missed(ends + h * e)[0] - gap) / h for e in np.eye(2)]
        ends = ends - np.linalg.solve(np.array(columns).T, gap)
    return ends, missed(ends)[1]


@pytest.fixture(scope="module")
def bursts():
    given = {"I": CURRENT, "b": B, "c": RESET, "d": 2.0}
    return branch_of(PEER_SYSTEM, "d", (1.6, 2.2), [-65.0, -10.0], given, mode="membrane", until="settled")


@pytest.mark.long
def test_bursts_are_followed_through_their_canards(bursts):
    """Backward from the period doubling and forward around the fold, to the end of the range each time."""
    assert bursts.outcome.reason == "bound", bursts.outcome.message
    assert [point.label for point in bursts.special_points] == ["EP", "PD", "LP", "EP"]
    assert [point.status for point in bursts.special_points] == ["located"] * 4


@pytest.mark.long
def test_multipliers_of_canards_are_right(bursts):
    """On both sides, up to 1e12."""
    moduli = np.abs(bursts.points["spectrum"][:, 0])
    assert moduli[0] > 1e9
    assert moduli.max() > 1e12
    chosen = [0, int(np.argmax(moduli)), len(moduli) - 1]
    after = np.flatnonzero(bursts["d"] > 2.0)
    chosen.append(int(after[np.argmin(np.abs(np.log(moduli[after] / 1e7)))]))
    for row in chosen:
        z = bursts.unknowns(row)
        us, j = z[1:10:2], int(np.argmax(z[10:15]))
        ends, multiplier = canard(us[j], us[(j + 1) % 5] - z[-1], z[-1])
        assert ends[0] == pytest.approx(us[j], abs=1e-9)
        found = bursts.points["spectrum"][row, 0]
        assert found.imag == 0.0
        assert found.real == pytest.approx(multiplier, rel=3e-4)


def canard_current(b: float) -> float:
    """The current at which a parabola u = v^2 / 25 + alpha v + beta is invariant: then v' is linear on it.

    Coefficients of v^2, v and 1 in u' = a (b v - u) with v' = (5 - alpha) v + rest on it, as fractions.
    """
    a, quadratic = Fraction(1, 50), Fraction(1, 25)
    slope = Fraction(b).limit_denominator(100)
    alpha = 5 + a / 2
    rest = (a * (slope - alpha) - alpha * (5 - alpha)) / (2 * quadratic)
    beta = -alpha * rest / a
    return float(rest + beta - 140)


@pytest.mark.drawn(1)
@pytest.mark.parametrize(
    ("b", "d", "saddle"), [(0.25, 6.0, -56.375), (0.2, 8.0, -57.625)], ids=["class 1", "regular spiking"]
)
def test_tonic_spiking_ends_at_the_homoclinic_orbit(b, d, saddle):
    """Where the parabola is invariant it is the stable manifold of the saddle, and the slow motion that
    attracts all that comes back from a spike: orbits tend to the homoclinic one at that current.

    Of regular spiking the slow motion passes a stable focus before, at 1 % of the orbit's range, and is a
    canard from there on: it is repelled all the way to the saddle.
    """
    limit = canard_current(b)
    given = {"I": 4.0, "b": b, "d": d}
    branch = branch_of(
        PEER_SYSTEM, "I", (-20.0, 5.0), [-65.0, -10.0], given, mode="membrane", until="settled"
    )
    outcome = next(p for p in branch.special_points if p.kind == "homoclinic")
    assert branch.outcome.reason == "homoclinic", branch.outcome.message
    assert outcome.parameters["I"] == pytest.approx(limit, abs=1e-6)
    told = re.search(r"at I = ([\d.]+) \+- ([\d.e-]+)", branch.outcome.message)
    assert told is not None
    assert abs(float(told[1]) - limit) < float(told[2]) < 1e-6
    assert f"the equilibrium v = {saddle}, u = {b * saddle:.5g}:" in branch.outcome.message
    assert branch["I"].min() > limit


def test_regular_spiking_ceases_at_the_current_of_the_parabola():
    """By simulation: above it a motion fires ten times, below it comes to rest at the focus."""

    def fires(current: float) -> bool:
        def field(_: float, y: np.ndarray) -> list[float]:
            v, u = y
            return [0.04 * v * v + 5.0 * v + 140.0 - u + current, A * (B * v - u)]

        def peak(_: float, y: np.ndarray) -> float:
            return float(y[0] - 30.0)

        peak.terminal = True
        u = -10.0
        for _ in range(10):
            found = solve_ivp(field, (0.0, 2e3), (-65.0, u), "DOP853", rtol=1e-11, atol=1e-11, events=peak)
            if not len(found.y_events[0]):
                return False
            u = float(found.y_events[0][0][1]) + 8.0
        return True

    limit = canard_current(0.2)
    assert fires(limit + 1e-7)
    assert not fires(limit - 1e-7)

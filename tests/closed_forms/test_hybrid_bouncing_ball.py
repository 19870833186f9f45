"""The bouncing ball: orbits with one bounce in k periods of the table, in closed form.

A flight of duration T = 2 pi k / omega between bounces at one height leaves at the velocity g T / 2, and the
impact law gives the phase: (1 + e) A omega cos(phase) = (1 - e) g T / 2. In (time, velocity after) the
derivative of a bounce has the determinant e^2 and the trace 1 + e^2 - (1 + e)^2 A omega^2 sin(phase) / g. So
the fold is where cos(phase) is one, and the period doubles where A omega^2 sin(phase) is
2 g (1 + e^2) / (1 + e)^2.
"""

from __future__ import annotations

import math
from functools import cache

import mpmath
import numpy as np
import pytest
from contwalk_systems.bouncing_ball import SYSTEM
from hybrid_invariants import check_hybrid_branch
from hybrid_runs import ACCURACY, diagram
from orbit_systems import assert_met

from contwalk.branch import Branch

CASES = [(0.2, 1), (0.5, 1), (0.8, 1), (0.95, 1), (0.5, 2), (0.9, 2), (0.8, 3)]
WALKED = 100.0 * ACCURACY
G, OMEGA = 9.81, 35.0


def fold_at(e: float, k: int) -> float:
    return math.pi * k * G * (1.0 - e) / (OMEGA**2 * (1.0 + e))


def doubling_at(e: float, k: int) -> float:
    return G / OMEGA**2 * math.hypot(2.0 * (1.0 + e**2) / (1.0 + e) ** 2, math.pi * k * (1.0 - e) / (1.0 + e))


def duration(k: int) -> float:
    return 2.0 * math.pi * k / OMEGA


def at_zero(e: float, k: int, amplitude: float) -> list[float]:
    """The state when the table begins its next period, a while after a bounce at the stable phase."""
    speed = 0.5 * G * duration(k)
    bounce = math.acos(speed * (1.0 - e) / ((1.0 + e) * amplitude * OMEGA)) / OMEGA
    passed = duration(1) - bounce
    return [amplitude * math.sin(OMEGA * bounce) + speed * passed - 0.5 * G * passed**2, speed - G * passed]


@cache
def study(e: float, k: int) -> tuple[Branch, ...]:
    """From below the fold to beyond the doubling, and the doubled orbits."""
    low, high = fold_at(e, k), doubling_at(e, k)
    middle = 0.5 * (low + high)
    found = diagram(
        SYSTEM,
        "A",
        (0.5 * low, 1.25 * high),
        at_zero(e, k, middle),
        {"e": e, "A": middle, "omega": OMEGA, "g": G},
        follow=["PD"],
        events={"GR": "ignore"},
    )
    return tuple(found)


@pytest.mark.parametrize(("e", "k"), CASES)
class TestStudy:
    @pytest.mark.drawn(1)
    def test_fold(self, e, k):
        branch = study(e, k)[0]
        (point,) = [p for p in branch.special_points if p.label == "LP"]
        assert_met(point, "A", fold_at(e, k))
        assert branch["A"].min() >= fold_at(e, k) - WALKED * fold_at(e, k)
        np.testing.assert_allclose(point.spectrum, [1.0, e**2], rtol=0, atol=ACCURACY)
        assert {point.unstable_before, point.unstable_after} == {0, 1}
        # At the phase zero: the bounce happens where the table is fastest.
        assert point.state["y"] == pytest.approx(0.0, abs=10.0 * ACCURACY * fold_at(e, k))

    @pytest.mark.drawn(2)
    def test_doubling(self, e, k):
        parent, child = study(e, k)
        (point,) = [p for p in parent.special_points if p.label == "PD"]
        assert_met(point, "A", doubling_at(e, k))
        np.testing.assert_allclose(point.spectrum, [-1.0, -(e**2)], rtol=0, atol=ACCURACY)
        assert point.period == pytest.approx(duration(k), rel=1e-12)
        assert point.criticality == "supercritical"
        assert point.coefficients["c"] > 0.0
        assert (child.info.signature, child.info.subharmonic) == (("bounce", "bounce"), 2 * k)
        assert child.info.parent == ("b1", point.s)
        assert child["A"].min() >= doubling_at(e, k) * (1.0 - WALKED)
        beside = child.points[(child["s"] > 0.0) & ~child["special"]][0]
        assert beside["unstable"] == 0
        assert beside["period"] == pytest.approx(2.0 * duration(k), rel=1e-12)

    def test_determinant_is_the_square_of_the_restitution(self, e, k):
        """For each bounce: at every stored point, fold and doublings included."""
        for branch, bounces in zip(study(e, k), (1, 2), strict=True):
            products = np.prod(branch.points["spectrum"], axis=1)
            size = np.maximum(np.abs(branch.points["spectrum"][:, 0]), 1.0)
            assert np.all(np.abs(products - e ** (2 * bounces)) <= WALKED * size)
            assert np.all(branch.points["period"] == pytest.approx(bounces * duration(k), rel=1e-12))

    def test_motion_and_trace_at_every_point(self, e, k):
        """Unknowns are height and velocity after the bounce, duration, and when it begins."""
        branch = study(e, k)[0]
        amplitude, (y, v, lasting, begin) = branch["A"], branch.points["unknowns"].T
        size = np.abs(branch.points["spectrum"][:, 0]) + 1.0
        known = WALKED * size
        assert np.all(np.abs(lasting / duration(k) - 1.0) <= 1e-12)
        assert np.all(np.abs(v / (0.5 * G * duration(k)) - 1.0) <= known)
        table = amplitude * np.sin(OMEGA * begin)
        assert np.all(np.abs(y - table) <= known * amplitude)
        cosine = (1.0 - e) * 0.5 * G * duration(k) / ((1.0 + e) * amplitude * OMEGA)
        # Near the fold the phase is the square root of what is left of the amplitude.
        assert np.all(np.abs(np.cos(OMEGA * begin) - cosine) <= 10.0 * known)
        trace = 1.0 + e**2 - (1.0 + e) ** 2 * OMEGA**2 * table / G
        assert np.all(np.abs(branch.points["spectrum"].sum(axis=1) - trace) <= 10.0 * known * size)

    def test_observables_at_every_point(self, e, k):
        branch = study(e, k)[0]
        known = WALKED * (np.abs(branch.points["spectrum"][:, 0]) + 1.0)
        speed = G * duration(k) / (1.0 + e)
        assert np.all(np.abs(branch["impact_speed"] / speed - 1.0) <= known)
        begin = branch.points["unknowns"][:, 3]
        turned = np.abs(np.exp(1j * branch["impact_phase"]) - np.exp(1j * OMEGA * begin))
        assert np.all(turned <= known)
        top = branch.points["unknowns"][:, 0] + (0.5 * G * duration(k)) ** 2 / (2.0 * G)
        assert np.all(np.abs(branch["y_max"] / top - 1.0) <= known)

    def test_reported_before_the_bounce(self, e, k):
        """Height and velocity: the ball comes down as fast as it left."""
        branch = study(e, k)[0]
        size = np.abs(branch.points["spectrum"][:, 0]) + 1.0
        assert np.all(np.abs(branch["v"] / (-0.5 * G * duration(k)) - 1.0) <= WALKED * size)

    @pytest.mark.drawn(2)
    def test_invariants(self, e, k):
        for branch in study(e, k):
            check_hybrid_branch(branch, SYSTEM)


def two_bounces(e: mpmath.mpf, k: int, guess: list[float]) -> mpmath.mpf:
    """Amplitude at which an orbit of two bounces doubles its period, to 30 digits.

    Unknowns: times of the two bounces, velocities after them, amplitude. Each flight ends on the table, and
    trace + determinant + 1 of the product of both derivatives is zero.
    """
    g, omega = mpmath.mpf(G), mpmath.mpf(OMEGA)
    whole = 4 * mpmath.pi * k / omega

    def flight(t, v, later, a):
        """What the height misses, and the velocity after the bounce that follows."""
        passed = later - t
        missed = a * mpmath.sin(omega * t) + v * passed - g * passed**2 / 2 - a * mpmath.sin(omega * later)
        arriving = v - g * passed
        return missed, -e * arriving + (1 + e) * a * omega * mpmath.cos(omega * later)

    def derivative(t, v, later, a):
        """Of (later, velocity after it) by (t, v)."""
        passed = later - t
        falls = v - g * passed - a * omega * mpmath.cos(omega * later)
        by_t = -(a * omega * mpmath.cos(omega * t) - v + g * passed) / falls
        by_v = -passed / falls
        bend = e * g - (1 + e) * a * omega**2 * mpmath.sin(omega * later)
        return mpmath.matrix([[by_t, by_v], [bend * by_t - e * g, bend * by_v - e]])

    def equations(t1, t2, v1, v2, a):
        first, second = flight(t1, v1, t2, a), flight(t2, v2, t1 + whole, a)
        m = derivative(t2, v2, t1 + whole, a) * derivative(t1, v1, t2, a)
        trace, det = m[0, 0] + m[1, 1], m[0, 0] * m[1, 1] - m[0, 1] * m[1, 0]
        return [first[0], first[1] - v2, second[0], second[1] - v1, trace + det + 1]

    return mpmath.findroot(equations, guess, tol=1e-50, maxsteps=50)[4]


@pytest.mark.parametrize(("e", "k"), [(0.5, 1), (0.8, 1), (0.9, 2)])
def test_the_next_doubling_agrees_with_an_independent_solution(e, k):
    """Of the doubled orbit, whose two flights differ."""
    child = study(e, k)[1]
    (point,) = [p for p in child.special_points if p.label == "PD"]
    _, v1, _, v2, first, _, begin = point.unknowns[:7]
    with mpmath.workdps(30):
        exact = two_bounces(mpmath.mpf(e), k, [begin, begin + first, v1, v2, point.parameters["A"]])
        assert_met(point, "A", float(exact))


def test_an_elastic_ball_has_no_fold():
    """e = 1: the phase is pi / 2 at every amplitude, and the determinant is one.

    A = g / omega^2 is the doubling; below it both multipliers lie on the unit circle, as far as is known.
    """
    amplitude = 0.5 * doubling_at(1.0, 1)
    state = at_zero(1.0, 1, amplitude)
    found = diagram(
        SYSTEM,
        "A",
        (0.2 * amplitude, 3.0 * amplitude),
        state,
        {"e": 1.0, "A": amplitude, "omega": OMEGA, "g": G},
    )
    (branch,) = found
    assert branch.outcome.reason == "bound"
    labels = [p.label for p in branch.special_points if p.label != "EP"]
    assert labels == ["PD"]
    (point,) = [p for p in branch.special_points if p.label == "PD"]
    assert_met(point, "A", G / OMEGA**2)
    assert np.all(np.abs(np.prod(branch.points["spectrum"], axis=1) - 1.0) <= WALKED * 10.0)
    circled = branch["A"] < G / OMEGA**2 * (1.0 - 1e-6)
    assert np.all(np.abs(np.abs(branch.points["spectrum"][circled]) - 1.0) <= WALKED * 10.0)

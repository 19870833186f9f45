"""The impact oscillator against closed forms: motions without impacts, and with one impact in a period."""

import math

import numpy as np
import pytest
from contwalk_systems.impact_oscillator import SYSTEM
from hybrid_motion import joined, parameters, phase, vector
from scipy.integrate import solve_ivp
from scipy.linalg import expm

OBSERVABLES = {observable.name: observable for observable in SYSTEM.observables}


def amplitude(p):
    """Amplitude of the motion without impacts."""
    return p.force / math.hypot(1.0 - p.omega**2, 2.0 * p.zeta * p.omega)


def forced(p, t):
    """Displacement and velocity of that motion."""
    turn = p.omega * t - math.atan2(2.0 * p.zeta * p.omega, 1.0 - p.omega**2)
    return amplitude(p) * np.array([math.cos(turn), -p.omega * math.sin(turn)])


def one_impact(p):
    """Times of impact, and velocities after it, of the two motions with one impact in a period.

    Over the free flight of the duration T, what differs from the forced motion w is carried over by
    E = exp(A T): E ((gap, v) - w) = (gap, -v / restitution) - w. So w is linear in v, and its amplitude is
    known.
    """
    duration = 2.0 * math.pi / p.omega
    carried = expm(np.array([[0.0, 1.0], [-1.0, -2.0 * p.zeta]]) * duration)
    left = np.eye(2) - carried
    constant = np.linalg.solve(left, np.array([p.gap, 0.0]) - carried @ [p.gap, 0.0])
    slope = np.linalg.solve(left, np.array([0.0, -1.0 / p.restitution]) - carried @ [0.0, 1.0])
    weight = np.diag([1.0, p.omega**-2])
    square = [slope @ weight @ slope, 2.0 * slope @ weight @ constant, constant @ weight @ constant]
    square[2] -= amplitude(p) ** 2
    found = []
    for v in np.roots(square):
        q, rate = constant + slope * v
        turn = math.atan2(-rate / p.omega, q) + math.atan2(2.0 * p.zeta * p.omega, 1.0 - p.omega**2)
        found.append((turn % (2.0 * math.pi) / p.omega, v))
    return found


def test_motion_without_impacts_is_the_forced_one():
    p = parameters(SYSTEM)
    period = SYSTEM.period(p)
    solved = solve_ivp(
        lambda t, x: vector(SYSTEM.modes[0].field, t, x, p),
        (0.0, period),
        forced(p, 0.0),
        method="DOP853",
        rtol=1e-12,
        atol=1e-13,
    )
    assert solved.y[:, -1] == pytest.approx(forced(p, period), abs=1e-10)


def test_stop_is_grazed_at_the_force_of_the_closed_form():
    p = parameters(SYSTEM)
    p.force = p.gap * math.hypot(1.0 - p.omega**2, 2.0 * p.zeta * p.omega)
    at_top = math.atan2(2.0 * p.zeta * p.omega, 1.0 - p.omega**2) / p.omega
    assert SYSTEM.transitions[0].guard(at_top, forced(p, at_top), p) == pytest.approx(0.0, abs=1e-15)
    assert forced(p, at_top)[1] == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize(("force", "omega"), [(1.0, 1.3), (2.0, 1.3), (1.0, 0.8), (12.0, 2.8)])
def test_motion_with_one_impact_repeats_itself(force, omega):
    p = parameters(SYSTEM, force=force, omega=omega)
    # The other root comes at the stop from behind.
    ((t, v),) = [(t, v) for t, v in one_impact(p) if v < 0.0]
    part = phase(SYSTEM, p, "free", np.array([p.gap, v]), t, max_step=0.05)
    assert part.duration == pytest.approx(SYSTEM.period(p), abs=1e-10)
    assert part.after == pytest.approx([p.gap, v], abs=1e-9)
    speed = OBSERVABLES["impact_speed"].function(part.end, part.before, p)
    assert speed == pytest.approx(-v / p.restitution, abs=1e-9)
    found = OBSERVABLES["impact_phase"].function(part.end, part.before, p)
    assert found == pytest.approx(p.omega * t, abs=1e-9)
    assert OBSERVABLES["q_max"].function(*joined([part]), p) == pytest.approx(p.gap, abs=1e-12)

"""The bouncing ball against the closed form of its motions with one impact in so many periods."""

import math

import numpy as np
import pytest
from contwalk_systems.bouncing_ball import SYSTEM
from hybrid_motion import joined, parameters, phase, vector

BOUNCE = SYSTEM.transitions[0]
OBSERVABLES = {observable.name: observable for observable in SYSTEM.observables}


def bouncing(p, periods=1):
    """Time of the impact in the table's phase 0 .. pi / 2, state after it, and duration of the flight."""
    duration = periods * 2.0 * math.pi / p.omega
    speed = 0.5 * p.g * duration
    t = math.acos(speed * (1.0 - p.e) / ((1.0 + p.e) * p.A * p.omega)) / p.omega
    return t, np.array([p.A * math.sin(p.omega * t), speed]), duration


def flight(p, t, x):
    return phase(SYSTEM, p, "flight", x, t, max_step=0.005)


@pytest.mark.parametrize(("e", "omega", "periods"), [(0.5, 35.0, 1), (0.8, 35.0, 1), (0.9, 40.0, 3)])
def test_bouncing_repeats_itself(e, omega, periods):
    p = parameters(SYSTEM, e=e, omega=omega)
    t, x, duration = bouncing(p, periods)
    part = flight(p, t, x)
    assert part.duration == pytest.approx(duration, abs=1e-11)
    assert part.after == pytest.approx(x, abs=1e-10)


@pytest.mark.parametrize("e", [0.3, 0.5, 0.8])
def test_derivative_over_a_bounce(e):
    """Determinant e^2 and trace 1 + e^2 - (1 + e)^2 A omega^2 sin(phase) / g, in (time, velocity after)."""
    p = parameters(SYSTEM, e=e, omega=45.0)
    t, x, _ = bouncing(p)

    def image(dt, dv):
        y = p.A * math.sin(p.omega * (t + dt))
        part = flight(p, t + dt, np.array([y, x[1] + dv]))
        return np.array([part.end, part.after[1]])

    h = 1e-5
    columns = [(image(*step) - image(*-step)) / (2.0 * h) for step in h * np.eye(2)]
    derivative = np.column_stack(columns)
    trace = 1.0 + e**2 - (1.0 + e) ** 2 * p.A * p.omega**2 * math.sin(p.omega * t) / p.g
    assert np.linalg.det(derivative) == pytest.approx(e**2, abs=1e-5)
    assert np.trace(derivative) == pytest.approx(trace, abs=1e-5)


def test_period_doubles_where_the_closed_form_says():
    """Trace + determinant = -1; amplitudes as in `docs/systems/bouncing_ball.md`."""
    p = parameters(SYSTEM)
    born = math.pi * p.g * (1.0 - p.e) / (1.0 + p.e) / p.omega**2
    p.A = math.hypot(born, 2.0 * p.g * (1.0 + p.e**2) / (1.0 + p.e) ** 2 / p.omega**2)
    assert (born, p.A) == pytest.approx((0.008386, 0.012227), abs=1e-6)
    t, _, _ = bouncing(p)
    trace = 1.0 + p.e**2 - (1.0 + p.e) ** 2 * p.A * p.omega**2 * math.sin(p.omega * t) / p.g
    assert trace + p.e**2 == pytest.approx(-1.0, abs=1e-14)


def test_relative_velocity_turns_round():
    p = parameters(SYSTEM, e=0.7)
    t, x = 0.123, np.array([0.004, -1.3])
    table = p.A * p.omega * math.cos(p.omega * t)
    after = vector(BOUNCE.reset, t, x, p)
    assert after[0] == x[0]
    assert after[1] - table == pytest.approx(-p.e * (x[1] - table), rel=1e-14)


def test_observables():
    p = parameters(SYSTEM)
    t, x, duration = bouncing(p)
    part = flight(p, t, x)
    top = x[0] + x[1] ** 2 / (2.0 * p.g)
    assert OBSERVABLES["y_max"].function(*joined([part]), p) == pytest.approx(top, rel=1e-4)
    found = [
        OBSERVABLES[name].function(part.end, part.before, p) for name in ("impact_phase", "impact_speed")
    ]
    assert found[0] == pytest.approx(p.omega * t, abs=1e-9)
    # Of the speed relative to the table, e is left: together they are that of a flight up and down.
    assert (1.0 + p.e) * found[1] == pytest.approx(p.g * duration, rel=1e-10)
    assert SYSTEM.period(p) == pytest.approx(duration, rel=1e-15)

"""The walker with straight legs against the mechanics of three bodies, closed forms and published gaits."""

from __future__ import annotations

import math

import numpy as np
import pytest
from contwalk_systems.straight_walker import SYSTEM
from hybrid_motion import joined, parameters, phase, phases, vector
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

TRANSITIONS = {transition.name: transition for transition in SYSTEM.transitions}
SPEED = next(o.function for o in SYSTEM.observables if o.name == "speed")
MACHINES = {
    "points": {"g": 9.81, "b": 0.8, "m_leg": 0.3, "gamma": 0.05},
    "feet": {"g": 9.81, "r": 0.3, "b": 0.4, "m_hip": 0.7, "m_leg": 0.5, "I_leg": 0.05, "gamma": 0.02},
    "wheel": {"g": 9.81, "r": 1.0, "b": 0.5, "m_leg": 0.2, "I_leg": 0.01, "gamma": 0.01},
}
X = np.array([-0.3, 0.25, 1.1, 0.7])


def bodies(p, x):
    """Places (along, away from the slope), masses, moments of inertia of hip, standing and swinging leg."""
    stance, swing = x[:2]
    d = p.l - p.r
    hip = np.array([p.r * stance + d * np.sin(stance), p.r + d * np.cos(stance)])
    legs = [hip - p.b * np.array([np.sin(angle), np.cos(angle)]) for angle in (stance, swing)]
    return [hip, *legs], (p.m_hip, p.m_leg, p.m_leg), (0.0, p.I_leg, p.I_leg)


def moving(p, x):
    """Places and velocities of the bodies, differentiated by complex steps."""
    h = 1e-30
    steps = bodies(p, np.asarray(x[:2], dtype=complex) + 1j * h * np.asarray(x[2:]))[0]
    return [step.real for step in steps], [step.imag / h for step in steps]


def energy(p, x):
    places, speeds = moving(p, x)
    _, masses, inertias = bodies(p, x)
    turning = (0.0, x[2], x[3])
    kinetic = sum(
        0.5 * m * v @ v + 0.5 * i * w * w
        for m, v, i, w in zip(masses, speeds, inertias, turning, strict=True)
    )
    down = np.array([math.sin(p.gamma), -math.cos(p.gamma)])
    return kinetic - p.g * sum(m * down @ place for m, place in zip(masses, places, strict=True))


def moment(p, x, about, which):
    """Moment of momentum of some bodies about a point, positive as the angles are."""
    places, speeds = moving(p, x)
    _, masses, inertias = bodies(p, x)
    turning = (0.0, x[2], x[3])
    arms = [place - about for place in places]
    return sum(
        masses[k] * (arms[k][1] * speeds[k][0] - arms[k][0] * speeds[k][1]) + inertias[k] * turning[k]
        for k in which
    )


@pytest.mark.parametrize("name", MACHINES)
def test_a_swing_keeps_its_energy(name):
    p = parameters(SYSTEM, **MACHINES[name])
    part = phase(SYSTEM, p, "behind", X)
    assert part.transition.name == "legs_pass"
    _, states = part.instants(20)
    # Tolerances of the integration are 1e-12.
    assert [energy(p, x) for x in states] == pytest.approx([energy(p, X)] * len(states), rel=1e-10)


@pytest.mark.parametrize("name", MACHINES)
def test_a_swinging_leg_is_a_pendulum_on_an_accelerated_hip(name):
    """Its moment of momentum about the hip changes by gravity, less the acceleration of the hip."""
    p, h = parameters(SYSTEM, **MACHINES[name]), 1e-4
    field = SYSTEM.mode("behind").field
    path = solve_ivp(
        lambda t, x: vector(field, t, x, p), (0.0, 2 * h), X, rtol=1e-12, atol=1e-13, dense_output=True
    )
    before, here, after = (path.sol(t) for t in (0.0, h, 2 * h))
    hips = [moving(p, x)[1][0] for x in (before, after)]
    hip = (hips[1] - hips[0]) / (2 * h)
    arm = moving(p, here)[0][2] - moving(p, here)[0][0]
    down = p.g * np.array([math.sin(p.gamma), -math.cos(p.gamma)])
    felt = p.m_leg * (arm[1] * (down - hip)[0] - arm[0] * (down - hip)[1])
    rate = (after[3] - before[3]) / (2 * h)
    # Central differences err by h^2 of third derivatives, which are of the order of 100.
    assert (p.m_leg * p.b**2 + p.I_leg) * rate == pytest.approx(felt, abs=1e-5)


@pytest.mark.parametrize("name", MACHINES)
def test_a_heel_strike_keeps_moments_of_momentum(name):
    """Of all about the new contact, and of the leg that is lifted about the hip."""
    p = parameters(SYSTEM, **MACHINES[name])
    x = np.array([0.28, -0.28, 1.2, -0.4])
    after = vector(TRANSITIONS["heel_strike"].reset, 0.0, x, p)
    assert after[:2].tolist() == [-0.28, 0.28]
    contacts = []
    for angles in (x, after):  # below the centre of the foot that lands
        hip = moving(p, angles)[0][0]
        landing = angles[1] if angles is x else angles[0]
        contacts.append(np.array([hip[0] - (p.l - p.r) * math.sin(landing), 0.0]))
    whole = [moment(p, state, about, (0, 1, 2)) for state, about in zip((x, after), contacts, strict=True)]
    assert whole[1] == pytest.approx(whole[0], rel=1e-12)
    hips = [moving(p, state)[0][0] for state in (x, after)]
    lifted = [moment(p, x, hips[0], (1,)), moment(p, after, hips[1], (2,))]
    assert lifted[1] == pytest.approx(lifted[0], rel=1e-12)


def test_the_simplest_walker_has_its_published_gait():
    """Garcia et al. (1998), at 0.009: 0.200310900544287 and 0.199832473004977 in units of g and l."""
    p = parameters(SYSTEM)
    stance, rate = 0.200310900544287, 0.199832473004977
    lifted = rate * (1.0 - (1.0 - math.cos(2.0 * stance)))  # its swing leg, of no mass, is carried along
    parts = phases(SYSTEM, p, "behind", np.array([-stance, stance, rate, lifted]), 2)
    assert [part.transition.name for part in parts] == ["legs_pass", "heel_strike"]
    # The mass of a leg is 1e-9 of the hip's, and moves the gait by as much; multipliers are below 0.6.
    assert parts[1].after == pytest.approx([-stance, stance, rate, lifted], abs=1e-8)
    assert parts[1].end == pytest.approx(3.88246, abs=1e-5)


@pytest.mark.parametrize("half", [0.02, 0.3])
def test_feet_as_long_as_the_legs_roll_as_a_wheel(half):
    """With massless legs at constant speed; a small step takes x / sqrt(g / b), cos x + 2 sin x / x = -1."""
    p = parameters(SYSTEM, **SYSTEM.presets["walking_wheel"])
    frequency = math.sqrt(p.g / p.b)

    def left(rate):
        """How far a pendulum is from the other side when the wheel has rolled a step."""
        swung = solve_ivp(
            lambda t, y: [y[1], -(frequency**2) * math.sin(y[0])],
            (0.0, 2.0 * half / rate),
            [half, rate],
            rtol=1e-12,
            atol=1e-13,
        )
        return swung.y[0, -1] + half

    small = brentq(lambda x: math.cos(x) + 2.0 * math.sin(x) / x + 1.0, 3.5, 4.5)
    rate = brentq(
        left, 0.9 * 2.0 * half * frequency / small, 1.1 * 2.0 * half * frequency / small, xtol=1e-14
    )
    # The correction of a pendulum's period is a sixteenth of the square of its angle, at the order of half.
    assert 2.0 * half / rate * frequency == pytest.approx(small, rel=0.2 * half**2)
    start = np.array([-half, half, rate, rate])
    parts = phases(SYSTEM, p, "behind", start, 2)
    assert parts[1].after == pytest.approx(start, abs=1e-7)  # legs have 1e-9 of the mass
    times, states = joined(parts)
    assert SPEED(times, states, p) == pytest.approx(p.l * rate, rel=1e-7)

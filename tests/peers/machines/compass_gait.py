"""Compass gait: two legs, a hip, and a slope."""

import numpy as np
from peers.form import SHOOTING, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System, Transition

STANCE, SWING, STANCE_RATE, SWING_RATE = range(4)


def field(t, x, p, dx):
    """Angles of both legs from the vertical; a: foot to leg's mass, b: leg's mass to hip."""
    leg = p.a + p.b
    across = x[STANCE] - x[SWING]
    m11 = (p.mh + p.m) * leg**2 + p.m * p.a**2
    m12 = -p.m * leg * p.b * np.cos(across)
    m22 = p.m * p.b**2
    r1 = p.m * leg * p.b * np.sin(across) * x[SWING_RATE] ** 2
    r1 = r1 + (p.mh * leg + p.m * p.a + p.m * leg) * p.g * np.sin(x[STANCE])
    r2 = -p.m * leg * p.b * np.sin(across) * x[STANCE_RATE] ** 2 - p.m * p.b * p.g * np.sin(x[SWING])
    det = m11 * m22 - m12 * m12
    dx[STANCE], dx[SWING] = x[STANCE_RATE], x[SWING_RATE]
    dx[STANCE_RATE] = (m22 * r1 - m12 * r2) / det
    dx[SWING_RATE] = (m11 * r2 - m12 * r1) / det


def both_feet_down(t, x, p):
    """Zero where the legs are mirror images at the slope's normal; not where they pass each other."""
    return x[STANCE] + x[SWING] + 2 * p.slope


def legs_apart(t, x, p):
    """Positive while the swing leg is behind: it has no knee and scuffs then, which the model overlooks."""
    return x[STANCE] - x[SWING]


def heel_strike(t, x, p, x_plus):
    """The legs swap; moments of momentum about the new foot and the hip are kept."""
    leg = p.a + p.b
    c = np.cos(x[STANCE] - x[SWING])
    old11 = -p.m * p.a * p.b + (p.mh * leg**2 + 2 * p.m * p.a * leg) * c
    old12 = -p.m * p.a * p.b
    h1 = old11 * x[STANCE_RATE] + old12 * x[SWING_RATE]
    h2 = -p.m * p.a * p.b * x[STANCE_RATE]
    # of the new stance leg, then of the new swing leg
    new11 = p.m * leg * (leg - p.b * c) + p.m * p.a**2 + p.mh * leg**2
    new12 = p.m * p.b * (p.b - leg * c)
    new21 = -p.m * p.b * leg * c
    new22 = p.m * p.b**2
    det = new11 * new22 - new12 * new21
    x_plus[STANCE], x_plus[SWING] = x[SWING], x[STANCE]
    x_plus[STANCE_RATE] = (new22 * h1 - new12 * h2) / det
    x_plus[SWING_RATE] = (new11 * h2 - new21 * h1) / det


SYSTEM = System(
    name="compass_gait",
    states=(
        State("stance", "rad"),
        State("swing", "rad"),
        State("stance_rate", "rad/s"),
        State("swing_rate", "rad/s"),
    ),
    parameters=(
        Parameter("slope", 0.05, "rad"),
        Parameter("m", 5.0, "kg"),
        Parameter("mh", 10.0, "kg"),
        Parameter("a", 0.5, "m"),
        Parameter("b", 0.5, "m"),
        Parameter("g", 9.81, "m/s2"),
    ),
    modes=(Mode("behind", field), Mode("ahead", field)),
    transitions=(
        Transition("legs_pass", "behind", "ahead", legs_apart),
        Transition("heel_strike", "ahead", "behind", both_feet_down, reset=heel_strike),
    ),
    reference="Goswami, Espiau & Keramane (1997), Autonomous Robots 4, 273; Goswami et al. (1998)",
)

PEER = Peer(
    "Compass gait",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {
                    "simulate": {
                        "state": {
                            "stance": 0.2187,
                            "swing": -0.3234,
                            "stance_rate": -1.0918,
                            "swing_rate": -0.3772,
                        },
                        "mode": "behind",
                        "until": "settled",
                    }
                },
                "continue": {"parameter": "slope", "range": [0.02, 0.09]},
                "diagram": "none",
            },
            values=(Value("PD", 0.07663563157561, 1e-12, SHOOTING, of="orbit", criticality="supercritical"),),
        ),
    ),
)

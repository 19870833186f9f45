"""Pendulum held upright by a digital control: angle and rate are sampled, the torque is held in between.

x'' = sin x + u, and every T seconds u = -K x - D x'. Near x = 0 the map from sample to sample is linear, with
the determinant 1 - D S + K (C - 1) and the trace 2 C - K (C - 1) - D S, C, S = cosh T, sinh T: multipliers
are 1 at K = 1 (with less the pendulum leans, sin x = K x), a pair on the unit circle at K = D coth(T / 2),
and -1 at D = coth(T / 2).
"""

import math

import numpy as np
from peers.form import CLOSED_FORM, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, Symmetry, System, Transition

ANGLE, RATE, TORQUE = range(3)


def pendulum(t, x, p, dx):
    dx[ANGLE] = x[RATE]
    dx[RATE] = np.sin(x[ANGLE]) + x[TORQUE]
    dx[TORQUE] = 0.0


def clock(t, x, p):
    return np.sin(2.0 * np.pi * t / p.T)


def sample(t, x, p, x_plus):
    x_plus[ANGLE], x_plus[RATE] = x[ANGLE], x[RATE]
    x_plus[TORQUE] = -p.K * x[ANGLE] - p.D * x[RATE]


def inversion(t, x, p, image):
    image[:] = -x


SYSTEM = System(
    name="sampled_pendulum",
    states=(State("angle", "rad"), State("rate", "rad/s"), State("torque", "1/s2")),
    parameters=(Parameter("K", 2.5, "1/s2"), Parameter("D", 1.0, "1/s"), Parameter("T", 0.5, "s")),
    modes=(Mode("held", pendulum),),
    transitions=(Transition("sample", "held", "held", clock, "rising", reset=sample),),
    symmetries=(Symmetry("inversion", "spatial", inversion),),
    period=lambda p: p.T,
    reference="Ogata (1995), Discrete-Time Control Systems; Haller & Stepan (1996), J. Nonlinear Sci. 6, 415",
)

UPRIGHT = {"simulate": {"state": {"angle": 0.3, "rate": 0.0, "torque": 0.0}, "until": "settled"}}
COTH = 1.0 / math.tanh(0.25)

PEER = Peer(
    "Pendulum under sampled control",
    SYSTEM.reference,
    (
        Study(
            "stiffness",
            {"start": UPRIGHT, "continue": {"parameter": "K", "range": [0.7, 6.0]}},
            values=(
                Value("BP", 1.0, 1e-15, CLOSED_FORM, of="orbit"),
                Value("NS", COTH, 1e-15, CLOSED_FORM, of="orbit"),
            ),
            long=True,
        ),
        Study(
            "damping",
            {
                "start": UPRIGHT,
                "continue": {"parameter": "D", "range": [0.3, 5.0]},
                # Orbits of two samples swing ever wider as D goes to 2 / T, with a fold at every turn.
                "diagram": {"depth": 0},
            },
            values=(
                Value("NS", 2.5 / COTH, 1e-15, CLOSED_FORM, of="orbit"),
                Value("PD", COTH, 1e-15, CLOSED_FORM, of="orbit"),
            ),
        ),
    ),
)

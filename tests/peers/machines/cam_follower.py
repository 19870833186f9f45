"""Cam and follower: at high speed the follower leaves its cam and strikes it again, without rebound.

In flight y'' = -k y - b y' - g; on the cam y = e cos(omega t), as long as what holds it there is positive.
"""

import numpy as np
from peers.form import SHOOTING, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System, Transition


def cam(t, p):
    """Height, velocity and acceleration of the cam's surface."""
    s = p.omega * t
    return p.e * np.cos(s), -p.e * p.omega * np.sin(s), -p.e * p.omega**2 * np.cos(s)


def lifted(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.k * x[0] - p.b * x[1] - p.g


def rides(t, x, p, dx):
    _, dx[0], dx[1] = cam(t, p)


def gap(t, x, p):
    return x[0] - cam(t, p)[0]


def force(t, x, p):
    """Of the cam on the follower, by its mass."""
    y, v, a = cam(t, p)
    return a + p.b * v + p.k * y + p.g


def on_the_cam(t, x, p, x_plus):
    x_plus[0], x_plus[1], _ = cam(t, p)


SYSTEM = System(
    name="cam_follower",
    states=(State("y"), State("v")),
    parameters=(
        Parameter("omega", 1.5),
        Parameter("e", 1.0),
        Parameter("k", 0.3),
        Parameter("b", 0.1),
        Parameter("g", 1.0),
    ),
    modes=(Mode("rides", rides), Mode("lifted", lifted)),
    transitions=(
        Transition("leaves", "rides", "lifted", force, reset=on_the_cam, level=True),
        Transition("strikes", "lifted", "rides", gap, reset=on_the_cam),
    ),
    period=lambda p: 2.0 * np.pi / p.omega,
    reference="Alzate, di Bernardo, Montanaro & Santini (2007), Nonlinear Dynamics 50, 409",
)

PEER = Peer(
    "Cam and follower",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"simulate": {"state": {"y": 1.0, "v": 0.0}, "mode": "rides", "until": "settled"}},
                "continue": {"parameter": "omega", "range": [1.3, 4.0]},
                "events": {"GR": "switch", "OC": "switch"},
                "diagram": {"depth": 3},
            },
            values=(
                Value("OC", 2.1783572231663, 1e-12, SHOOTING, of="orbit"),
                Value("PD", 2.44388923415, 1e-12, SHOOTING, of="orbit", criticality="supercritical"),
                Value("OC", 2.50852884287, 1e-12, SHOOTING, of="orbit"),
                Value("GR", 2.7157104859942, 1e-12, SHOOTING, of="orbit", kind="terminal"),
            ),
            long=True,
        ),
    ),
)

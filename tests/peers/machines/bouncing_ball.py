"""Ball that bounces on a table that moves up and down."""

import numpy as np
from peers.form import CLOSED_FORM, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System, Transition


def fall(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.g


def height(t, x, p):
    return x[0] - p.A * np.sin(p.omega * t)


def bounce(t, x, p, x_plus):
    table = p.A * p.omega * np.cos(p.omega * t)
    x_plus[0], x_plus[1] = x[0], table - p.e * (x[1] - table)


def period(p):
    return 2 * np.pi / p.omega


SYSTEM = System(
    name="bouncing_ball",
    states=(State("y", "m"), State("v", "m/s")),
    parameters=(
        Parameter("A", 0.01, "m"),
        Parameter("e", 0.5),
        Parameter("omega", 35.0, "rad/s"),
        Parameter("g", 9.81, "m/s2"),
    ),
    modes=(Mode("flight", fall),),
    transitions=(Transition("bounce", "flight", "flight", height, reset=bounce),),
    period=period,
    reference="Guckenheimer & Holmes (1983), section 2.4; Luo & Han (1996), Nonlinear Dynamics 10, 1",
)

PEER = Peer(
    "Bouncing ball",
    SYSTEM.reference,
    (
        Study(
            "one bounce a period",
            {
                "start": {"state": {"y": 0.018611376863, "v": -0.719080881363}},
                "continue": {"parameter": "A", "range": [0.005, 0.0135]},
                "diagram": "none",
                "events": {"GR": "ignore"},
            },
            values=(
                Value("LP", 0.008386128961011121, 1e-15, CLOSED_FORM, of="orbit"),
                Value("PD", 0.0122270534710955, 1e-14, CLOSED_FORM, of="orbit"),
            ),
        ),
    ),
)

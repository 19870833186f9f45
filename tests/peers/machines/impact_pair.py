"""Impact pair: a mass between two stops on a shaken base.

The symmetric orbit strikes a stop each half period. With c, s the cosine and sine of the phase of an impact,
k = (1 + r) / (1 - r), the free motion between impacts closes where c - (pi / 2) k s = omega^2 / beta, and the
speed after an impact is -2 r beta s / (omega (1 - r)). Half a period's map has the multiplier 1 where
the left side is largest, and -1 (symmetry breaks) where tan(phase) = pi / (2 k).
At s = 0 the impacts have no speed.
"""

import math

import numpy as np
from peers.form import CLOSED_FORM, SHOOTING, Ending, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, Symmetry, System, Transition


def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.beta * np.cos(p.omega * t)


def strike(t, x, p, x_plus):
    x_plus[0], x_plus[1] = x[0], -p.r * x[1]


def period(p):
    return 2 * np.pi / p.omega


def inversion(t, x, p, image):
    image[0], image[1] = -x[0], -x[1]


SYSTEM = System(
    name="impact_pair",
    states=(State("x"), State("v")),
    parameters=(Parameter("beta", 12.0), Parameter("omega", 5.0), Parameter("r", 0.5)),
    modes=(Mode("free", field),),
    transitions=(
        Transition("low", "free", "free", lambda t, x, p: 1.0 + x[0], reset=strike),
        Transition("high", "free", "free", lambda t, x, p: 1.0 - x[0], reset=strike),
    ),
    symmetries=(Symmetry("inversion", "spatial", inversion, events={"low": "high", "high": "low"}),),
    period=period,
    reference="Bapat, Popplewell & McLachlan (1983), J. Sound Vib. 87, 19",
)

K = (1.0 + 0.5) / (1.0 - 0.5)
BROKEN = 25.0 * math.hypot(1.0, 0.5 * math.pi / K) / (0.25 * math.pi**2 - 1.0)

PEER = Peer(
    "Impact pair",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"state": {"x": 0.323548582528, "v": 4.393546357249}},
                "continue": {"parameter": "beta", "range": [4.0, 28.0]},
                "diagram": {"follow": ["BP"]},
            },
            values=(
                Value("LP", 25.0 / math.hypot(1.0, 0.5 * math.pi * K), 1e-15, CLOSED_FORM, of="orbit"),
                Value("BP", BROKEN, 1e-15, CLOSED_FORM, of="orbit", kind="symmetry-breaking"),
                Value("GR", 25.0, 1e-15, CLOSED_FORM, of="orbit", kind="terminal"),
                Value("PD", 27.0835159987510, 1e-13, SHOOTING, of="orbit", times=2),
                Value("GR", 27.8933054065140, 1e-13, SHOOTING, of="orbit", kind="interior", times=2),
            ),
            endings=(Ending("grazing", "impacts without speed", 25.0, 1e-8),),
            long=True,
        ),
    ),
)

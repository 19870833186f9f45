"""Bilinear oscillator: a forced mass whose spring is stiffer on one side."""

import numpy as np
from peers.form import SHOOTING, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System, Transition


def spring(stiffness):
    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = np.cos(p.omega * t) - 2.0 * p.zeta * x[1] - stiffness(p) * x[0]

    return field


def place(t, x, p):
    return x[0]


SYSTEM = System(
    name="bilinear_oscillator",
    states=(State("x"), State("v")),
    parameters=(Parameter("omega", 2.0), Parameter("zeta", 0.05), Parameter("k", 6.0)),
    modes=(Mode("pulled", spring(lambda p: 1.0)), Mode("pushed", spring(lambda p: p.k))),
    transitions=(
        Transition("press", "pulled", "pushed", place, "rising", role="soft"),
        Transition("release", "pushed", "pulled", place, "falling", role="soft"),
    ),
    period=lambda p: 2.0 * np.pi / p.omega,
    reference="Shaw & Holmes (1983), J. Sound Vib. 90, 129",
)

PEER = Peer(
    "Bilinear oscillator",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"simulate": {"state": {"x": 0.0, "v": 0.0}, "until": "settled"}},
                "continue": {"parameter": "omega", "range": [1.8, 2.6]},
                "diagram": {"depth": 0},
            },
            values=(Value("PD", 2.28850959764831, 1e-12, SHOOTING, of="orbit", criticality="supercritical"),),
        ),
    ),
)

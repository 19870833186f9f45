"""Rocking block on a shaken ground, linearised: orbits that lose their symmetry."""

import numpy as np
from peers.form import SHOOTING, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, Symmetry, System, Transition


def tilted(side):
    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = x[0] - side + p.beta * np.cos(p.omega * t)

    return field


def strike(t, x, p, x_plus):
    x_plus[0], x_plus[1] = x[0], p.r * x[1]


def period(p):
    return 2 * np.pi / p.omega


def inversion(t, x, p, image):
    image[0], image[1] = -x[0], -x[1]


SYSTEM = System(
    name="rocking_block",
    states=(State("theta"), State("v")),
    parameters=(Parameter("beta", 2.8), Parameter("omega", 5.0), Parameter("r", 0.9)),
    modes=(Mode("right", tilted(1.0)), Mode("left", tilted(-1.0))),
    transitions=(
        Transition("down", "right", "left", lambda t, x, p: x[0], reset=strike),
        Transition("up", "left", "right", lambda t, x, p: -x[0], reset=strike),
    ),
    symmetries=(
        Symmetry(
            "inversion",
            "spatial",
            inversion,
            modes={"right": "left", "left": "right"},
            events={"down": "up", "up": "down"},
        ),
    ),
    period=period,
    reference="Hogan (1989), Proc. R. Soc. A 425, 441",
)

PEER = Peer(
    "Rocking block",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"state": {"theta": -0.214409588757, "v": 0.584863937339}, "mode": "left"},
                "continue": {"parameter": "beta", "range": [2.5, 3.6]},
                "diagram": {"follow": ["BP"]},
            },
            values=(
                Value(
                    "BP",
                    3.0705296329683,
                    1e-12,
                    SHOOTING,
                    of="orbit",
                    kind="symmetry-breaking",
                ),
            ),
        ),
    ),
)

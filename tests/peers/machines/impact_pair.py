"""Impact pair: a mass between two stops on a shaken base."""

import math

from peers.form import Peer, Study, Value

from contwalk.system import Mode, Parameter, State, Symmetry, System, Transition


def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.beta * math.cos(p.omega * t)


def strike(t, x, p, x_plus):
    x_plus[0], x_plus[1] = x[0], -p.r * x[1]


def period(p):
    return 2 * math.pi / p.omega


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

PEER = Peer(
    "Impact pair",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"state": {"x": 0.323548582528, "v": 4.393546357249}},
                "continue": {"parameter": "beta", "range": [8.0, 22.0]},
                "diagram": {"follow": ["BP"]},
            },
            values=(
                Value(
                    "BP",
                    19.231024237121208,
                    1e-11,
                    "closed forms of the motion between impacts, by brentq to 1e-12",
                    of="orbit",
                    kind="symmetry-breaking",
                ),
            ),
        ),
    ),
)

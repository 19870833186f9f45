"""Duffing's equation, forced, hardening."""

import math

from peers.form import COLLOCATION, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, Symmetry, System


def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.force * math.cos(p.omega * t) - p.delta * x[1] - p.alpha * x[0] - p.beta * x[0] ** 3


def period(p):
    return 2 * math.pi / p.omega


def mirror(t, x, p, image):
    image[0] = -x[0]
    image[1] = -x[1]


SYSTEM = System(
    name="duffing",
    states=(
        State("x"),
        State("v"),
    ),
    parameters=(
        Parameter("omega", 0.6),
        Parameter("delta", 0.1),
        Parameter("alpha", 1.0),
        Parameter("beta", 1.0),
        Parameter("force", 0.5),
    ),
    modes=(Mode("smooth", field),),
    period=period,
    symmetries=(Symmetry("half_period_later", "spatial", mirror),),
    reference="Guckenheimer & Holmes (1983), section 2.2 and 4.2; Nayfeh & Mook (1979)",
)

PEER = Peer(
    "Duffing's equation, forced, hardening",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"simulate": {"state": {"x": 0, "v": 0}, "until": "settled"}},
                "parameters": {"omega": 2.5},
                "continue": {"parameter": "omega", "range": [0.8, 3.0]},
            },
            values=(
                Value("LP", 2.211935317019731, 1e-13, COLLOCATION, of="orbit"),
                Value("LP", 1.4386701455142776, 1e-13, COLLOCATION, of="orbit"),
            ),
        ),
    ),
)

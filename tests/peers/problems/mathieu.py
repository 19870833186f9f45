"""Mathieu's equation with damping."""

import math

from peers.form import MONODROMY, Peer, Study, Value

from contwalk.system import Mode, Parameter, Start, State, System


def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.c * x[1] - (p.delta + p.eps * math.cos(t)) * x[0] - x[0] ** 3


def period(p):
    return 2 * math.pi


def mirror(t, x, p, image):
    image[0] = -x[0]
    image[1] = -x[1]


SYSTEM = System(
    name="mathieu",
    states=(
        State("x"),
        State("v"),
    ),
    parameters=(
        Parameter("delta", 0.5),
        Parameter("eps", 0.4),
        Parameter("c", 0.1),
    ),
    modes=(Mode("smooth", field),),
    period=period,
    starts=(Start("rest", lambda p: [[0.0, 0.0]]),),
    reference="Nayfeh & Mook (1979), section 5.2",
)

PEER = Peer(
    "Mathieu's equation with damping",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"equilibrium": "rest"},
                "continue": {"parameter": "delta", "range": [0.01, 1.6]},
                "diagram": {"follow": ["PD"], "depth": 0},
            },
            values=(
                Value("PD", 0.42136755413838645, 1e-12, MONODROMY, of="orbit"),
                Value("PD", 0.03861559853918548, 3e-12, MONODROMY, of="orbit"),
            ),
        ),
    ),
)

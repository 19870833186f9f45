"""Predator and prey with seasons."""

import math

from peers.form import COLLOCATION, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    b = p.b0 * (1 + p.eps * math.cos(2 * math.pi * t))
    eaten = p.a * x[0] * x[1] / (b + x[0])
    dx[0] = p.r * x[0] * (1 - x[0] / p.K) - eaten
    dx[1] = p.e * eaten - p.d * x[1]


def period(p):
    return 1.0


SYSTEM = System(
    name="forced_predator_prey",
    states=(
        State("x"),
        State("y"),
    ),
    parameters=(
        Parameter("r", 6.283185307179586),
        Parameter("K", 1.0),
        Parameter("a", 12.566370614359172),
        Parameter("b0", 0.25),
        Parameter("eps", 0.2),
        Parameter("e", 1.0),
        Parameter("d", 6.283185307179586),
    ),
    modes=(Mode("smooth", field),),
    period=period,
    reference=(
        "Kuznetsov, Muratori & Rinaldi (1992), Int. J. Bif. Chaos 2, 117; Veltz, BifurcationKit.jl,"
        " tutorial Periodic predator-prey model"
    ),
)

PEER = Peer(
    "Predator and prey with seasons",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"simulate": {"state": {"x": 0.6, "y": 0.2}, "until": "settled"}},
                "parameters": {"b0": 0.4},
                "continue": {"parameter": "b0", "range": [0.05, 0.6]},
                "diagram": {"depth": 2},
            },
            values=(Value("NS", 0.335617425787725, 1e-13, COLLOCATION, of="orbit", period=1.0),),
        ),
    ),
)

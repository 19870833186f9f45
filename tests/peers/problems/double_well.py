"""Duffing's equation with two wells, forced."""

import math

from peers.form import COLLOCATION, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.force * math.cos(p.omega * t) - p.delta * x[1] + x[0] - x[0] ** 3


def period(p):
    return 2 * math.pi / p.omega


SYSTEM = System(
    name="double_well",
    states=(
        State("x"),
        State("v"),
    ),
    parameters=(
        Parameter("omega", 1.0),
        Parameter("delta", 0.25),
        Parameter("force", 0.1),
    ),
    modes=(Mode("smooth", field),),
    period=period,
    reference="Guckenheimer & Holmes (1983), section 2.2",
)

PEER = Peer(
    "Duffing's equation with two wells, forced",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"simulate": {"state": {"x": 1, "v": 0}, "until": "settled"}},
                "continue": {"parameter": "force", "range": [0.02, 0.35]},
                "diagram": {"depth": 2},
            },
            values=(
                Value("LP", 0.26497948248118525, 1e-13, COLLOCATION, of="orbit"),
                Value("LP", 0.15980208604366727, 1e-13, COLLOCATION, of="orbit"),
                Value("PD", 0.18174237954192501, 1e-13, COLLOCATION, of="orbit"),
                Value("PD", 0.18797847420995004, 1e-13, COLLOCATION, of="orbit"),
                Value("PD", 0.18932435708013984, 1e-13, COLLOCATION, of="orbit"),
            ),
            long=True,
        ),
    ),
)

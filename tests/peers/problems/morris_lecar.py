"""Morris-Lecar, set of the Hopf case."""

import math

from peers.form import COLLOCATION, FORTY_DIGITS, Ending, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    m = 0.5 * (1 + math.tanh((x[0] - p.V1) / p.V2))
    w = 0.5 * (1 + math.tanh((x[0] - p.V3) / p.V4))
    rate = p.phi * math.cosh((x[0] - p.V3) / (2 * p.V4))
    dx[0] = (p.I - p.gL * (x[0] - p.VL) - p.gK * x[1] * (x[0] - p.VK) - p.gCa * m * (x[0] - p.VCa)) / p.C
    dx[1] = rate * (w - x[1])


SYSTEM = System(
    name="morris_lecar",
    states=(
        State("V"),
        State("w"),
    ),
    parameters=(
        Parameter("I", 0.0),
        Parameter("C", 20.0),
        Parameter("gL", 2.0),
        Parameter("gK", 8.0),
        Parameter("gCa", 4.4),
        Parameter("VL", -60.0),
        Parameter("VK", -84.0),
        Parameter("VCa", 120.0),
        Parameter("V1", -1.2),
        Parameter("V2", 18.0),
        Parameter("V3", 2.0),
        Parameter("V4", 30.0),
        Parameter("phi", 0.04),
    ),
    modes=(Mode("smooth", field),),
    reference="Morris & Lecar (1981); parameters of Rinzel & Ermentrout (1998)",
)

PEER = Peer(
    "Morris-Lecar, set of the Hopf case",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"state": {"V": -60.855, "w": 0.0149}},
                "continue": {"parameter": "I", "range": [0.0, 300.0]},
            },
            values=(
                Value("HB", 93.85761837372544, 1e-15, FORTY_DIGITS, criticality="subcritical"),
                Value("HB", 212.01881610037435, 1e-15, FORTY_DIGITS, criticality="subcritical"),
                Value("LP", 88.29325054306928, 1e-13, COLLOCATION, of="orbit"),
                Value("LP", 216.89980138941146, 1e-13, COLLOCATION, of="orbit"),
            ),
            endings=(Ending("shrunk", "the Hopf point at 212.02", 212.018816, 5e-2),),
            long=True,
        ),
    ),
)

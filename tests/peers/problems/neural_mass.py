"""Tsodyks-Markram neural mass with short-term plasticity."""

import math

from peers.form import FORTY_DIGITS, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    drive = p.J * x[2] * x[1] * x[0] + p.E0
    rate = p.alpha * math.log(1 + math.exp(drive / p.alpha))
    dx[0] = (-x[0] + rate) / p.tau
    dx[1] = (1 - x[1]) / p.tauD - x[2] * x[1] * x[0]
    dx[2] = (p.U0 - x[2]) / p.tauF + p.U0 * (1 - x[2]) * x[0]


SYSTEM = System(
    name="neural_mass",
    states=(
        State("E"),
        State("x"),
        State("u"),
    ),
    parameters=(
        Parameter("E0", -2.0),
        Parameter("alpha", 1.5),
        Parameter("tau", 0.013),
        Parameter("J", 3.07),
        Parameter("tauD", 0.2),
        Parameter("U0", 0.3),
        Parameter("tauF", 1.5),
    ),
    modes=(Mode("smooth", field),),
    reference=(
        "Cortes et al. (2013), PNAS 110, 16610; Veltz, BifurcationKit.jl, tutorial Neural mass equation"
    ),
)

PEER = Peer(
    "Tsodyks-Markram neural mass with short-term plasticity",
    SYSTEM.reference,
    (
        Study(
            "equilibria",
            {
                "start": {"state": {"E": 0.238616, "x": 0.982747, "u": 0.367876}},
                "continue": {"parameter": "E0", "range": [-2.5, -0.9]},
                "diagram": {"follow": ["BP"]},
            },
            values=(
                Value("LP", -1.4630273255426933, 1e-15, FORTY_DIGITS),
                Value("HB", -1.8501245947675644, 1e-15, FORTY_DIGITS, criticality="subcritical"),
                Value("LP", -1.8652239103390462, 1e-15, FORTY_DIGITS),
                Value("HB", -1.1510593969186687, 1e-15, FORTY_DIGITS, criticality="subcritical"),
            ),
        ),
    ),
)

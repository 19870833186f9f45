"""Extended Lorenz-84."""

from peers.form import FORTY_DIGITS, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = -(x[1] ** 2) - x[2] ** 2 - p.alpha * x[0] + p.alpha * p.F - p.gamma * x[3] ** 2
    dx[1] = x[0] * x[1] - p.beta * x[0] * x[2] - x[1] + p.G
    dx[2] = p.beta * x[0] * x[1] + x[0] * x[2] - x[2]
    dx[3] = -p.delta * x[3] + p.gamma * x[3] * x[0] + p.T


SYSTEM = System(
    name="extended_lorenz84",
    states=(
        State("X"),
        State("Y"),
        State("Z"),
        State("U"),
    ),
    parameters=(
        Parameter("F", 1.7),
        Parameter("alpha", 0.25),
        Parameter("beta", 1.0),
        Parameter("G", 0.25),
        Parameter("delta", 1.04),
        Parameter("gamma", 0.987),
        Parameter("T", 0.04),
    ),
    modes=(Mode("smooth", field),),
    reference=(
        "Van Veen (2003); Kuznetsov, Meijer & Van Veen (2004), Int. J. Bif. Chaos 14, 2253; Veltz, "
        "BifurcationKit.jl, tutorial Extended Lorenz-84 model"
    ),
)

PEER = Peer(
    "Extended Lorenz-84",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {
                    "state": {
                        "X": 2.9787004394953343,
                        "Y": -0.03868302503393752,
                        "Z": 0.058232737694740085,
                        "U": -0.02105288273117459,
                    }
                },
                "parameters": {"F": 3.0},
                "continue": {"parameter": "F", "range": [0.5, 4.0]},
                "diagram": {"follow": ["BP"]},
            },
            values=(
                Value("HB", 2.8598754127482886, 1e-15, FORTY_DIGITS, criticality="subcritical"),
                Value("HB", 2.467222123112747, 1e-15, FORTY_DIGITS, criticality="supercritical"),
                Value("HB", 1.6196578209425831, 1e-15, FORTY_DIGITS, criticality="subcritical"),
                Value("LP", 1.5466483725981277, 1e-15, FORTY_DIGITS),
            ),
        ),
    ),
)

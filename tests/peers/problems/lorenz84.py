"""Lorenz-84."""

from peers.form import FORTY_DIGITS, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = -(x[1] ** 2) - x[2] ** 2 - p.a * x[0] + p.a * p.F
    dx[1] = x[0] * x[1] - p.b * x[0] * x[2] - x[1] + p.G
    dx[2] = p.b * x[0] * x[1] + x[0] * x[2] - x[2]


SYSTEM = System(
    name="lorenz84",
    states=(
        State("X"),
        State("Y"),
        State("Z"),
    ),
    parameters=(
        Parameter("F", 3.0),
        Parameter("G", 0.25),
        Parameter("a", 0.25),
        Parameter("b", 4.0),
    ),
    modes=(Mode("smooth", field),),
    reference="Lorenz (1984), Tellus A 36, 98; Shilnikov, Nicolis & Nicolis (1995)",
)

PEER = Peer(
    "Lorenz-84",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "parameters": {"F": 0.5},
                "start": {"state": {"X": 0.47, "Y": 0.1, "Z": 0.1}},
                "continue": {"parameter": "F", "range": [0.0, 3.0]},
                "diagram": {"depth": 1},
            },
            values=(Value("HB", 1.0194089759970395, 1e-15, FORTY_DIGITS, criticality="supercritical"),),
        ),
    ),
)

"""Brusselator."""

from peers.form import FORTY_DIGITS, Ending, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = p.A - (p.B + 1) * x[0] + x[0] ** 2 * x[1]
    dx[1] = p.B * x[0] - x[0] ** 2 * x[1]


SYSTEM = System(
    name="brusselator",
    states=(
        State("X"),
        State("Y"),
    ),
    parameters=(
        Parameter("A", 1.0),
        Parameter("B", 3.0),
    ),
    modes=(Mode("smooth", field),),
    reference="Prigogine & Lefever (1968)",
)

PEER = Peer(
    "Brusselator",
    SYSTEM.reference,
    (
        Study(
            "feed A, from a simulation",
            {
                "parameters": {"A": 1.2},
                "start": {"simulate": {"state": {"X": 1.2, "Y": 2.6}, "until": "settled"}},
                "continue": {"parameter": "A", "range": [0.8, 2.0]},
            },
            values=(),
            endings=(
                Ending("shrunk", "closed form: A^2 = B - 1", 1.4142135623730951, 1e-2),
                Ending("shrunk", "the bound of the range", 0.8, 1e-12),
            ),
        ),
        Study(
            "control B",
            {
                "parameters": {"B": 1.5},
                "start": {"state": {"X": 1, "Y": 1.5}},
                "continue": {"parameter": "B", "range": [1.0, 4.0]},
            },
            values=(Value("HB", 2.0, 1e-15, FORTY_DIGITS, criticality="supercritical"),),
        ),
    ),
)

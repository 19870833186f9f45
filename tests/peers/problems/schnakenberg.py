"""Schnakenberg's reaction."""

from peers.form import FORTY_DIGITS, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = p.a - x[0] + x[0] ** 2 * x[1]
    dx[1] = p.b - x[0] ** 2 * x[1]


SYSTEM = System(
    name="schnakenberg",
    states=(
        State("u"),
        State("v"),
    ),
    parameters=(
        Parameter("a", 0.05),
        Parameter("b", 1.2),
    ),
    modes=(Mode("smooth", field),),
    reference="Schnakenberg (1979), J. Theor. Biol. 81, 389; closed form b - a = (a + b)^3",
)

PEER = Peer(
    "Schnakenberg's reaction",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"state": {"u": 1.25, "v": 0.768}},
                "continue": {"parameter": "b", "range": [0.05, 1.5]},
            },
            values=(
                Value("HB", 0.05103125788101082, 1e-15, FORTY_DIGITS, criticality="supercritical"),
                Value("HB", 0.8956492739235914, 1e-15, FORTY_DIGITS, criticality="supercritical"),
            ),
            long=True,
        ),
    ),
)

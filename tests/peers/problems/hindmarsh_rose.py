"""Hindmarsh-Rose."""

from peers.form import FORTY_DIGITS, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = x[1] - x[0] ** 3 + p.b * x[0] ** 2 - x[2] + p.I
    dx[1] = 1 - 5 * x[0] ** 2 - x[1]
    dx[2] = p.r * (p.s * (x[0] - p.xr) - x[2])


SYSTEM = System(
    name="hindmarsh_rose",
    states=(
        State("x"),
        State("y"),
        State("z"),
    ),
    parameters=(
        Parameter("I", 0.0),
        Parameter("b", 3.0),
        Parameter("r", 0.001),
        Parameter("s", 4.0),
        Parameter("xr", -1.618033988749895),
    ),
    modes=(Mode("smooth", field),),
    reference="Hindmarsh & Rose (1984), Proc. R. Soc. B 221, 87",
)

PEER = Peer(
    "Hindmarsh-Rose",
    SYSTEM.reference,
    (
        Study(
            "equilibria",
            {
                "start": {"state": {"x": -1.6, "y": -11.8, "z": 0.0}},
                "continue": {"parameter": "I", "range": [0.0, 6.0]},
                "diagram": {"follow": ["BP"]},
            },
            values=(
                Value("HB", 1.3419994541347324, 1e-15, FORTY_DIGITS, criticality="subcritical"),
                Value("HB", 5.471123309399256, 1e-15, FORTY_DIGITS, criticality="supercritical"),
            ),
        ),
    ),
)

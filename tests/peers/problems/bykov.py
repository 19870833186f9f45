"""CO oxidation on platinum."""

from peers.form import FORTY_DIGITS, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    z = 1 - x[0] - x[1] - x[2]
    dx[0] = 2 * p.q1 * z**2 - 2 * p.q5 * x[0] ** 2 - p.q3 * x[0] * x[1]
    dx[1] = p.q2 * z - p.q6 * x[1] - p.q3 * x[0] * x[1]
    dx[2] = p.q4 * z - p.k * p.q4 * x[2]


SYSTEM = System(
    name="bykov",
    states=(
        State("x"),
        State("y"),
        State("s"),
    ),
    parameters=(
        Parameter("q1", 2.5),
        Parameter("q2", 1.4707),
        Parameter("q3", 10.0),
        Parameter("q4", 0.0675),
        Parameter("q5", 1.0),
        Parameter("q6", 0.1),
        Parameter("k", 0.4),
    ),
    modes=(Mode("smooth", field),),
    reference="Bykov, Yablonskii & Kim (1978); MatCont's tutorial I",
)

PEER = Peer(
    "CO oxidation on platinum",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "parameters": {"q2": 0.5},
                "start": {"state": {"x": 0.35, "y": 0.05, "s": 0.4}},
                "continue": {"parameter": "q2", "range": [0.5, 2.0]},
                "diagram": {"follow": ["BP"]},
            },
            values=(
                Value("HB", 1.0409915695326164, 1e-15, FORTY_DIGITS, criticality="subcritical"),
                Value("LP", 1.0522002878699548, 1e-15, FORTY_DIGITS),
                Value("LP", 1.0420485053785267, 1e-15, FORTY_DIGITS),
                Value("HB", 1.0515574624577304, 1e-15, FORTY_DIGITS, criticality="subcritical"),
            ),
        ),
    ),
)

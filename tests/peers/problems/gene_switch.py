"""Griffith's autocatalytic gene."""

from peers.form import FORTY_DIGITS, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = -p.a * x[0] + x[1]
    dx[1] = x[0] ** 2 / (1 + x[0] ** 2) - p.b * x[1]


SYSTEM = System(
    name="gene_switch",
    states=(
        State("x"),
        State("y"),
    ),
    parameters=(
        Parameter("a", 0.3),
        Parameter("b", 1.0),
    ),
    modes=(Mode("smooth", field),),
    reference="Griffith (1971); Strogatz, Nonlinear Dynamics and Chaos, section 8.1: fold at a b = 1/2",
)

PEER = Peer(
    "Griffith's autocatalytic gene",
    SYSTEM.reference,
    (
        Study(
            "",
            {"start": {"state": {"x": 3.0, "y": 0.9}}, "continue": {"parameter": "a", "range": [0.2, 1.0]}},
            values=(Value("LP", 0.5, 1e-15, FORTY_DIGITS),),
        ),
    ),
)

"""Predator and prey of Rosenzweig and MacArthur."""

from peers.form import FORTY_DIGITS, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    eaten = p.c * x[0] * x[1] / (p.alpha + x[0])
    dx[0] = p.r * x[0] * (1 - x[0]) - eaten
    dx[1] = eaten - p.d * x[1]


SYSTEM = System(
    name="rosenzweig_macarthur",
    states=(
        State("x"),
        State("y"),
    ),
    parameters=(
        Parameter("r", 1.0),
        Parameter("c", 2.0),
        Parameter("d", 1.0),
        Parameter("alpha", 1.2),
    ),
    modes=(Mode("smooth", field),),
    reference=(
        "Kuznetsov (2004), Elements of Applied Bifurcation Theory, example 3.1; closed forms alpha "
        "= (c - d) / d and (c - d) / (c + d)"
    ),
)

PEER = Peer(
    "Predator and prey of Rosenzweig and MacArthur",
    SYSTEM.reference,
    (
        Study(
            "",
            {"start": {"state": {"x": 1, "y": 0}}, "continue": {"parameter": "alpha", "range": [0.15, 1.5]}},
            values=(
                Value("BP", 1.0, 1e-15, FORTY_DIGITS, kind="transcritical"),
                Value("HB", 0.3333333333333333, 1e-15, FORTY_DIGITS, criticality="supercritical"),
            ),
        ),
    ),
)

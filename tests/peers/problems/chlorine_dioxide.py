"""Chlorine dioxide, iodine and malonic acid."""

from peers.form import FORTY_DIGITS, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    shared = x[0] / (1 + x[0] ** 2)
    dx[0] = p.a - x[0] - 4 * x[1] * shared
    dx[1] = p.b * x[0] - p.b * x[1] * shared


SYSTEM = System(
    name="chlorine_dioxide",
    states=(
        State("x"),
        State("y"),
    ),
    parameters=(
        Parameter("a", 10.0),
        Parameter("b", 5.0),
    ),
    modes=(Mode("smooth", field),),
    reference=(
        "Lengyel & Epstein (1991); Strogatz, Nonlinear Dynamics and Chaos, example 8.3.1: b = 3a/5 - 25/a"
    ),
)

PEER = Peer(
    "Chlorine dioxide, iodine and malonic acid",
    SYSTEM.reference,
    (
        Study(
            "",
            {"start": {"state": {"x": 2, "y": 5}}, "continue": {"parameter": "b", "range": [1.0, 6.0]}},
            values=(Value("HB", 3.5, 1e-15, FORTY_DIGITS, criticality="supercritical"),),
        ),
    ),
)

"""Sel'kov's glycolysis."""

from peers.form import FORTY_DIGITS, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = -x[0] + p.a * x[1] + x[0] ** 2 * x[1]
    dx[1] = p.b - p.a * x[1] - x[0] ** 2 * x[1]


SYSTEM = System(
    name="selkov",
    states=(
        State("x"),
        State("y"),
    ),
    parameters=(
        Parameter("a", 0.08),
        Parameter("b", 0.2),
    ),
    modes=(Mode("smooth", field),),
    reference=(
        "Sel'kov (1968); Strogatz, Nonlinear Dynamics and Chaos, example 7.3.3: b^2 = (1 - 2a -+ "
        "sqrt(1 - 8a)) / 2"
    ),
)

PEER = Peer(
    "Sel'kov's glycolysis",
    SYSTEM.reference,
    (
        Study(
            "",
            {"start": {"state": {"x": 0.2, "y": 1.67}}, "continue": {"parameter": "b", "range": [0.1, 1.2]}},
            values=(
                Value("HB", 0.34641016151377546, 1e-15, FORTY_DIGITS, criticality="supercritical"),
                Value("HB", 0.848528137423857, 1e-15, FORTY_DIGITS, criticality="supercritical"),
            ),
        ),
    ),
)

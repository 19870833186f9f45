"""AUTO fhn: the Bonhoeffer-van der Pol equations."""

from peers.form import COLLOCATION, FORTY_DIGITS, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = p.c * (x[0] - x[0] ** 3 / 3 + x[1])
    dx[1] = -(x[0] - p.a + p.b * x[1]) / p.c


SYSTEM = System(
    name="fhn",
    states=(
        State("x"),
        State("y"),
    ),
    parameters=(
        Parameter("a", 0.0),
        Parameter("b", 0.8),
        Parameter("c", 3.0),
    ),
    modes=(Mode("smooth", field),),
    reference="AUTO-07p (Doedel et al.), demo fhn; FitzHugh (1961)",
)

PEER = Peer(
    "AUTO fhn: the Bonhoeffer-van der Pol equations",
    SYSTEM.reference,
    (
        Study(
            "",
            {"start": {"state": {"x": 0, "y": 0}}, "continue": {"parameter": "a", "range": [0.0, 1.0]}},
            values=(
                Value("HB", 0.4228176294241609, 1e-15, FORTY_DIGITS, criticality="subcritical"),
                Value("LP", 0.4305182449527249, 1e-13, COLLOCATION, of="orbit"),
            ),
        ),
    ),
)

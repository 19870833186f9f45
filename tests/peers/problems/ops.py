"""AUTO ops: a thermohaline model."""

from peers.form import FORTY_DIGITS, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = (-p.p4 * (x[0] ** 3 / 3 - x[0]) + (x[2] - x[0]) / p.p2 - x[1]) / p.p1
    dx[1] = x[0] - p.p3
    dx[2] = -(x[2] - x[0]) / p.p2


SYSTEM = System(
    name="ops",
    states=(
        State("x"),
        State("y"),
        State("z"),
    ),
    parameters=(
        Parameter("p1", 1.0),
        Parameter("p2", 8.0),
        Parameter("p3", 0.0),
        Parameter("p4", 1.0),
    ),
    modes=(Mode("smooth", field),),
    reference="AUTO-07p (Doedel et al.), demo ops",
)

PEER = Peer(
    "AUTO ops: a thermohaline model",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"state": {"x": 0, "y": 0, "z": 0}},
                "continue": {"parameter": "p3", "range": [-0.1, 2.0]},
            },
            values=(Value("HB", 0.9364574995137421, 1e-15, FORTY_DIGITS, criticality="supercritical"),),
        ),
    ),
)

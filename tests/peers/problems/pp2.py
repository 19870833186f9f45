"""AUTO pp2: predator and prey with harvesting."""

import math

from peers.form import FORTY_DIGITS, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = p.p2 * x[0] * (1 - x[0]) - x[0] * x[1] - p.quota * (1 - math.exp(-p.p3 * x[0]))
    dx[1] = -x[1] + p.p4 * x[0] * x[1]


SYSTEM = System(
    name="pp2",
    states=(
        State("fish"),
        State("sharks"),
    ),
    parameters=(
        Parameter("quota", 0.0),
        Parameter("p2", 3.0),
        Parameter("p3", 5.0),
        Parameter("p4", 3.0),
    ),
    modes=(Mode("smooth", field),),
    reference="AUTO-07p (Doedel et al.), demo pp2",
)

PEER = Peer(
    "AUTO pp2: predator and prey with harvesting",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"state": {"fish": 0, "sharks": 0}},
                "continue": {"parameter": "quota", "range": [0.0, 1.0]},
            },
            values=(
                Value("BP", 0.6, 1e-15, FORTY_DIGITS, kind="transcritical"),
                Value("BP", 0.8219043453739908, 1e-15, FORTY_DIGITS, kind="transcritical"),
                Value("LP", 0.8329293222341568, 1e-15, FORTY_DIGITS),
                Value("HB", 0.6715938474788318, 1e-15, FORTY_DIGITS, criticality="supercritical"),
            ),
            long=True,
        ),
    ),
)

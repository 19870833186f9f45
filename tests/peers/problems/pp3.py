"""AUTO pp3: a food chain of three with harvesting."""

import math

from peers.form import COLLOCATION, FORTY_DIGITS, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = x[0] * (1 - x[0]) - p.p4 * x[0] * x[1]
    dx[1] = -p.p2 * x[1] + p.p4 * x[0] * x[1] - p.p5 * x[1] * x[2] - p.p1 * (1 - math.exp(-p.p6 * x[1]))
    dx[2] = -p.p3 * x[2] + p.p5 * x[1] * x[2]


SYSTEM = System(
    name="pp3",
    states=(
        State("u1"),
        State("u2"),
        State("u3"),
    ),
    parameters=(
        Parameter("p1", 0.0),
        Parameter("p2", 0.25),
        Parameter("p3", 0.5),
        Parameter("p4", 4.0),
        Parameter("p5", 3.0),
        Parameter("p6", 5.0),
    ),
    modes=(Mode("smooth", field),),
    reference="AUTO-07p (Doedel et al.), demo pp3",
)

PEER = Peer(
    "AUTO pp3: a food chain of three with harvesting",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"state": {"u1": 1, "u2": 0, "u3": 0}},
                "continue": {"parameter": "p1", "range": [0.0, 1.0]},
            },
            values=(
                Value("BP", 0.75, 1e-15, FORTY_DIGITS, kind="transcritical"),
                Value("HB", 0.10641506157437121, 1e-15, FORTY_DIGITS, criticality="supercritical"),
                Value("BP", 0.3193402608060465, 1e-15, FORTY_DIGITS, kind="transcritical"),
                Value("HB", 0.4596001119006839, 1e-15, FORTY_DIGITS, criticality="supercritical"),
                Value("LP", 0.8278426146357348, 1e-15, FORTY_DIGITS),
                Value("BP", 0.3012348912840097, 1e-13, COLLOCATION, of="orbit", kind="transcritical"),
                Value("HB", 0.22935697699150545, 1e-15, FORTY_DIGITS, criticality="supercritical"),
                Value("HB", 0.5038348000919475, 1e-15, FORTY_DIGITS, criticality="supercritical"),
            ),
            long=True,
        ),
    ),
)

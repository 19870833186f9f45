"""AUTO abc: A -> B -> C reaction in a stirred tank."""

import math

from peers.form import COLLOCATION, FORTY_DIGITS, Ending, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    e = math.exp(x[2])
    dx[0] = -x[0] + p.d * (1 - x[0]) * e
    dx[1] = -x[1] + p.d * e * (1 - x[0] - p.s * x[1])
    dx[2] = -x[2] - p.beta * x[2] + p.d * p.b * e * (1 - x[0] + p.alpha * p.s * x[1])


SYSTEM = System(
    name="abc",
    states=(
        State("u1"),
        State("u2"),
        State("u3"),
    ),
    parameters=(
        Parameter("d", 0.0),
        Parameter("alpha", 1.0),
        Parameter("beta", 1.55),
        Parameter("b", 8.0),
        Parameter("s", 0.04),
    ),
    modes=(Mode("smooth", field),),
    reference="AUTO-07p (Doedel et al.), demo abc",
)

PEER = Peer(
    "AUTO abc: A -> B -> C reaction in a stirred tank",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"state": {"u1": 0, "u2": 0, "u3": 0}},
                "continue": {"parameter": "d", "range": [0.0, 0.4]},
            },
            values=(
                Value("HB", 0.20418453570061365, 1e-15, FORTY_DIGITS, criticality="supercritical"),
                Value("HB", 0.22983903764846678, 1e-15, FORTY_DIGITS, criticality="supercritical"),
                Value("HB", 0.2599578542445167, 1e-15, FORTY_DIGITS, criticality="subcritical"),
                Value("HB", 0.3462085216073892, 1e-15, FORTY_DIGITS, criticality="supercritical"),
                Value("LP", 0.21369736921861118, 1e-13, COLLOCATION, of="orbit"),
                Value("LP", 0.21190327712341947, 1e-13, COLLOCATION, of="orbit"),
                Value("LP", 0.2249620655386473, 1e-13, COLLOCATION, of="orbit"),
            ),
            endings=(
                Ending("shrunk", "the Hopf point at 0.3462", 0.34620852, 2e-2),
                Ending("shrunk", "the Hopf point at 0.2600", 0.25995785, 3e-3),
            ),
            long=True,
        ),
    ),
)

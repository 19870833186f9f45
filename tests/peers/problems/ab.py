"""AUTO ab: A -> B reaction in a stirred tank."""

import math

from peers.form import COLLOCATION, FORTY_DIGITS, Ending, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    e = math.exp(x[1])
    dx[0] = -x[0] + p.p1 * (1 - x[0]) * e
    dx[1] = -x[1] + p.p1 * p.p2 * (1 - x[0]) * e - p.p3 * x[1]


SYSTEM = System(
    name="ab",
    states=(
        State("u1"),
        State("u2"),
    ),
    parameters=(
        Parameter("p1", 0.0),
        Parameter("p2", 14.0),
        Parameter("p3", 3.0),
    ),
    modes=(Mode("smooth", field),),
    reference="AUTO-07p (Doedel et al.), demo ab",
)

PEER = Peer(
    "AUTO ab: A -> B reaction in a stirred tank",
    SYSTEM.reference,
    (
        Study(
            "p2=14.0",
            {
                "parameters": {"p2": 14.0},
                "start": {"state": {"u1": 0, "u2": 0}},
                "continue": {"parameter": "p1", "range": [0.0, 0.25]},
            },
            values=(
                Value("HB", 0.16504204532356095, 1e-15, FORTY_DIGITS, criticality="subcritical"),
                Value("LP", 0.16169612889773735, 1e-13, COLLOCATION, of="orbit"),
            ),
            endings=(Ending("bound", "AUTO-07p", 0.25, 1e-12),),
        ),
        Study(
            "p2=15.0",
            {
                "parameters": {"p2": 15.0},
                "start": {"state": {"u1": 0, "u2": 0}},
                "continue": {"parameter": "p1", "range": [0.0, 0.25]},
            },
            values=(
                Value("HB", 0.146882475604236, 1e-15, FORTY_DIGITS, criticality="subcritical"),
                Value("LP", 0.1443312619644242, 1e-13, COLLOCATION, of="orbit"),
            ),
            endings=(Ending("bound", "AUTO-07p", 0.25, 1e-12),),
            long=True,
        ),
        Study(
            "p2=16.0",
            {
                "parameters": {"p2": 16.0},
                "start": {"state": {"u1": 0, "u2": 0}},
                "continue": {"parameter": "p1", "range": [0.0, 0.25]},
            },
            values=(
                Value("HB", 0.1325384442692152, 1e-15, FORTY_DIGITS, criticality="subcritical"),
                Value("LP", 0.1306373152261905, 2e-13, COLLOCATION, of="orbit"),
            ),
            endings=(Ending("bound", "AUTO-07p", 0.25, 1e-12),),
            long=True,
        ),
        Study(
            "p2=17.0",
            {
                "parameters": {"p2": 17.0},
                "start": {"state": {"u1": 0, "u2": 0}},
                "continue": {"parameter": "p1", "range": [0.0, 0.25]},
            },
            values=(
                Value("HB", 0.1208657195093891, 1e-15, FORTY_DIGITS, criticality="subcritical"),
                Value("LP", 0.12190116081078291, 1e-15, FORTY_DIGITS),
                Value("LP", 0.11701475042670385, 1e-15, FORTY_DIGITS),
                Value("HB", 0.2170805096962893, 1e-15, FORTY_DIGITS, criticality="supercritical"),
            ),
            endings=(
                Ending("homoclinic", "AUTO-07p to period 500 at two meshes", 0.12010169875, 2e-11),
                Ending("homoclinic", "AUTO-07p to period 500 at two meshes", 0.11945482404, 2e-11),
            ),
            long=True,
        ),
        Study(
            "p2=18.0",
            {
                "parameters": {"p2": 18.0},
                "start": {"state": {"u1": 0, "u2": 0}},
                "continue": {"parameter": "p1", "range": [0.0, 0.25]},
            },
            values=(
                Value("HB", 0.11115348418986419, 1e-15, FORTY_DIGITS, criticality="subcritical"),
                Value("LP", 0.11156508007421491, 1e-15, FORTY_DIGITS),
                Value("LP", 0.09957413673572789, 1e-15, FORTY_DIGITS),
                Value("HB", 0.18383460798598744, 1e-15, FORTY_DIGITS, criticality="supercritical"),
            ),
            endings=(
                Ending("homoclinic", "AUTO-07p to period 500 at two meshes", 0.11082863913, 2e-11),
                Ending("homoclinic", "AUTO-07p to period 500 at two meshes", 0.11011357816, 2e-11),
            ),
            long=True,
        ),
    ),
)

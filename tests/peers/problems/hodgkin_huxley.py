"""Hodgkin-Huxley."""

import math

from peers.form import COLLOCATION, FORTY_DIGITS, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    am = 0.1 * (25 - x[0]) / (math.exp((25 - x[0]) / 10) - 1)
    bm = 4 * math.exp(-x[0] / 18)
    ah = 0.07 * math.exp(-x[0] / 20)
    bh = 1 / (math.exp((30 - x[0]) / 10) + 1)
    an = 0.01 * (10 - x[0]) / (math.exp((10 - x[0]) / 10) - 1)
    bn = 0.125 * math.exp(-x[0] / 80)
    sodium = p.gNa * x[1] ** 3 * x[2] * (x[0] - p.VNa)
    dx[0] = (p.I - sodium - p.gK * x[3] ** 4 * (x[0] - p.VK) - p.gL * (x[0] - p.VL)) / p.C
    dx[1] = am * (1 - x[1]) - bm * x[1]
    dx[2] = ah * (1 - x[2]) - bh * x[2]
    dx[3] = an * (1 - x[3]) - bn * x[3]


SYSTEM = System(
    name="hodgkin_huxley",
    states=(
        State("v"),
        State("m"),
        State("h"),
        State("n"),
    ),
    parameters=(
        Parameter("I", 0.0),
        Parameter("gNa", 120.0),
        Parameter("gK", 36.0),
        Parameter("gL", 0.3),
        Parameter("VNa", 115.0),
        Parameter("VK", -12.0),
        Parameter("VL", 10.599),
        Parameter("C", 1.0),
    ),
    modes=(Mode("smooth", field),),
    reference="Hodgkin & Huxley (1952), J. Physiol. 117, 500; Rinzel & Miller (1980); Hassard (1978)",
)

PEER = Peer(
    "Hodgkin-Huxley",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"state": {"v": 0.0, "m": 0.053, "h": 0.596, "n": 0.318}},
                "continue": {"parameter": "I", "range": [0.0, 200.0]},
                "diagram": {"depth": 1},
            },
            values=(
                Value("HB", 9.779637995393122, 1e-15, FORTY_DIGITS, criticality="subcritical"),
                Value("HB", 154.52663366580802, 1e-15, FORTY_DIGITS, criticality="supercritical"),
                Value("LP", 7.846547120190422, 1e-13, COLLOCATION, of="orbit"),
                Value("PD", 7.84953739784827, 8e-12, COLLOCATION, of="orbit"),
                Value("PD", 7.921977675728317, 1e-13, COLLOCATION, of="orbit"),
                Value("LP", 7.921985494344324, 1e-13, COLLOCATION, of="orbit"),
                Value("LP", 6.264521274513733, 1e-13, COLLOCATION, of="orbit"),
            ),
        ),
    ),
)

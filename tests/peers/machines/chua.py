"""Chua's circuit: two coils and capacitors, and a resistor whose characteristic has three straight pieces.

Where x > 1 the equilibrium is at x = (m1 - m0) / (1 + m1), y = 0, z = -x. Its characteristic polynomial is
s^3 + (a + 1) s^2 + (a + beta - alpha) s + a beta with a = alpha (1 + m1), so that it has a Hopf point where
(a + 1) (a + beta - alpha) = a beta.
"""

import math

from peers.form import CLOSED_FORM, SHOOTING, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System, Transition

X, Y, Z = range(3)


def circuit(characteristic):
    def field(t, x, p, dx):
        dx[X] = p.alpha * (x[Y] - x[X] - characteristic(x[X], p))
        dx[Y] = x[X] - x[Y] + x[Z]
        dx[Z] = -p.beta * x[Y]

    return field


def corner(side):
    return lambda t, x, p: x[X] - side


SYSTEM = System(
    name="chua",
    states=(State("x"), State("y"), State("z")),
    parameters=(
        Parameter("alpha", 7.5),
        Parameter("beta", 14.28),
        Parameter("m0", -8.0 / 7.0),
        Parameter("m1", -5.0 / 7.0),
    ),
    modes=(
        Mode("right", circuit(lambda x, p: p.m1 * x + p.m0 - p.m1)),
        Mode("middle", circuit(lambda x, p: p.m0 * x)),
        Mode("left", circuit(lambda x, p: p.m1 * x + p.m1 - p.m0)),
    ),
    transitions=(
        Transition("in_right", "right", "middle", corner(1.0), "falling", role="soft"),
        Transition("out_right", "middle", "right", corner(1.0), "rising", role="soft"),
        Transition("out_left", "middle", "left", corner(-1.0), "falling", role="soft"),
        Transition("in_left", "left", "middle", corner(-1.0), "rising", role="soft"),
    ),
    reference="Chua, Komuro & Matsumoto (1986), IEEE Trans. CAS 33, 1072",
)

PEER = Peer(
    "Chua's circuit",
    SYSTEM.reference,
    (
        Study(
            "rest",
            {
                "start": {"state": {"x": 1.5, "y": 0.0, "z": -1.5}},
                "continue": {"parameter": "alpha", "range": [5.0, 8.0]},
                "diagram": {"depth": 0},
            },
            values=(Value("HB", (math.sqrt(35.0**2 + 1960.0 * 14.28) - 35.0) / 20.0, 1e-15, CLOSED_FORM),),
        ),
        Study(
            "around one equilibrium",
            {
                "start": {"simulate": {"state": {"x": 2.0, "y": 0.1, "z": -2.0}, "until": "settled"}},
                "continue": {"parameter": "alpha", "range": [6.9, 8.4]},
                "diagram": {"depth": 1},
            },
            values=(
                Value("PD", 8.1729001058277, 1e-12, SHOOTING, of="orbit", criticality="supercritical"),
                Value("PD", 8.3968326570611, 1e-12, SHOOTING, of="orbit", criticality="supercritical"),
            ),
            long=True,
        ),
    ),
)

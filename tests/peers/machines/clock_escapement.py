"""Pendulum clock: friction takes energy, and the escapement's push at the lowest place gives it back.

x'' + 2 z x' + x = 0; at x = 0 with x' > 0 the velocity grows by J. The guard x goes on in the direction in
which it has passed zero, so there is a mode for either side. The speed before a push obeys
u = (u + J) e^(-2 pi z / w), w = sqrt(1 - z^2): one orbit, its amplitude in closed form.
"""

import math

from peers.form import CLOSED_FORM, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System, Transition


def field(t, x, p, dx):
    dx[0], dx[1] = x[1], -x[0] - 2.0 * p.z * x[1]


def push(t, x, p, x_plus):
    x_plus[0], x_plus[1] = x[0], x[1] + p.J


SYSTEM = System(
    name="clock",
    states=(State("x"), State("v")),
    parameters=(Parameter("J", 0.1), Parameter("z", 0.02)),
    modes=(Mode("left", field), Mode("right", field)),
    transitions=(
        Transition("tick", "left", "right", lambda t, x, p: x[0], direction="rising", reset=push),
        Transition("tock", "right", "left", lambda t, x, p: x[0]),
    ),
    reference="Andronov, Vitt & Khaikin (1966), Theory of Oscillators, ch. III",
)

DECAY = math.exp(-2.0 * math.pi * 0.02 / math.sqrt(1.0 - 0.02**2))


def largest(push: float) -> float:
    """The largest deflection of the orbit with this push: at tan(w t) = w / z after it."""
    w, after = math.sqrt(1.0 - 0.02**2), push / (1.0 - DECAY)
    quarter = math.atan2(w, 0.02) / w
    return after * math.exp(-0.02 * quarter) * math.sin(w * quarter) / w


PEER = Peer(
    "Pendulum clock",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"simulate": {"state": {"x": -0.5, "v": 0.0}, "until": "settled"}},
                "continue": {"parameter": "J", "range": [0.05, 0.2]},
                "mark": {"max:x": [1.2]},
            },
            values=(Value("UZ", 0.1 * 1.2 / largest(0.1), 1e-14, CLOSED_FORM, of="orbit"),),
            long=True,
        ),
    ),
)

"""Shaken mass with dry friction that holds more than it brakes.

x'' + x = cos(omega t) - 2 zeta x' - K sign(x') while it moves; at rest it stays as long as the other forces
are between -S and S, with S > K. Above 0.597 it stops for an instant only. Below 0.576 it rests twice in a
period; in between the branch of these motions turns unstable where two cross it that rest unequally.
"""

import numpy as np
from peers.form import SHOOTING, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System, Transition


def force(t, x, p):
    """All that acts on the mass but friction, where it stands still."""
    return np.cos(p.omega * t) - x[0]


def sliding(side):
    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = force(t, x, p) - 2.0 * p.zeta * x[1] - side * p.kinetic

    return field


def rest(t, x, p, dx):
    dx[0] = dx[1] = 0.0 * x[0]


def velocity(t, x, p):
    return x[1]


def stop(t, x, p, x_plus):
    x_plus[0], x_plus[1] = x[0], 0.0 * x[1]


SYSTEM = System(
    name="shaken_friction",
    states=(State("x"), State("v")),
    parameters=(
        Parameter("omega", 0.8),
        Parameter("zeta", 0.05),
        Parameter("kinetic", 0.3),
        Parameter("static", 0.5),
    ),
    modes=(Mode("stick", rest), Mode("right", sliding(1.0)), Mode("left", sliding(-1.0))),
    transitions=(
        Transition("stops", "right", "stick", velocity, "falling", reset=stop),
        Transition("halts", "left", "stick", velocity, "rising", reset=stop),
        Transition(
            "goes_right", "stick", "right", lambda t, x, p: force(t, x, p) - p.static, "rising", level=True
        ),
        Transition(
            "goes_left", "stick", "left", lambda t, x, p: force(t, x, p) + p.static, "falling", level=True
        ),
    ),
    period=lambda p: 2.0 * np.pi / p.omega,
    reference="Shaw (1986), J. Sound Vib. 108, 305",
)

PEER = Peer(
    "Friction oscillator, shaken",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"simulate": {"state": {"x": 0.0, "v": 0.0}, "mode": "stick", "until": "settled"}},
                "continue": {"parameter": "omega", "range": [0.4, 2.0]},
                "events": {"GR": "switch", "OC": "switch"},
                "diagram": {"follow": "none", "depth": 3},
            },
            values=(
                # Both phases of rest begin to last, or one of them: three branches leave.
                Value("OC", 0.59726895158913, 1e-12, SHOOTING, of="orbit"),
                Value("BP", 0.5768321385756, 1e-12, SHOOTING, of="orbit", kind="pitchfork", times=2),
                # The other one begins to last too.
                Value("OC", 0.5756300050682, 1e-12, SHOOTING, of="orbit", times=3),
            ),
            long=True,
        ),
    ),
)

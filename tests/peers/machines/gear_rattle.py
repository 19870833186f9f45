"""Gear rattle: a loose gear moves in its backlash between the flanks of a gear that turns unevenly.

s is the way from the driving flank: s'' = -drag - beta s' + A omega^2 sin(omega t), impacts at s = 0 and
at s = backlash.
"""

import numpy as np
from peers.form import SHOOTING, Ending, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System, Transition


def loose(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.drag - p.beta * x[1] + p.A * p.omega**2 * np.sin(p.omega * t)


def driving_flank(t, x, p):
    return x[0]


def back_flank(t, x, p):
    return p.backlash - x[0]


def strike(t, x, p, x_plus):
    x_plus[0], x_plus[1] = x[0], -p.r * x[1]


SYSTEM = System(
    name="gear_rattle",
    states=(State("s"), State("v")),
    parameters=(
        Parameter("A", 0.4),
        Parameter("omega", 1.0),
        Parameter("r", 0.6),
        Parameter("drag", 0.05),
        Parameter("beta", 0.1),
        Parameter("backlash", 1.0),
    ),
    modes=(Mode("loose", loose),),
    transitions=(
        Transition("drives", "loose", "loose", driving_flank, reset=strike),
        Transition("rattles", "loose", "loose", back_flank, reset=strike),
    ),
    period=lambda p: 2.0 * np.pi / p.omega,
    reference="Karagiannis & Pfeiffer (1991), Nonlinear Dynamics 2, 367",
)

PEER = Peer(
    "Gear rattle",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"simulate": {"state": {"s": 0.5, "v": 0.0}, "until": "settled"}},
                "continue": {"parameter": "A", "range": [0.2, 2.0]},
                "diagram": {"depth": 0},
            },
            values=(
                Value("PD", 0.440321317040863, 1e-13, SHOOTING, of="orbit", criticality="supercritical"),
                Value("GR", 0.622187960113685, 1e-13, SHOOTING, of="orbit", kind="interior"),
            ),
            endings=(Ending("grazing", "the driving flank is struck twice", 0.622187960113685, 1e-8),),
        ),
    ),
)

"""Pendulum whose pivot shakes."""

import math

from peers.form import COLLOCATION, MONODROMY, Peer, Study, Value

from contwalk.system import Mode, Parameter, Start, State, Symmetry, System


def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.c * x[1] - (1 + p.a * p.omega**2 * math.cos(p.omega * t)) * math.sin(x[0])


def period(p):
    return 2 * math.pi / p.omega


def mirror(t, x, p, image):
    image[0] = -x[0]
    image[1] = -x[1]


SYSTEM = System(
    name="pendulum",
    states=(
        State("theta"),
        State("v"),
    ),
    parameters=(
        Parameter("a", 0.1),
        Parameter("omega", 2.0),
        Parameter("c", 0.1),
    ),
    modes=(Mode("smooth", field),),
    period=period,
    symmetries=(Symmetry("mirror", "spatial", mirror),),
    starts=(Start("hanging", lambda p: [[0.0, 0.0]]),),
    reference="Clifford & Bishop (1994); Butikov (2001), Am. J. Phys. 69, 755",
)

PEER = Peer(
    "Pendulum whose pivot shakes",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"equilibrium": "hanging"},
                "continue": {"parameter": "a", "range": [0.01, 0.6]},
                "diagram": {"depth": 2},
            },
            values=(
                Value("PD", 0.05002733553721688, 1e-12, MONODROMY, of="orbit"),
                Value("PD", 0.33282496067803036, 1e-13, COLLOCATION, of="orbit", times=2),
                Value("BP", 0.3147357514810003, 1e-13, COLLOCATION, of="orbit", kind="symmetry-breaking"),
            ),
            long=True,
        ),
    ),
)

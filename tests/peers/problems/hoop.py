"""Bead on a rotating hoop."""

import math

from peers.form import CLOSED_FORM, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, Symmetry, System


def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = (-x[1] + math.sin(x[0]) * (p.gamma * math.cos(x[0]) - 1)) / p.eps


def mirror(t, x, p, image):
    image[0] = -x[0]
    image[1] = -x[1]


SYSTEM = System(
    name="stewart_bead",
    states=(
        State("phi"),
        State("v"),
    ),
    parameters=(
        Parameter("gamma", 0.5),
        Parameter("eps", 1.0),
    ),
    modes=(Mode("smooth", field),),
    symmetries=(Symmetry("mirror", "spatial", mirror),),
    reference="Strogatz, Nonlinear Dynamics and Chaos, section 3.5: gamma = 1",
)

PEER = Peer(
    "Bead on a rotating hoop",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"state": {"phi": 0.0, "v": 0.0}},
                "continue": {"parameter": "gamma", "range": [0.2, 3.0]},
            },
            values=(
                Value("BP", 1.0, 1e-16, CLOSED_FORM, kind="symmetry-breaking", criticality="supercritical"),
            ),
        ),
    ),
)

"""Rotor with an autobalancer: correction masses that roll freely in a ring and seek out the unbalance.

Isotropic suspension, any number of masses, in the frame that rotates with the rotor. Equations, types of
equilibria and parameters: `docs/systems/autobalancer.md`.
"""

from __future__ import annotations

import math

from contwalk.system import Choice, Family, Mode, State, System

from .drawing import make_draw
from .dynamics import make_field, make_neutral, make_symmetries
from .equilibria import make_starts
from .observables import make_observables
from .parameters import make_parameters, make_presets

REFERENCE = (
    "J. Adolfsson (1997), A Study of Stability in Autobalancing Systems using Multiple Correction Masses, KTH"
)
TURN = 2.0 * math.pi


def make_states(n: int) -> tuple[State, ...]:
    """q1 q2 beta1 .. betan, then their rates. The scales are those of Table 1: 2 m1 l1 / M is 0.02."""
    masses = range(1, n + 1)
    return (
        State("q1", "l1", scale=0.01, about="displacement AB along the unbalance (rotating frame)"),
        State("q2", "l1", scale=0.01, about="displacement AB across the unbalance (rotating frame)"),
        *(
            State(f"beta{i}", "rad", scale=1.0, about=f"angle of mass {i} from the unbalance", period=TURN)
            for i in masses
        ),
        State("q1_dot", "l1 sqrt(k/M)", scale=0.01, about="rate of q1"),
        State("q2_dot", "l1 sqrt(k/M)", scale=0.01, about="rate of q2"),
        *(
            State(f"beta{i}_dot", "sqrt(k/M)", scale=1.0, about=f"speed of mass {i} relative to the ring")
            for i in masses
        ),
    )


def build(masses: int, suspension: str) -> System:
    """The autobalancer with this number of masses; `suspension` has one value so far, `isotropic`."""
    return System(
        name="autobalancer",
        states=make_states(masses),
        parameters=make_parameters(masses),
        modes=(Mode("rolling", make_field(masses), about="all masses roll in the ring without slip"),),
        symmetries=make_symmetries(masses),
        neutral=make_neutral(masses),
        observables=make_observables(masses),
        starts=make_starts(masses),
        presets=make_presets(masses),
        draw=make_draw(masses),
        reference=REFERENCE,
        about=f"rotor on an {suspension} suspension with {masses} correction mass{'es' * (masses > 1)}",
    )


SYSTEM = Family(
    name="autobalancer",
    choices=(
        Choice("masses", 2, minimum=1, about="number of correction masses in the ring"),
        Choice(
            "suspension",
            "isotropic",
            allowed=("isotropic",),
            about="equal stiffness and damping in all directions",
        ),
    ),
    build=build,
    about="rotor with correction masses that roll freely in a ring",
)

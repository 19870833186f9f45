"""Rotor with an autobalancer: correction masses that roll freely in a ring and seek out the unbalance.

Any number of masses. On an isotropic suspension the equations are those of the frame that rotates with the
rotor, and autonomous; on an anisotropic one they are forced periodically. Equations, types of equilibria and
parameters: `docs/systems/autobalancer.md`.
"""

from __future__ import annotations

import math

from contwalk.system import Choice, Family, Mode, State, Study, System

from . import anisotropic, isotropic
from .balanced import make_balanced
from .drawing import make_draw
from .masses import make_exchanges, make_families
from .observables import make_observables
from .on_the_line import make_on_the_line
from .parameters import TABLE_1, TABLE_3, make_anisotropic_presets, make_isotropic_presets, make_parameters

REFERENCE = (
    "J. Adolfsson (1997), A Study of Stability in Autobalancing Systems using Multiple Correction Masses, KTH"
)
TURN = 2.0 * math.pi
ISOTROPIC, ANISOTROPIC = "isotropic", "anisotropic"


def make_states(n: int, first: str, second: str, frame: tuple[str, str]) -> tuple[State, ...]:
    """Displacements, beta1 .. betan, then their rates. Scales after Table 1: 2 m1 l1 / M is 0.02."""
    masses = range(1, n + 1)
    return (
        State(first, "l1", scale=0.01, about=f"displacement AB {frame[0]}"),
        State(second, "l1", scale=0.01, about=f"displacement AB {frame[1]}"),
        *(
            State(f"beta{i}", "rad", scale=1.0, about=f"angle of mass {i} from the unbalance", period=TURN)
            for i in masses
        ),
        State(f"{first}_dot", "l1 sqrt(k/M)", scale=0.01, about=f"rate of {first}"),
        State(f"{second}_dot", "l1 sqrt(k/M)", scale=0.01, about=f"rate of {second}"),
        *(
            State(f"beta{i}_dot", "sqrt(k/M)", scale=1.0, about=f"speed of mass {i} relative to the ring")
            for i in masses
        ),
    )


def build(masses: int, suspension: str) -> System:
    """The autobalancer with this number of masses on this suspension."""
    return (build_isotropic if suspension == ISOTROPIC else build_anisotropic)(masses)


def build_isotropic(n: int) -> System:
    """n masses, equal stiffness and damping in all directions: an autonomous system."""
    frame = ("along the unbalance (rotating frame)", "across the unbalance (rotating frame)")
    return System(
        name="autobalancer",
        states=make_states(n, "q1", "q2", frame),
        parameters=make_parameters(n, TABLE_1),
        modes=(Mode("rolling", isotropic.make_field(n), about="all masses roll in the ring without slip"),),
        symmetries=make_exchanges(n),
        neutral=(isotropic.make_rotation(n), *make_families(n)),
        observables=make_observables(n),
        starts=(make_balanced(n), *make_on_the_line(n)),
        presets=make_isotropic_presets(n),
        draw=make_draw(n, (("k", "c"),), rotating=True),
        reference=REFERENCE,
        about=_about(n, ISOTROPIC),
        # n masses can cancel a load m e of n m1 l1: there the balanced state ends in a pitchfork.
        study=Study("m", (0.001, 0.012 * n), {"equilibrium": "balanced"}, {"m": 0.005 * n}),
    )


def build_anisotropic(n: int) -> System:
    """n masses, stiffness and damping that differ along two directions: forced once a turn."""
    frame = ("along the first direction (at rest)", "along the second direction (at rest)")
    return System(
        name="autobalancer",
        states=make_states(n, "x1", "x2", frame),
        parameters=make_parameters(n, TABLE_3),
        modes=(Mode("rolling", anisotropic.make_field(n), about="all masses roll in the ring without slip"),),
        symmetries=(anisotropic.make_half_turn(n), *make_exchanges(n)),
        neutral=(anisotropic.make_rotation(n), *make_families(n)),
        period=anisotropic.period,
        observables=make_observables(n),
        starts=(make_balanced(n),),
        presets=make_anisotropic_presets(),
        draw=make_draw(n, (("k1", "c1"), ("k2", "c2")), rotating=False),
        reference=REFERENCE,
        about=_about(n, ANISOTROPIC),
    )


def _about(n: int, suspension: str) -> str:
    return f"rotor on an {suspension} suspension with {n} correction mass{'es' * (n > 1)}"


SYSTEM = Family(
    name="autobalancer",
    choices=(
        Choice("masses", 2, minimum=1, about="number of correction masses in the ring"),
        Choice(
            "suspension",
            ISOTROPIC,
            allowed=(ISOTROPIC, ANISOTROPIC),
            about="stiffness and damping equal in all directions, or given along two",
        ),
    ),
    build=build,
    about="rotor with correction masses that roll freely in a ring",
)

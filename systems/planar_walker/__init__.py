"""Planar passive walker with knees and rolling feet: it walks down a slope without any drive or control.

Equations, impacts, parameters and what a motion is checked for: `docs/systems/planar_walker.md`.
"""

from __future__ import annotations

import math
from typing import Any

from contwalk.system import Mode, Study, System, Transition

from . import three_link, two_link
from .checks import CONDITIONS, WATCHED
from .drawing import draw
from .impacts import reset_at_heel_strike, reset_at_knee_strike
from .observables import OBSERVABLES, SIGNALS
from .parameters import PARAMETERS, PRESETS
from .states import IN_THREE_LINK, IN_TWO_LINK, LEGS, Q1, Q2, Q3, STATES


def _knee_bend(t: Any, x: Any, p: Any) -> Any:
    """Flexion of the swing knee."""
    return x[Q3]


def _landing(t: Any, x: Any, p: Any) -> Any:
    """Zero where both feet of straight, open legs are on the ground (16)."""
    return x[Q1] + x[Q2] + 2.0 * math.atan2(p.lf, p.l1 + p.l2)


def _fallen(t: Any, x: Any, p: Any) -> Any:
    """Positive where the stance leg leans more than 60 degrees from the normal of the slope."""
    return 0.5 - math.cos(x[Q1])


SYSTEM = System(
    name="planar_walker",
    about="planar passive walker with knees and circular feet, walking down a slope",
    states=STATES,
    parameters=PARAMETERS,
    modes=(
        Mode(
            "three_link",
            three_link.field,
            about="the stance leg rolls with its knee locked, the knee of the swing leg is free",
            states=IN_THREE_LINK,
        ),
        Mode(
            "two_link",
            two_link.field,
            about="both knees are locked",
            states=IN_TWO_LINK,
        ),
    ),
    transitions=(
        Transition(
            "knee_strike",
            "three_link",
            "two_link",
            _knee_bend,
            reset=reset_at_knee_strike,
            about="the swing leg straightens, and its knee locks",
        ),
        Transition(
            "heel_strike",
            "two_link",
            "three_link",
            _landing,
            reset=reset_at_heel_strike,
            relabel="legs",
            about="the swing foot lands; the other leg lifts and its knee is let go",
        ),
        *WATCHED,
    ),
    symmetries=(LEGS,),
    observables=OBSERVABLES,
    signals=SIGNALS,
    conditions=CONDITIONS,
    presets=PRESETS,
    draw=draw,
    fallen=_fallen,
    # From the fold in which its gait is born, past its period doublings.
    study=Study(
        "alpha",
        (0.03, 0.2),
        {
            "simulate": {
                "state": {"q1": -0.5196, "q2": 0.1528388, "u1": -1.933, "u2": -2.037},
                "at": "heel_strike",
                "until": "settled",
            }
        },
        {"alpha": 0.09},
        {"GR": "ignore", "OC": "switch", "AZ": "ignore"},
    ),
    reference="J. Adolfsson, A. Nordmark (2000), Planar Passive Walkers: Code Implementation Issues, KTH",
)

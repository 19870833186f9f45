"""What must hold for the motion to be the walker's (sections 2.4 to 2.10). Positive is admissible.

Checks between impacts are watched guards, those at an impact are conditions.

While the knee is bent, the clearance (13) of the swing foot dips twice: behind the standing foot, where it
can scuff, and in front of it, where it can land before the knee is locked. Each dip has its own guard. It is
the clearance where the dip lies, and lifted in the other half of the swing, so as not to see the other dip.
"""

from __future__ import annotations

import math
from typing import Any

from contwalk.system import Condition, Transition

from . import three_link
from .impacts import heel_strike, knee_strike
from .limbs import stance_arm
from .plane import Vector, hanging
from .states import Q1, Q2, Q3, U1, U2

# How strongly a guard is lifted in the half that is not its own. It shifts no zero in its own half.
LIFT = 10.0


def swing_foot(x: Any, p: Any) -> Vector:
    """From the lowest point of the standing foot to that of the swinging one: way ahead, clearance (13)."""
    length = p.l1 + p.l2
    standing = hanging(x[Q1], p.lf, length)
    thigh, shank = hanging(x[Q2], 0.0, p.l2), hanging(x[Q2] - x[Q3], p.lf, p.l1)
    return thigh[0] + shank[0] - standing[0], thigh[1] + shank[1] - standing[1]


def hind_dip(t: Any, x: Any, p: Any) -> Any:
    """Clearance of the swing foot while it is behind the standing one."""
    ahead, clearance = swing_foot(x, p)
    other_half = max(ahead, 0.0)
    return clearance + LIFT * other_half * other_half / (p.l1 + p.l2)


def front_dip(t: Any, x: Any, p: Any) -> Any:
    """Clearance of the swing foot while it is in front of the standing one and the knee is bent."""
    ahead, clearance = swing_foot(x, p)
    other_half = min(ahead, 0.0)
    return clearance + LIFT * other_half * other_half / (p.l1 + p.l2)


def hip_height(t: Any, x: Any, p: Any) -> Any:
    """Height of the hip above the slope (14)."""
    return stance_arm(x[Q1], p)[1]


def over_swing(t: Any, x: Any, p: Any) -> Any:
    """The knee folds up entirely where it is zero."""
    return math.pi - x[Q3]


def legs_open(t: Any, x: Any, p: Any) -> Any:
    """Angle by which the swing leg is in front of the stance leg."""
    return x[Q2] - x[Q1]


WATCHED = (
    Transition(
        "hind_dip", "three_link", "three_link", hind_dip, role="watched", about="the swing foot scuffs behind"
    ),
    Transition(
        "front_dip",
        "three_link",
        "three_link",
        front_dip,
        role="watched",
        about="the swing foot lands in front before its knee is locked",
    ),
    Transition(
        "over_swing", "three_link", "three_link", over_swing, role="watched", about="the swing knee folds up"
    ),
    Transition(
        "fall_three_link",
        "three_link",
        "three_link",
        hip_height,
        role="watched",
        about="the hip comes down",
    ),
    Transition(
        "fall_two_link", "two_link", "two_link", hip_height, role="watched", about="the hip comes down"
    ),
    Transition(
        "swing_back", "two_link", "two_link", legs_open, role="watched", about="the swing leg swings back"
    ),
)


def _knee_contact(t: Any, x: Any, p: Any) -> Any:
    return knee_strike(x, p).foot[1]


def _knee_friction(t: Any, x: Any, p: Any) -> Any:
    along, away = knee_strike(x, p).foot
    return p.mu * away - abs(along)


def _swing_knee_impulse(t: Any, x: Any, p: Any) -> Any:
    return knee_strike(x, p).other_knee


def _heel_contact(t: Any, x: Any, p: Any) -> Any:
    return heel_strike(x, p).foot[1]


def _heel_friction(t: Any, x: Any, p: Any) -> Any:
    along, away = heel_strike(x, p).foot
    return p.mu * away - abs(along)


def _front_knee_impulse(t: Any, x: Any, p: Any) -> Any:
    return heel_strike(x, p).stance_knee


def _hind_knee_impulse(t: Any, x: Any, p: Any) -> Any:
    return -heel_strike(x, p).other_knee


def _trailing_foot_lifts(t: Any, x: Any, p: Any) -> Any:
    """Equation 8, in the names after the impact: leg 2 trails, and its knee is straight."""
    length = p.l1 + p.l2
    trailing, standing = hanging(x[Q2], p.lf, length), hanging(x[Q1], p.lf, length)
    return x[U2] * trailing[0] - x[U1] * standing[0]


def _hind_knee_opens(t: Any, x: Any, p: Any) -> Any:
    return three_link.accelerations(x, p)[2]


CONDITIONS = (
    Condition(
        "knee_contact", _knee_contact, "knee_strike", unit="N s", about="impulse R_y on the standing foot"
    ),
    Condition(
        "knee_friction",
        _knee_friction,
        "knee_strike",
        unit="N s",
        about="mu R_y - |R_x| at the standing foot",
    ),
    Condition(
        "swing_knee_impulse",
        _swing_knee_impulse,
        "knee_strike",
        unit="N m s",
        about="impulse Q_2 of the stop on the knee that locks",
    ),
    Condition(
        "swing_leg_in_front", legs_open, "knee_strike", unit="rad", about="q2 - q1 where the knee locks"
    ),
    Condition(
        "heel_contact", _heel_contact, "heel_strike", unit="N s", about="impulse R_y on the landing foot"
    ),
    Condition(
        "heel_friction", _heel_friction, "heel_strike", unit="N s", about="mu R_y - |R_x| at the landing foot"
    ),
    Condition(
        "front_knee_impulse",
        _front_knee_impulse,
        "heel_strike",
        unit="N m s",
        about="impulse Q_1 of the stop on the knee of the landing leg",
    ),
    Condition(
        "hind_knee_impulse",
        _hind_knee_impulse,
        "heel_strike",
        unit="N m s",
        about="impulse -Q_2 of the lock on the knee of the trailing leg: it keeps the knee from bending",
    ),
    Condition(
        "trailing_foot_lifts",
        _trailing_foot_lifts,
        "heel_strike",
        side="after",
        unit="m/s",
        about="velocity of the trailing foot away from the slope (8)",
    ),
    Condition(
        "hind_knee_opens",
        _hind_knee_opens,
        "heel_strike",
        side="after",
        unit="rad/s2",
        about="acceleration u3' of the knee that is let go: it bends",
    ),
)

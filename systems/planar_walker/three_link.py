"""Three links: the stance leg rolls with its knee locked, the knee of the swing leg is free.

The equations are written for the rates of the limbs: u1 of the stance leg, u2 of the swinging thigh and
w = u2 - u3 of the swinging shank. With the arms a from the contact to the hip and k from the hip to the knee,
the first moments P1 of leg 1, Pt of thigh 2 and Pb of shank 2, and the moments of inertia I, It and Ib,

    [ M a.a + 2 a.P1 + I   a.Pt   a.Pb ] [u1']   [f1]
    [        a.Pt           It    k.Pb ] [u2'] = [f2]
    [        a.Pb          k.Pb    Ib  ] [w' ]   [f3]
"""

from __future__ import annotations

from typing import Any

from .limbs import (
    foot_centre_to_hip,
    hip_to_knee,
    leg_inertia,
    leg_moment,
    shank_inertia,
    shank_moment,
    stance_arm,
    thigh_inertia,
    thigh_moment,
    total_mass,
)
from .plane import combined, cross, dot, gravity
from .states import Q1, Q2, Q3, Q6, U1, U2, U3


def equations(x: Any, p: Any) -> tuple[tuple[Any, ...], tuple[Any, Any, Any]]:
    """Mass matrix (11, 12, 13, 22, 23, 33) and forces, in the rates u1, u2, w of the limbs."""
    u1, u2, w = x[U1], x[U2], x[U2] - x[U3]
    mass, weight = total_mass(p), gravity(p)
    arm, centre = stance_arm(x[Q1], p), foot_centre_to_hip(x[Q1], p)
    knee = hip_to_knee(x[Q2], p)
    stance, thigh, shank = leg_moment(x[Q1], p), thigh_moment(x[Q2], p), shank_moment(x[Q2] - x[Q3], p)

    matrix = (
        mass * dot(arm, arm) + 2.0 * dot(arm, stance) + leg_inertia(p),
        dot(arm, thigh),
        dot(arm, shank),
        thigh_inertia(p),
        dot(knee, shank),
        shank_inertia(p),
    )
    # The contact point moves along the slope with r_f u1; of the stance leg's own motion only that remains.
    rolling = p.rf * (mass * centre[0] + stance[0])
    forces = (
        cross(combined((mass, arm), (1.0, stance)), weight)
        - rolling * u1 * u1
        + cross(arm, thigh) * u2 * u2
        + cross(arm, shank) * w * w,
        cross(thigh, weight) + cross(thigh, centre) * u1 * u1 + cross(knee, shank) * w * w,
        cross(shank, weight) + cross(shank, centre) * u1 * u1 + cross(shank, knee) * u2 * u2,
    )
    return matrix, forces


def accelerations(x: Any, p: Any) -> tuple[Any, Any, Any]:
    """u1', u2', u3'. The mass matrix is positive definite, so it is eliminated without pivots."""
    (m11, m12, m13, m22, m23, m33), (f1, f2, f3) = equations(x, p)
    c13 = m13 / m33
    c23 = m23 / m33
    a11 = m11 - c13 * m13
    a12 = m12 - c13 * m23
    a22 = m22 - c23 * m23
    b1 = f1 - c13 * f3
    b2 = f2 - c23 * f3
    factor = a12 / a22
    stance = (b1 - factor * b2) / (a11 - factor * a12)
    thigh = (b2 - a12 * stance) / a22
    shank = (f3 - m13 * stance - m23 * thigh) / m33
    return stance, thigh, thigh - shank


def field(t: Any, x: Any, p: Any, dx: Any) -> None:
    """Equations of motion with a free swing knee."""
    stance, thigh, knee = accelerations(x, p)
    dx[Q1] = x[U1]
    dx[Q2] = x[U2]
    dx[Q3] = x[U3]
    dx[Q6] = 0.0
    dx[U1] = stance
    dx[U2] = thigh
    dx[U3] = knee

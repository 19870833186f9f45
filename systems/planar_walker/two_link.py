"""Two links: both knees are locked, the stance leg rolls and the swing leg turns about the hip."""

from __future__ import annotations

from typing import Any

from .limbs import foot_centre_to_hip, leg_inertia, leg_moment, stance_arm, total_mass
from .plane import combined, cross, dot, gravity
from .states import Q1, Q2, Q3, Q6, U1, U2, U3


def mass_matrix(stance: Any, swing: Any, p: Any) -> tuple[Any, Any, Any]:
    """Entries 11, 12, 22 of the mass matrix in the rates of a standing and another leg at these angles."""
    arm, inertia = stance_arm(stance, p), leg_inertia(p)
    return (
        total_mass(p) * dot(arm, arm) + 2.0 * dot(arm, leg_moment(stance, p)) + inertia,
        dot(arm, leg_moment(swing, p)),
        inertia,
    )


def solved(matrix: tuple[Any, Any, Any], right: tuple[Any, Any]) -> tuple[Any, Any]:
    """Solution of a symmetric positive definite pair of equations."""
    m11, m12, m22 = matrix
    factor = m12 / m22
    first = (right[0] - factor * right[1]) / (m11 - factor * m12)
    return first, (right[1] - m12 * first) / m22


def accelerations(x: Any, p: Any) -> tuple[Any, Any]:
    """u1', u2'."""
    mass, weight = total_mass(p), gravity(p)
    arm, centre = stance_arm(x[Q1], p), foot_centre_to_hip(x[Q1], p)
    stance, swing = leg_moment(x[Q1], p), leg_moment(x[Q2], p)
    rolling = p.rf * (mass * centre[0] + stance[0])
    forces = (
        cross(combined((mass, arm), (1.0, stance)), weight)
        - rolling * x[U1] * x[U1]
        + cross(arm, swing) * x[U2] * x[U2],
        cross(swing, weight) + cross(swing, centre) * x[U1] * x[U1],
    )
    return solved(mass_matrix(x[Q1], x[Q2], p), forces)


def field(t: Any, x: Any, p: Any, dx: Any) -> None:
    """Equations of motion with both knees locked."""
    stance, swing = accelerations(x, p)
    dx[Q1] = x[U1]
    dx[Q2] = x[U2]
    dx[Q3] = 0.0
    dx[Q6] = 0.0
    dx[U1] = stance
    dx[U2] = swing
    dx[U3] = 0.0

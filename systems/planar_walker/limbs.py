"""Where the limbs are and how their mass lies: arms and first moments, from which all equations are made.

Every limb turns about a joint, hip or knee. So its mass enters through its first moment about the joint, a
vector that turns with the limb, and its moment of inertia about the joint, a constant. The mass of a shank
pulls at the knee, and so belongs to the thigh too.
"""

from __future__ import annotations

from typing import Any

from .plane import Vector, combined, hanging


def total_mass(p: Any) -> Any:
    """Mass of the walker: two thighs and two shanks."""
    return 2.0 * (p.m1 + p.m2)


def stance_arm(q: Any, p: Any) -> Vector:
    """From the point where a straight leg at the angle q touches the ground to the hip.

    The foot rolls, so the walker turns about the contact: the hip has the velocity k x arm per unit rate.
    """
    x, y = foot_centre_to_hip(q, p)
    return x, y + p.rf


def foot_centre_to_hip(q: Any, p: Any) -> Vector:
    """From the centre of a straight leg's foot to the hip; its rate of change, k x itself, has no r_f."""
    x, y = hanging(q, p.lf, p.l1 + p.l2)
    return -x, -y


def hip_to_knee(q: Any, p: Any) -> Vector:
    """From the hip to the knee of a leg whose thigh is at the angle q."""
    return hanging(q, 0.0, p.l2)


def thigh_moment(q: Any, p: Any) -> Vector:
    """First moment about the hip of a thigh with the mass of its shank at the knee."""
    return hanging(q, p.m2 * p.l2x, p.m2 * p.l2y + p.m1 * p.l2)


def shank_moment(angle: Any, p: Any) -> Vector:
    """First moment about the knee of a shank at this angle (that of the thigh less the flexion)."""
    return hanging(angle, p.m1 * p.l1x, p.m1 * p.l1y)


def leg_moment(q: Any, p: Any) -> Vector:
    """First moment about the hip of a straight leg at the angle q."""
    return combined((1.0, thigh_moment(q, p)), (1.0, shank_moment(q, p)))


def thigh_inertia(p: Any) -> Any:
    """Moment of inertia about the hip of a thigh with the mass of its shank at the knee."""
    return p.i2 + p.m2 * (p.l2x * p.l2x + p.l2y * p.l2y) + p.m1 * p.l2 * p.l2


def shank_inertia(p: Any) -> Any:
    """Moment of inertia of a shank about the knee."""
    return p.i1 + p.m1 * (p.l1x * p.l1x + p.l1y * p.l1y)


def straight_coupling(p: Any) -> Any:
    """Coupling of thigh and shank of a straight leg: arm of the knee times first moment of the shank."""
    return p.m1 * p.l2 * p.l1y


def leg_inertia(p: Any) -> Any:
    """Moment of inertia of a straight leg about the hip."""
    return thigh_inertia(p) + shank_inertia(p) + 2.0 * straight_coupling(p)

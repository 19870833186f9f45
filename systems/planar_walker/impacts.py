"""Plastic impacts: the knee of the swing leg locks, or its foot lands. After both, both legs are straight.

The walker is taken as free at an impact. Impulses act at the foot that stands afterwards, on its material
contact point, and in the knees, which they hold locked: M (v+ - v-) = C r with C^T v+ = 0 (equations 2
to 7). In the rates of the legs, C drops out and a pair of equations remains. The impulses follow from what
the momenta have gained: that at the foot from the walker's linear momentum, those in the knees from the
angular momentum of each shank about its knee.

A linear momentum is written as k x S with S = sum of arm times mass and rate.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .limbs import (
    hip_to_knee,
    leg_inertia,
    leg_moment,
    shank_inertia,
    shank_moment,
    stance_arm,
    straight_coupling,
    total_mass,
)
from .plane import Vector, combined, cross, dot, quarter_turn
from .states import Q1, Q2, Q3, Q6, U1, U2, U3
from .two_link import mass_matrix, solved


@dataclass(frozen=True)
class Impact:
    """Rates after an impact, and the impulses.

    Attributes
    ----------
    stance, other : rate of the leg that stands after the impact, and of the other one, rad/s
    foot : impulse (R_x, R_y) of the ground on the standing foot, N s
    stance_knee, other_knee : impulses Q_1, Q_2 that hold the knees, N m s; positive ones bend a knee
    energy, lost : kinetic energy before the impact, and what of it is lost, J
    """

    stance: Any
    other: Any
    foot: Vector
    stance_knee: Any
    other_knee: Any
    energy: Any
    lost: Any


def knee_strike(x: Any, p: Any) -> Impact:
    """The swing knee locks: leg 1 stands, and all that changes comes from the speed u3 of the knee."""
    arm, stance, swing = stance_arm(x[Q1], p), leg_moment(x[Q1], p), leg_moment(x[Q2], p)
    shank = shank_moment(x[Q2], p)
    coupling, inertia = straight_coupling(p), shank_inertia(p)
    mass = mass_matrix(x[Q1], x[Q2], p)
    closing = x[U3]

    gain1, gain2 = solved(mass, (-closing * dot(arm, shank), -closing * (coupling + inertia)))
    base = combined((total_mass(p), arm), (1.0, stance))
    foot = quarter_turn(combined((gain1, base), (gain2, swing), (closing, shank)))
    # Angular momentum about the knee that the swinging and the standing shank gain.
    swinging = gain1 * dot(arm, shank) + gain2 * (coupling + inertia) + closing * inertia
    standing = gain1 * (dot(arm, shank_moment(x[Q1], p)) + coupling + inertia)

    # Before: the energy of straight legs and of the shank's own motion with -u3 relative to its thigh.
    m11, m12, m22 = mass
    along = dot(arm, shank) * x[U1] + (coupling + inertia) * x[U2]
    rigid = 0.5 * (m11 * x[U1] * x[U1] + m22 * x[U2] * x[U2]) + m12 * x[U1] * x[U2]
    energy = rigid - closing * along + 0.5 * inertia * closing * closing
    return Impact(
        stance=x[U1] + gain1,
        other=x[U2] + gain2,
        foot=foot,
        stance_knee=_standing_knee(x[Q1], arm, foot, standing, p),
        other_knee=-swinging,
        energy=energy,
        # A plastic impact loses the energy of the velocity it takes away.
        lost=0.5 * closing * swinging,
    )


def heel_strike(x: Any, p: Any) -> Impact:
    """The foot of leg 2 lands: leg 2 stands afterwards, and leg 1, whose knee is held still, trails."""
    before, after = stance_arm(x[Q1], p), stance_arm(x[Q2], p)
    trailing, landing = leg_moment(x[Q1], p), leg_moment(x[Q2], p)
    inertia, shank_about_hip = leg_inertia(p), straight_coupling(p) + shank_inertia(p)
    mass = total_mass(p)
    u1, u2 = x[U1], x[U2]

    linear = combined((u1, combined((mass, before), (1.0, trailing))), (u2, landing))
    momentum_landing = dot(after, linear) + dot(before, landing) * u1 + inertia * u2
    momentum_trailing = (dot(before, trailing) + inertia) * u1
    matrix = mass_matrix(x[Q2], x[Q1], p)
    stance, other = solved(matrix, (momentum_landing, momentum_trailing))

    gained = combined((stance, combined((mass, after), (1.0, landing))), (other, trailing), (-1.0, linear))
    foot = quarter_turn(gained)
    hip = combined((stance, after), (-u1, before))
    standing = dot(hip, shank_moment(x[Q2], p)) + shank_about_hip * (stance - u2)
    hind = dot(hip, shank_moment(x[Q1], p)) + shank_about_hip * (other - u1)

    m11, m12, m22 = mass_matrix(x[Q1], x[Q2], p)
    energy = 0.5 * (m11 * u1 * u1 + m22 * u2 * u2) + m12 * u1 * u2
    kept = 0.5 * (momentum_landing * stance + momentum_trailing * other)
    return Impact(
        stance=stance,
        other=other,
        foot=foot,
        stance_knee=_standing_knee(x[Q2], after, foot, standing, p),
        other_knee=-hind,
        energy=energy,
        lost=energy - kept,
    )


def _standing_knee(q: Any, arm: Vector, foot: Vector, gained: Any, p: Any) -> Any:
    """Impulse Q_1 in the knee of the standing leg: the ground's impulse turns its shank about the knee."""
    contact_to_knee = combined((1.0, arm), (1.0, hip_to_knee(q, p)))
    return -cross(contact_to_knee, foot) - gained


def reset_at_knee_strike(t: Any, x: Any, p: Any, x_plus: Any) -> None:
    """State just after the swing knee has locked."""
    impact = knee_strike(x, p)
    _with_straight_legs(x, impact.stance, impact.other, x_plus)


def reset_at_heel_strike(t: Any, x: Any, p: Any, x_plus: Any) -> None:
    """State just after leg 2 has landed, legs named as before it; the knee of leg 1 is let go at rest."""
    impact = heel_strike(x, p)
    _with_straight_legs(x, impact.other, impact.stance, x_plus)


def _with_straight_legs(x: Any, u1: Any, u2: Any, x_plus: Any) -> None:
    """Write the state of straight legs where they are, with these rates."""
    x_plus[Q1] = x[Q1]
    x_plus[Q2] = x[Q2]
    x_plus[Q3] = 0.0
    x_plus[Q6] = 0.0
    x_plus[U1] = u1
    x_plus[U2] = u2
    x_plus[U3] = 0.0

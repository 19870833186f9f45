"""How the limbs and the toes move: what equations of motion, events and observables have in common."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from . import bodies
from .frames import Attitude, Plane, Vector, attitude, directed, to_slope, turned
from .model import LOCKED, Model
from .states import KNEE, KNEE_RATE, Q2, Q4, Q7, Q9, THIGH_ANGLE, THIGH_RATE, U1, U2, U3, U4, U5, U6


@dataclass(frozen=True)
class Leg:
    """Directions and angular velocities of thigh and shank about the hip line, and the arm to the knee."""

    thigh: Plane
    shank: Plane
    thigh_rate: Any
    shank_rate: Any
    arm: Plane


@dataclass(frozen=True)
class Point:
    """A point of a shank in V: x along the hip line, its arm from the knee, and the whole way from T."""

    x: Any
    arm: Plane
    y: Any
    z: Any


def own_pitch(x: Any, frame: Attitude) -> Any:
    """Angular velocity of V itself about the hip line: -tan(q5) u6."""
    return -frame.tangent * x[U6]


def leg_of(x: Any, p: Any, number: int, frame: Attitude, model: Model) -> Leg:
    """How a leg hangs and turns."""
    thigh = directed(x[THIGH_ANGLE[number]])
    shank = directed(x[THIGH_ANGLE[number]] + x[KNEE[number]])
    thigh_rate = own_pitch(x, frame) + x[THIGH_RATE[number]]
    shank_rate = thigh_rate + x[KNEE_RATE[number]]
    return Leg(thigh, shank, thigh_rate, shank_rate, turned(bodies.knee(p, number, model), 0.0, thigh))


def torso_pitch(x: Any, model: Model) -> Any:
    """Angle of the torso about the hip line; with geared hips it bisects the thighs."""
    return 0.5 * (x[Q7] + x[Q9]) if model.hip == LOCKED else x[Q4]


def toe(hanging: Leg, p: Any, number: int, which: int, model: Model) -> Point:
    """Where a toe is."""
    x, y, z = bodies.toe(p, number, which, model)
    arm = turned(y, z, hanging.shank)
    return Point(x, arm, hanging.arm[0] + arm[0], hanging.arm[1] + arm[1])


def velocity(point: Point, hanging: Leg, x: Any) -> Vector:
    """Velocity of a point of a shank, in V."""
    thigh, shank = hanging.thigh_rate, hanging.shank_rate
    at_knee = x[U2] - thigh * hanging.arm[1], x[U3] + thigh * hanging.arm[0]
    return (
        x[U1] + (x[U5] * point.z - x[U6] * point.y),
        at_knee[0] + (x[U6] * point.x - shank * point.arm[1]),
        at_knee[1] + (shank * point.arm[0] - x[U5] * point.x),
    )


def toe_place(x: Any, p: Any, number: int, which: int, model: Model) -> Vector:
    """Place of a toe: to the side and downhill from T, and its height above the slope."""
    frame = attitude(x)
    point = toe(leg_of(x, p, number, frame, model), p, number, which, model)
    side, up, down = to_slope((point.x, point.y, point.z), frame)
    return side, x[Q2] + up, down


def toe_velocity(x: Any, p: Any, number: int, which: int, model: Model) -> Vector:
    """Velocity of a toe along the axes of the slope."""
    frame = attitude(x)
    hanging = leg_of(x, p, number, frame, model)
    return to_slope(velocity(toe(hanging, p, number, which, model), hanging, x), frame)


def torso_rate(x: Any, frame: Attitude, model: Model) -> Any:
    """Angular velocity of the torso about the hip line."""
    if model.hip == LOCKED:
        return own_pitch(x, frame) + 0.5 * (x[THIGH_RATE[1]] + x[THIGH_RATE[2]])
    return x[U4]

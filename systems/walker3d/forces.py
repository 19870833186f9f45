"""What acts on the walker besides gravity: the ground at its toes, its knees in hyperextension, its hips."""

from __future__ import annotations

from typing import Any

from .equations import SHANK, THIGH, TORSO, V1, V2, V3, W5, W6, Equations, force
from .frames import Attitude, Vector, from_slope, to_slope
from .model import CLIPPED, LOCKED, REBOUND, SPRUNG, TWO_SIDED, Model
from .motion import Leg, toe, velocity
from .states import KNEE, KNEE_RATE, LEGS, Q2, Q4, THIGH_ANGLE, THIGH_RATE, TOES, U4, anchor


def ground_force(
    place: Vector, speed: Vector, held: tuple[Any, Any], p: Any, end: str, model: Model
) -> Vector:
    """Force of the ground on a toe (16), along the axes of the slope.

    To the side and downhill a spring and a damper hold the toe to the place where it touched down; upwards a
    spring pushes it, and a damper where it moves into the ground. A toe that is off the ground has flags 0. A
    clipped force (Paper 7, 2.8.4, the second `toefy`) has a damper where it moves out of it too, and none at
    all where both together would pull.

    Parameters
    ----------
    place, speed : side, height, downhill; the place is relative to T but for the height
    held : anchor, side and downhill
    p : parameters and flags
    end : leg and toe, as `12`
    """
    on = getattr(p, f"on{end}")
    damped = on if model.ground_damper == TWO_SIDED else getattr(p, f"damped{end}")
    pressed, damping = on, damped * p.c_y
    if model.ground_damper == CLIPPED:
        pressed = getattr(p, f"pressed{end}")
        damping = damping + getattr(p, f"rising{end}") * p.c_y_rebound
    return (
        (on * p.k_x) * (held[0] - place[0]) - (on * p.c_x) * speed[0],
        -((pressed * p.k_y) * place[1] + damping * speed[1]),
        (on * p.k_z) * (held[1] - place[2]) - (on * p.c_z) * speed[2],
    )


def act_of_ground(
    equations: Equations, x: Any, p: Any, number: int, leg: Leg, frame: Attitude, model: Model
) -> None:
    """Add the forces of the ground on the toes of a leg."""
    at_knee: Vector = (0.0, 0.0, 0.0)
    for which in TOES:
        point = toe(leg, p, number, which, model)
        side, up, down = to_slope((point.x, point.y, point.z), frame)
        speed = to_slope(velocity(point, leg, x), frame)
        first, second = anchor(number, which)
        place, held = (side, x[Q2] + up, down), (x[first], x[second])
        f = from_slope(ground_force(place, speed, held, p, f"{number}{which}", model), frame)
        at_knee = (at_knee[0] + f[0], at_knee[1] + f[1], at_knee[2] + f[2])
        force(equations, W5, point.z * f[0] - point.x * f[2])
        force(equations, W6, point.x * f[1] - point.y * f[0])
        force(equations, SHANK[number], point.arm[0] * f[2] - point.arm[1] * f[1])
    for row, component in zip((V1, V2, V3), at_knee, strict=True):
        force(equations, row, component)
    force(equations, THIGH[number], leg.arm[0] * at_knee[2] - leg.arm[1] * at_knee[1])


def act_of_knee(equations: Equations, x: Any, p: Any, number: int, model: Model) -> None:
    """Add the torque in a knee in hyperextension (10): a spring, and a damper in both directions.

    With a rebound of its own (Paper 7, (12)) the damper is another one as the knee moves off its stop: with
    none it is a stop, with a strong one the knee sticks to it.
    """
    stop = getattr(p, f"stop{number}")
    damping = stop * p.c_knee
    if model.knee_damper == REBOUND:
        damping = damping + getattr(p, f"rebound{number}") * (p.c_knee_rebound - p.c_knee)
    torque = (stop * p.k_knee) * x[KNEE[number]] + damping * x[KNEE_RATE[number]]
    force(equations, SHANK[number], -torque)
    force(equations, THIGH[number], torque)


def act_of_hips(equations: Equations, x: Any, p: Any, model: Model) -> None:
    """Add the torques between torso and thighs (7) to (9); hips in gear have none.

    The damper takes u7 - u4, the rate of the thigh in V less that of the torso in N, as the source does.
    """
    if model.hip == LOCKED:
        return
    for number in LEGS:
        torque = p.c_hip * (x[THIGH_RATE[number]] - x[U4])
        if model.hip == SPRUNG:
            torque = torque + p.k_hip * (x[THIGH_ANGLE[number]] - x[Q4] - p.hip_rest)
        force(equations, THIGH[number], -torque)
        force(equations, TORSO, torque)

"""The vector field, one for all modes: what does not act in a mode is multiplied by its flag, 0."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .elimination import solved
from .equations import ORDER, SHANK, THIGH, TORSO, V1, V2, V3, W5, W6, free_walker
from .forces import act_of_ground, act_of_hips, act_of_knee
from .frames import attitude, gravity, to_slope
from .model import LOCKED, Model
from .motion import leg_of, own_pitch
from .states import (
    KNEE,
    KNEE_RATE,
    LEGS,
    Q1,
    Q2,
    Q3,
    Q4,
    Q5,
    Q6,
    THIGH_ANGLE,
    THIGH_RATE,
    TOES,
    U1,
    U2,
    U3,
    U4,
    U5,
    U6,
    anchor,
)


def make_field(model: Model) -> Callable[..., None]:
    """Vector field of a machine in all its modes; the flags of `contacts.flags` say what touches."""
    order = tuple(k for k in ORDER if k != TORSO or model.hip != LOCKED)

    def field(t: Any, x: Any, p: Any, dx: Any) -> None:
        frame = attitude(x)
        w1 = own_pitch(x, frame)
        legs = {number: leg_of(x, p, number, frame, model) for number in LEGS}
        equations = free_walker(x, p, model, frame, legs)
        for number, leg in legs.items():
            act_of_ground(equations, x, p, number, leg, frame, model)
            act_of_knee(equations, x, p, number, model)
        act_of_hips(equations, x, p, model)
        found = solved(equations.matrix, equations.forces, order)

        v1, v2, v3, u5, u6 = x[U1], x[U2], x[U3], x[U5], x[U6]
        g1, g2, g3 = gravity(frame, p)
        du5 = found[W5] + w1 * u6
        du6 = found[W6] - w1 * u5
        dw1 = -(u5 * u6 + frame.tangent * (frame.tangent * u5 * u6 + du6))
        dx[U1] = found[V1] + g1 - (u5 * v3 - u6 * v2)
        dx[U2] = found[V2] + g2 - (u6 * v1 - w1 * v3)
        dx[U3] = found[V3] + g3 - (w1 * v2 - u5 * v1)
        dx[U5] = du5
        dx[U6] = du6

        dx[Q1], dx[Q2], dx[Q3] = to_slope((v1, v2, v3), frame)
        dx[Q5] = u5
        dx[Q6] = u6 * frame.secant
        if model.hip != LOCKED:
            dx[Q4] = x[U4] - w1
            dx[U4] = found[TORSO]
        for number in LEGS:
            dx[THIGH_ANGLE[number]] = x[THIGH_RATE[number]]
            dx[KNEE[number]] = x[KNEE_RATE[number]]
            dx[THIGH_RATE[number]] = found[THIGH[number]] - dw1
            dx[KNEE_RATE[number]] = found[SHANK[number]] - found[THIGH[number]]
            for toe in TOES:
                side, down = anchor(number, toe)
                dx[side] = -dx[Q1]
                dx[down] = -dx[Q3]

    return field

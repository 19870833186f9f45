"""Where the centre of mass of the walker is."""

from __future__ import annotations

from typing import Any

from . import bodies
from .frames import Vector, attitude, directed, to_slope, turned
from .model import Model
from .motion import leg_of, torso_pitch
from .states import LEGS


def centre_of_mass(x: Any, p: Any, model: Model) -> Vector:
    """From T, along the axes of the slope: to the side, away from it and downhill.

    It is the sum of the first moments of the bodies over their mass. That of a shank is about its knee: what
    its mass does there belongs to its thigh.
    """
    frame = attitude(x)
    moments = [(bodies.torso(p, model), directed(torso_pitch(x, model)))]
    for number in LEGS:
        leg = leg_of(x, p, number, frame, model)
        moments += [(bodies.thigh(p, number, model), leg.thigh), (bodies.shank(p, number, model), leg.shank)]
    mass = bodies.total_mass(p, model)
    along = sum(body.first[0] for body, _ in moments) / mass
    across = [turned(body.first[1], body.first[2], direction) for body, direction in moments]
    return to_slope((along, sum(y for y, _ in across) / mass, sum(z for _, z in across) / mass), frame)

"""Turning vectors: a limb about axis 1 of V, and V against the slope N."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .states import Q5, Q6

Plane = tuple[Any, Any]
Vector = tuple[Any, Any, Any]


@dataclass(frozen=True)
class Attitude:
    """Cosines and sines of q5 and q6, 1 / cos(q5) and tan(q5)."""

    c5: Any
    s5: Any
    c6: Any
    s6: Any
    secant: Any
    tangent: Any


def attitude(x: Any) -> Attitude:
    """How V is turned."""
    c5, s5 = directed(x[Q5])
    secant = 1.0 / c5
    return Attitude(c5, s5, *directed(x[Q6]), secant, s5 * secant)


def to_slope(v: Vector, frame: Attitude) -> Vector:
    """Components along the axes of the slope of a vector given in V (1)."""
    level = frame.c5 * v[0] + frame.s5 * v[2]
    return (
        frame.c6 * level - frame.s6 * v[1],
        frame.s6 * level + frame.c6 * v[1],
        frame.c5 * v[2] - frame.s5 * v[0],
    )


def from_slope(n: Vector, frame: Attitude) -> Vector:
    """Components in V of a vector given along the axes of the slope."""
    level = frame.c6 * n[0] + frame.s6 * n[1]
    return (
        frame.c5 * level - frame.s5 * n[2],
        frame.c6 * n[1] - frame.s6 * n[0],
        frame.s5 * level + frame.c5 * n[2],
    )


def gravity(frame: Attitude, p: Any) -> Vector:
    """Acceleration of gravity, in V: it points into the slope and downhill."""
    return from_slope((0.0, -p.g * np.cos(p.alpha), p.g * np.sin(p.alpha)), frame)


def directed(angle: Any) -> Plane:
    """Cosine and sine of the angle of a limb."""
    return np.cos(angle), np.sin(angle)


def turned(y: Any, z: Any, direction: Plane) -> Plane:
    """Components in V of a vector across the hip line, given in the axes of a limb."""
    cosine, sine = direction
    return cosine * y - sine * z, sine * y + cosine * z

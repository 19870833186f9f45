"""Vectors in the plane of the walker as pairs: x down the slope, y away from it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

Vector = tuple[Any, Any]


def dot(a: Vector, b: Vector) -> Any:
    """a . b"""
    return a[0] * b[0] + a[1] * b[1]


def cross(a: Vector, b: Vector) -> Any:
    """Component of a x b out of the plane; also (k x a) . b with the unit vector k out of the plane."""
    return a[0] * b[1] - a[1] * b[0]


def combined(*terms: tuple[Any, Vector]) -> Vector:
    """Sum of factor times vector."""
    x, y = 0.0, 0.0
    for factor, vector in terms:
        x = x + factor * vector[0]
        y = y + factor * vector[1]
    return x, y


def quarter_turn(a: Vector) -> Vector:
    """k x a: the velocity, per unit rate, of a point that turns with the arm a."""
    return -a[1], a[0]


def hanging(angle: Any, forward: Any, down: Any) -> Vector:
    """A vector given in the frame of a limb at this angle: so far forward of it, so far down along it."""
    sine = np.sin(angle)
    cosine = np.cos(angle)
    return forward * cosine + down * sine, forward * sine - down * cosine


def gravity(p: Any) -> Vector:
    """Acceleration of gravity: the slope descends along x."""
    return p.g * math.sin(p.alpha), -p.g * math.cos(p.alpha)

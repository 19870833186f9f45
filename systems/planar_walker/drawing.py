"""A picture of the walker at one instant: limbs as lines, rolling feet, the slope as it is inclined.

The place on the slope follows from how far the stance foot has rolled, so pictures of one step fit together.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .limbs import foot_centre_to_hip, hip_to_knee
from .plane import Vector, hanging
from .states import Q1, Q2, Q3, Q6

STANCE, SWING, GROUND, JOINT = "#1f4e79", "#c0392b", "#5b6770", "white"
SOLE = 1.0  # half the angle of the sole at the centre of the foot, rad


def draw(axes: Any, t: float, x: Any, p: Any) -> None:
    """Draw the walker in the vertical plane, the slope descending to the right."""
    size = p.l1 + p.l2 + p.rf
    arm = foot_centre_to_hip(x[Q1], p)
    hip = (arm[0] - p.rf * x[Q1], arm[1] + p.rf)
    _draw_ground(axes, size, p.alpha)
    # The swing leg is behind the stance leg in the picture.
    _draw_leg(axes, hip, (x[Q2], x[Q2] - x[Q3]), p, SWING, 2)
    _draw_leg(axes, hip, (x[Q1], x[Q1] - x[Q6]), p, STANCE, 4)
    _draw_joint(axes, hip, p, 9.0)
    axes.set_aspect("equal")
    axes.set_xlim(-0.9 * size, 0.9 * size)
    axes.set_ylim(-0.3 * size, 1.15 * size)
    axes.set_axis_off()


def _upright(points: Any, alpha: float) -> tuple[Any, Any]:
    """Coordinates on the paper of points given along and away from the slope."""
    along, away = np.asarray(points, dtype=float).T
    sine, cosine = math.sin(alpha), math.cos(alpha)
    return along * cosine + away * sine, away * cosine - along * sine


def _draw_ground(axes: Any, size: float, alpha: float) -> None:
    ends = [(-3.0 * size, 0.0), (3.0 * size, 0.0)]
    x, y = _upright(ends, alpha)
    axes.fill_between(x, y, y - 0.06 * size, color=GROUND, alpha=0.18, linewidth=0.0, zorder=0)
    axes.plot(x, y, color=GROUND, linewidth=1.4, zorder=1)


def _draw_leg(axes: Any, hip: Vector, angles: Vector, p: Any, colour: str, layer: int) -> None:
    """Thigh and shank at these angles, and the foot: an arc about its centre, held by the ankle."""
    knee = np.add(hip, hip_to_knee(angles[0], p))
    ankle = knee + hanging(angles[1], 0.0, p.l1)
    centre = knee + hanging(angles[1], p.lf, p.l1)
    sole = [centre + hanging(angles[1] + turn, 0.0, p.rf) for turn in np.linspace(-SOLE, SOLE, 41)]
    foot = _upright([ankle, *sole], p.alpha)
    axes.fill(*foot, facecolor=colour, alpha=0.25, edgecolor="none", zorder=layer)
    axes.plot(*_upright([ankle, *sole, ankle], p.alpha), color=colour, linewidth=1.4, zorder=layer)
    limbs = _upright([hip, knee, ankle], p.alpha)
    axes.plot(*limbs, color=colour, linewidth=2.6, solid_capstyle="round", zorder=layer)
    _draw_joint(axes, knee, p, 6.0, layer)


def _draw_joint(axes: Any, place: Any, p: Any, size: float, layer: int = 5) -> None:
    x, y = _upright([place], p.alpha)
    axes.plot(x, y, marker="o", markersize=size, color=JOINT, markeredgecolor="black", zorder=layer + 1)

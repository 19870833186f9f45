"""A picture of the walker at one instant: limbs as lines, rolling feet, the slope as it is inclined.

The place on the slope follows from how far the stance foot has rolled, so pictures of one step fit together.
Where the motion until then is known, so do those of many steps, and each leg keeps its colour.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .limbs import foot_centre_to_hip, hip_to_knee
from .observables import rolled
from .plane import Vector, hanging
from .states import Q1, Q2, Q3, Q6

# Of the leg that stands, and of the one that swings; where legs keep their colours, when the motion begins.
STANDING, SWINGING = ("#1f4e79", "leg 1, standing"), ("#c0392b", "leg 2, swinging")
FIRST, SECOND = (STANDING[0], "leg that stands first"), (SWINGING[0], "the other leg")
EARTH, SURFACE, JOINT = "#e3e6e8", "#5b6770", "white"
SCENERY = "scenery"  # gid of what is there once, however many instants are drawn
REACH = 1.5  # how far the slope goes on beyond the hip, in sizes of the walker
SOLES = np.linspace(-1.0, 1.0, 41)  # angles of the sole at the centre of the foot, rad


def draw(axes: Any, t: float, x: Any, p: Any, so_far: Any = None) -> None:
    """Draw the walker in the vertical plane, the slope descending to the right.

    `so_far` is the motion until this instant: times, shape (k,), and states, shape (k, 7).
    """
    size = p.l1 + p.l2 + p.rf
    shift, swapped = (0.0, False) if so_far is None else walked(*so_far, p)
    hip = (shift + rolled(x[Q1], p), foot_centre_to_hip(x[Q1], p)[1] + p.rf)
    begins = hip[0] if so_far is None else float(rolled(so_far[1][0][Q1], p))
    _draw_ground(axes, size, p.alpha, min(begins, hip[0]), hip[0])
    stance, swing = (STANDING, SWINGING) if so_far is None else (FIRST, SECOND)
    if swapped:
        stance, swing = swing, stance
    # The leg that swings first is behind the other one in the picture.
    _draw_leg(axes, hip, (x[Q2], x[Q2] - x[Q3]), p, swing, 4 if swapped else 2)
    _draw_leg(axes, hip, (x[Q1], x[Q1] - x[Q6]), p, stance, 2 if swapped else 4)
    _draw_joint(axes, hip, p, 9.0)
    across, up = (float(number) for number in _upright((hip[0], 0.0), p.alpha))
    axes.set_aspect("equal")
    axes.set_xlim(across - 0.9 * size, across + 0.9 * size)
    axes.set_ylim(up - 0.3 * size, up + 1.15 * size)
    axes.set_axis_off()


def walked(t: Any, x: Any, p: Any) -> tuple[float, bool]:
    """How far the places of `rolled` have moved on in a motion, and whether the legs have changed names.

    At an impact two instants have one time, and the hip stays where it is.
    """
    t, x = np.asarray(t), np.asarray(x)
    at = np.flatnonzero(np.diff(t) == 0.0)
    before, after = x[at], x[at + 1]
    swaps = np.abs(after[:, Q1] - before[:, Q2]) < np.abs(after[:, Q1] - before[:, Q1])
    shifts = rolled(before[:, Q1], p) - rolled(after[:, Q1], p)
    return float(shifts.sum()), bool(swaps.sum() % 2)


def _upright(points: Any, alpha: float) -> tuple[Any, Any]:
    """Coordinates on the paper of points given along and away from the slope."""
    along, away = np.asarray(points, dtype=float).T
    sine, cosine = math.sin(alpha), math.cos(alpha)
    return along * cosine + away * sine, away * cosine - along * sine


def _draw_ground(axes: Any, size: float, alpha: float, first: float, last: float) -> None:
    """The slope as far as it has been walked on, with a peg at each round distance."""
    low, high = first - REACH * size, last + REACH * size
    x, y = _upright([(low, 0.0), (high, 0.0)], alpha)
    axes.fill_between(x, y, y - 0.06 * size, color=EARTH, linewidth=0.0, zorder=0, gid=SCENERY)
    axes.plot(x, y, color=SURFACE, linewidth=1.4, zorder=1, gid=SCENERY)
    distance, half = _round(0.14 * size), 0.006 * size
    numbers = np.arange(math.ceil(low / distance), math.floor(high / distance) + 1)
    places, told = numbers * distance, numbers % 5 == 0
    depth = np.where(told, 0.06, 0.03) * size
    sides = np.stack([places - half, places - half, places + half, places + half], axis=1)
    ends = np.stack([0.0 * depth, -depth, -depth, 0.0 * depth], axis=1)
    look = {"ha": "center", "va": "top", "color": SURFACE, "fontsize": 8, "rotation": -math.degrees(alpha)}
    named = np.stack([places[told], np.full(told.sum(), -0.09 * size)], axis=1)
    for place, across, up in zip(places[told], *_upright(named, alpha), strict=True):
        text = axes.text(across, up, f"{place:g} m", gid=SCENERY, clip_on=True, zorder=1, **look)
        text.set_in_layout(False)
    comb = np.stack([sides.ravel(), ends.ravel()], axis=1)
    axes.fill(*_upright(comb, alpha), color=SURFACE, linewidth=0.0, zorder=1, gid=SCENERY)


def _round(length: float) -> float:
    """The largest of 1, 2, 5, 10, .. that is no more than a length."""
    decade = 10.0 ** math.floor(math.log10(length))
    return decade * max(step for step in (1.0, 2.0, 5.0) if step * decade <= length * (1.0 + 1e-12))


def _draw_leg(axes: Any, hip: Vector, angles: Vector, p: Any, look: tuple[str, str], layer: int) -> None:
    """Thigh and shank at these angles, and the foot: an arc about its centre, held by the ankle."""
    colour, name = look
    knee = np.add(hip, hip_to_knee(angles[0], p))
    ankle = knee + hanging(angles[1], 0.0, p.l1)
    centre = knee + hanging(angles[1], p.lf, p.l1)
    turns = angles[1] + SOLES
    sole = centre + np.stack(hanging(turns, 0.0, p.rf), axis=1)
    across, up = _upright(np.vstack([ankle, sole, ankle]), p.alpha)
    axes.fill(across[:-1], up[:-1], facecolor=colour, alpha=0.25, edgecolor="none", zorder=layer)
    axes.plot(across, up, color=colour, linewidth=1.4, zorder=layer)
    limbs = _upright([hip, knee, ankle], p.alpha)
    axes.plot(*limbs, color=colour, linewidth=2.6, solid_capstyle="round", zorder=layer, label=name)
    _draw_joint(axes, knee, p, 6.0, layer)


def _draw_joint(axes: Any, place: Any, p: Any, size: float, layer: int = 5) -> None:
    x, y = _upright([place], p.alpha)
    axes.plot(x, y, marker="o", markersize=size, color=JOINT, markeredgecolor="black", zorder=layer + 1)

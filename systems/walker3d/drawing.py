"""A picture of the walker at one instant: from its side, from the front and from above.

Along a motion the walker is seen obliquely from its right, on a slope that descends to the right, and below
it from above, with the way of the hip and the places where toes have touched down. A single instant is shown
in three views.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import bodies
from .frames import attitude, directed, to_slope, turned
from .model import Model
from .motion import leg_of, torso_pitch
from .motion import toe as toe_of
from .observables import on_ground, way
from .states import LEGS, Q2, TOES, anchor

COLOURS = {1: "#1f4e79", 2: "#c0392b"}
NAMES = {1: "leg 1, on the left", 2: "leg 2, on the right"}
BODY, PATH, EARTH, SURFACE, JOINT = "#3d4247", "#7d8790", "#e3e6e8", "#5b6770", "white"
PATH_POINTS = 120  # of the way of the hip: more than a picture of two strides shows apart
SCENERY = "scenery"  # gid of what is there once, however many instants are drawn
# In sizes of the walker: the torso, half the width of the path and its length, and the picture from above.
TORSO, HALF_WIDTH, REACH, BELOW = 0.3, 0.45, 1.4, -0.95
DEPTH = (0.3, 0.22)  # where a metre away from the viewer goes on the paper
Points = Any  # shape (k, 3): to the side, away from the slope, downhill
View = Callable[[Points], Any]


@dataclass(frozen=True)
class Pose:
    """Points of the walker on the slope, each of shape (3,)."""

    hip: Any
    joints: dict[int, Any]
    knees: dict[int, Any]
    ankles: dict[int, Any]
    toes: dict[int, Any]
    torso: Any


def pose(x: Any, p: Any, at: Any, model: Model) -> Pose:
    """Where the walker is; `at` is the place of T, to the side and downhill."""
    frame, hip = attitude(x), np.array([at[0], x[Q2], at[1]])

    def placed(*point: float) -> Any:
        return hip + np.array(to_slope(point, frame), dtype=float)

    joints, knees, ankles, toes = {}, {}, {}, {}
    for number in LEGS:
        leg, beside = leg_of(x, p, number, frame, model), bodies.hip(p, number, model)
        points = [toe_of(leg, p, number, which, model) for which in TOES]
        heights = [bodies.toe(p, number, which, model)[1] for which in TOES]
        down = turned(0.5 * sum(heights), 0.0, leg.shank)
        joints[number] = placed(beside, 0.0, 0.0)
        knees[number] = placed(beside, *leg.arm)
        ankles[number] = placed(beside, leg.arm[0] + down[0], leg.arm[1] + down[1])
        toes[number] = np.array([placed(point.x, point.y, point.z) for point in points])
    upright = turned(TORSO * size(p, model), 0.0, directed(torso_pitch(x, model)))
    return Pose(hip, joints, knees, ankles, toes, placed(0.0, *upright))


def size(p: Any, model: Model) -> float:
    """Length of a leg."""
    return abs(bodies.knee(p, 1, model)) + max(abs(bodies.toe(p, 1, which, model)[1]) for which in TOES)


def make_draw(model: Model) -> Callable[..., None]:
    """The `draw` of a machine."""

    def draw(axes: Any, t: float, x: Any, p: Any, so_far: Any = None) -> None:
        """Draw the walker; `so_far` is the motion until this instant, times (k,) and states (k, 28)."""
        if so_far is None:
            _draw_views(axes, np.asarray(x, dtype=float), p, model)
        else:
            _draw_walk(axes, np.asarray(so_far[0]), np.asarray(so_far[1], dtype=float), p, model)
        axes.set_aspect("equal")
        axes.set_axis_off()

    return draw


# -- along a motion ------------------------------------------------------------------------------------------


def _draw_walk(axes: Any, t: Any, x: Any, p: Any, model: Model) -> None:
    length, passed = size(p, model), way(t, x)
    now = pose(x[-1], p, passed[-1], model)
    middle, begins = passed[0, 0], passed[0, 1]

    def oblique(points: Points) -> Any:
        side, up, ahead = np.asarray(points, dtype=float).T
        across, height = _upright(ahead, up, p.alpha)
        return across + DEPTH[0] * (side - middle), height + DEPTH[1] * (side - middle)

    def above(points: Points) -> Any:
        side, _, ahead = np.asarray(points, dtype=float).T
        across, height = _upright(ahead, 0.0 * ahead, p.alpha)
        return across, height + BELOW * length + side - middle

    prints = _prints(x, passed)
    low, high = min(begins, passed[-1, 1]) - REACH * length, passed[-1, 1] + REACH * length
    for view in (oblique, above):
        _draw_path(axes, view, (low, high), middle, length)
        # Each instant draws the path up to there: of ever more points a page of many would hold a great part.
        seen = passed[np.unique(np.linspace(0, len(passed) - 1, PATH_POINTS).astype(int))]
        hips = np.stack([seen[:, 0], np.zeros(len(seen)), seen[:, 1]], axis=1)
        axes.plot(*view(hips), color=PATH, linewidth=0.9, zorder=1, gid=SCENERY)
        for leg, places in prints.items():
            if len(places):
                drawn = axes.plot(*view(places), "o", color=COLOURS[leg], markersize=2.5, alpha=0.5, zorder=1)
                drawn[0].set_gid(SCENERY)
    _draw_walker(axes, oblique, now, named=True)
    _draw_walker(axes, above, now)
    across, up = (float(number[0]) for number in oblique(now.hip[None] * [1.0, 0.0, 1.0]))
    axes.set_xlim(across - 1.0 * length, across + 1.0 * length)
    axes.set_ylim(up + (BELOW - 0.6) * length, up + 1.45 * length)


def _prints(x: Any, passed: Any) -> dict[int, Any]:
    """Where toes have touched down, by legs; (k, 3)."""
    found: dict[int, Any] = {}
    for leg in LEGS:
        places = []
        for toe in TOES:
            stands, (side, down) = on_ground(x, leg, toe), anchor(leg, toe)
            lands = np.flatnonzero(stands & np.concatenate([[True], ~stands[:-1]]))
            places += [(passed[k, 0] + x[k, side], 0.0, passed[k, 1] + x[k, down]) for k in lands]
        found[leg] = np.array(places)
    return found


def _draw_path(axes: Any, view: View, ends: tuple[float, float], middle: float, length: float) -> None:
    """The strip of the slope that is walked on, with a line across it at each round distance."""
    half, (low, high) = HALF_WIDTH * length, ends
    left, right = middle + half, middle - half
    corners = [(left, 0.0, low), (left, 0.0, high), (right, 0.0, high), (right, 0.0, low)]
    axes.fill(*view(corners), color=EARTH, linewidth=0.0, zorder=0, gid=SCENERY)
    distance = _round(0.2 * length)
    for number in range(math.ceil(low / distance), math.floor(high / distance) + 1):
        place, told = number * distance, number % 5 == 0
        line = view([(left, 0.0, place), (right, 0.0, place)])
        axes.plot(*line, color=SURFACE if told else "white", linewidth=0.8, zorder=0, gid=SCENERY)
        if told:
            text = axes.text(line[0][1], line[1][1], f"{place:g} m ", gid=SCENERY, clip_on=True, zorder=1)
            text.set(ha="center", va="top", color=SURFACE, fontsize=7)
            text.set_in_layout(False)


# -- a single instant ----------------------------------------------------------------------------------------


def _draw_views(axes: Any, x: Any, p: Any, model: Model) -> None:
    length, now = size(p, model), pose(x, p, (0.0, 0.0), model)
    apart = 1.5 * length

    def from_side(points: Points) -> Any:
        _, up, ahead = np.asarray(points, dtype=float).T
        return _upright(ahead, up, p.alpha)

    def from_front(points: Points) -> Any:
        side, up, ahead = np.asarray(points, dtype=float).T
        return side + apart, _upright(ahead, up, p.alpha)[1]

    def from_above(points: Points) -> Any:
        side, up, ahead = np.asarray(points, dtype=float).T
        return _upright(ahead, up, p.alpha)[0], side + BELOW * length

    ends = (-0.6 * length, 0.6 * length)
    slope, level = [(0.0, 0.0, end) for end in ends], [(end, 0.0, 0.0) for end in ends]
    axes.plot(*from_side(slope), color=SURFACE, linewidth=1.4, zorder=1, gid=SCENERY)
    axes.plot(*from_front(level), color=SURFACE, linewidth=1.4, zorder=1, gid=SCENERY)
    for view, words in (
        (from_side, "from its right"),
        (from_front, "from the front"),
        (from_above, "from above"),
    ):
        _draw_walker(axes, view, now, named=view is from_side)
        middle = view(np.array([[0.0, 0.0, 0.0]]))
        below = 0.45 if view is from_above else 0.2
        text = axes.text(float(middle[0][0]), float(middle[1][0]) - below * length, words, gid=SCENERY)
        text.set(ha="center", va="top", color=SURFACE, fontsize=8)
    axes.set_xlim(-0.75 * length, apart + 0.75 * length)
    axes.set_ylim((BELOW - 0.6) * length, 1.4 * length)


# -- the walker ----------------------------------------------------------------------------------------------


def _draw_walker(axes: Any, view: View, now: Pose, named: bool = False) -> None:
    """Both legs, the one on the left first, and the torso."""
    for number in LEGS:
        layer, colour = 2 * number, COLOURS[number]
        name = {"label": NAMES[number]} if named else {}
        limbs = view([now.hip, now.joints[number], now.knees[number], now.ankles[number]])
        axes.plot(*limbs, color=colour, linewidth=2.4, solid_capstyle="round", zorder=layer, **name)
        foot = view([now.ankles[number], *now.toes[number]])
        axes.fill(*foot, facecolor=colour, alpha=0.3, edgecolor=colour, linewidth=1.2, zorder=layer)
        _draw_joint(axes, view, now.knees[number], 4.5, layer)
        _draw_joint(axes, view, now.joints[number], 3.5, layer)
    axes.plot(*view([now.hip, now.torso]), color=BODY, linewidth=4.0, solid_capstyle="round", zorder=6)
    _draw_joint(axes, view, now.hip, 5.5, 6)


def _draw_joint(axes: Any, view: View, place: Any, width: float, layer: int) -> None:
    axes.plot(*view([place]), "o", markersize=width, color=JOINT, markeredgecolor="black", zorder=layer + 1)


def _upright(along: Any, away: Any, alpha: float) -> tuple[Any, Any]:
    """Across and up on the paper of what is given along and away from the slope."""
    sine, cosine = math.sin(alpha), math.cos(alpha)
    return along * cosine + away * sine, away * cosine - along * sine


def _round(length: float) -> float:
    """The largest of 1, 2, 5, 10, .. that is no more than a length."""
    decade = 10.0 ** math.floor(math.log10(length))
    return decade * max(step for step in (1.0, 2.0, 5.0) if step * decade <= length * (1.0 + 1e-12))

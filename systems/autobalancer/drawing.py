"""A picture of the autobalancer at one instant.

It is drawn along the axes of the equations: those of the rotor where the suspension is isotropic, those of
the springs, at rest, where it is not.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from .masses import AB1, AB2, BETA

STEEL, RACE, UNBALANCE, DISPLACEMENT = "#5b6770", "#dfe4e8", "#c0392b", "#1f4e79"
BALLS = ("#e69f00", "#0072b2", "#009e73", "#cc79a7", "#56b4e9", "#d55e00")
BALL, WALL = 0.11, 0.15  # radius of a ball and half width of the race, in units of l1


def make_draw(n: int, springs: Sequence[tuple[str, str]], rotating: bool) -> Callable[..., None]:
    """`draw(axes, t, x, p)` for n masses.

    Parameters
    ----------
    n : int
    springs : sequence of (str, str)
        Names of stiffness and damping, in each direction.
    rotating : bool
        Whether the axes turn with the rotor.
    """

    def draw(axes: Any, t: float, x: Any, p: Any) -> None:
        size, factor = p.l1, exaggeration(n, p, springs)
        centre = (factor * x[AB1], factor * x[AB2])
        turned = 0.0 if rotating else math.remainder(p.omega * t, 2.0 * math.pi)
        angles = [x[BETA + j] + turned for j in range(n)]
        _draw_ring(axes, centre, size)
        if p.omega:
            _draw_rotation(axes, centre, size, turned, math.copysign(1.0, p.omega))
        if p.m * p.e:
            _draw_unbalance(axes, centre, size, turned + (0.0 if p.e > 0.0 else math.pi))
        for j, angle in enumerate(angles):
            _draw_ball(axes, centre, size, angle, BALLS[j % len(BALLS)])
        _number_balls(axes, centre, size, angles)
        _draw_displacement(axes, centre, size)
        note = f"displacement AB drawn × {factor:g}" if factor != 1.0 else "displacement AB to scale"
        axes.text(
            0.5, 0.015, note, transform=axes.transAxes, ha="center", va="bottom", color=STEEL, fontsize=8
        )
        axes.set_aspect("equal")
        axes.set_xlim(-1.75 * size, 1.75 * size)
        axes.set_ylim(-1.75 * size, 1.75 * size)
        axes.set_axis_off()

    return draw


def exaggeration(n: int, p: Any, springs: Sequence[tuple[str, str]]) -> float:
    """Factor 1, 2, 5, 10, .. by which the displacement is drawn larger than it is.

    It depends on the parameters alone, so all pictures of one motion share it: the largest
    unbalance possible, at rest in the rotor, is drawn as at most 0.45 l1 in the softest direction.
    """
    inertia = p.omega**2 * (p.M + p.m + n * p.m1)
    resistance = min(math.hypot(getattr(p, k) - inertia, getattr(p, c) * p.omega) for k, c in springs)
    push = p.omega**2 * (abs(p.m * p.e) + n * p.m1 * p.l1)
    if push == 0.0 or resistance == 0.0:
        return 1.0
    most = 0.45 * p.l1 * resistance / push
    if not 1.0 <= most < math.inf:
        return 1.0
    decade = 10.0 ** math.floor(math.log10(most))
    return decade * max(step for step in (1.0, 2.0, 5.0) if step * decade <= most * (1.0 + 1e-12))


def _around(centre: tuple[float, float], radius: float, angle: float) -> tuple[float, float]:
    return centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle)


def _circle(centre: tuple[float, float], radius: float) -> tuple[Any, Any]:
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    return centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle)


def _draw_ring(axes: Any, centre: tuple[float, float], size: float) -> None:
    axes.fill(*_circle(centre, (1.0 + WALL) * size), facecolor=RACE, edgecolor=STEEL, linewidth=1.6, zorder=1)
    axes.fill(
        *_circle(centre, (1.0 - WALL) * size), facecolor="white", edgecolor=STEEL, linewidth=1.6, zorder=1
    )


def _draw_rotation(axes: Any, centre: tuple[float, float], size: float, turned: float, sense: float) -> None:
    """Arrow of the rotor's direction of rotation, a quarter turn from the unbalance."""
    turn = turned + np.radians(90.0 + sense * np.linspace(-30.0, 30.0, 40))
    path = centre + 0.48 * size * np.column_stack([np.cos(turn), np.sin(turn)])
    arrow = {"arrowstyle": "-|>", "color": STEEL, "lw": 1.2, "shrinkA": 0, "shrinkB": 0}
    axes.plot(path[:-2, 0], path[:-2, 1], color=STEEL, linewidth=1.2, zorder=1)
    axes.annotate("", xy=path[-1], xytext=path[-3], arrowprops=arrow)
    middle = _around(centre, 0.62 * size, turned + 0.5 * math.pi)
    axes.text(*middle, "ω", color=STEEL, ha="center", va="center", fontsize=10)


def _draw_unbalance(axes: Any, centre: tuple[float, float], size: float, angle: float) -> None:
    edge = np.linspace(angle - np.radians(16.0), angle + np.radians(16.0), 40)
    radii = np.concatenate([np.full(40, 0.80), np.full(40, 0.50)]) * size
    edge = np.concatenate([edge, edge[::-1]])
    x, y = centre[0] + radii * np.cos(edge), centre[1] + radii * np.sin(edge)
    axes.fill(x, y, facecolor=UNBALANCE, edgecolor="none", zorder=2)
    middle = _around(centre, 0.65 * size, angle)
    axes.text(*middle, "m", color="white", ha="center", va="center", fontsize=9, style="italic", zorder=3)


def _draw_ball(axes: Any, centre: tuple[float, float], size: float, angle: float, colour: str) -> None:
    middle = _around(centre, size, angle)
    # See-through, because balls may coincide: the model lets them.
    axes.fill(
        *_circle(middle, BALL * size),
        facecolor=colour,
        edgecolor="black",
        linewidth=0.9,
        alpha=0.75,
        zorder=4,
    )


def _number_balls(axes: Any, centre: tuple[float, float], size: float, angles: list[float]) -> None:
    """One number outside each ball; balls that touch share a label."""
    labels: list[tuple[float, str]] = []
    for number, angle in enumerate(angles, start=1):
        for k, (place, text) in enumerate(labels):
            if abs(math.remainder(angle - place, 2.0 * math.pi)) < 2.0 * BALL:
                labels[k] = (place, f"{text}, {number}")
                break
        else:
            labels.append((angle, str(number)))
    for place, text in labels:
        x, y = _around(centre, 1.2 * size, place)
        # The text grows away from the ring, whatever its length.
        along = 0.5 * (1.0 - math.cos(place))
        axes.annotate(
            text,
            (x, y),
            xytext=(6.0 * math.cos(place), 6.0 * math.sin(place)),
            textcoords="offset points",
            ha="left" if along < 0.25 else "right" if along > 0.75 else "center",
            va="center",
            fontsize=9,
            zorder=5,
        )


def _draw_displacement(axes: Any, centre: tuple[float, float], size: float) -> None:
    length = math.hypot(*centre)
    # The labels A and B lie beyond the ends of the line AB; at rest, on a diagonal.
    away = (centre[0] / length, centre[1] / length) if length > 0.02 * size else (0.7, 0.7)
    axes.plot([0.0, centre[0]], [0.0, centre[1]], color=DISPLACEMENT, linewidth=2.0, zorder=5)
    axes.plot([0.0], [0.0], marker="+", markersize=13, markeredgewidth=1.6, color="black", zorder=6)
    axes.plot([centre[0]], [centre[1]], marker="o", markersize=6, color=DISPLACEMENT, zorder=7)
    for name, end, sign, colour in (("A", (0.0, 0.0), -1.0, "black"), ("B", centre, 1.0, DISPLACEMENT)):
        axes.annotate(
            name,
            end,
            xytext=(13.0 * sign * away[0], 13.0 * sign * away[1]),
            textcoords="offset points",
            ha="center",
            va="center",
            color=colour,
            fontsize=10,
            zorder=8,
        )

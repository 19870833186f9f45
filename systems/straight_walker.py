"""Two straight legs on round feet that walk down a slope, in a plane: model and closed forms in
`docs/systems/straight_walker.md`.

Feet may be points, as large as the legs, which roll as a wheel does, or anything between.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from contwalk.system import Mode, Observable, Parameter, State, Study, System, Transition

STANCE, SWING, STANCE_RATE, SWING_RATE = range(4)
COLOURS = ("#1f4e79", "#c0392b")
SCENERY = "scenery"  # gid of what is there once, however many instants are drawn
SAME_TIME = 1e-12


def _below(p: Any) -> Any:
    """Distance of the centre of a foot from the hip."""
    return p.l - p.r


def _masses(stance: Any, swing: Any, p: Any) -> tuple[Any, Any, Any]:
    """Entries 11, 12 and 22 of the mass matrix."""
    d, above = _below(p), _below(p) - p.b
    hip = p.r * p.r + 2.0 * p.r * d * np.cos(stance) + d * d
    leg = p.r * p.r + 2.0 * p.r * above * np.cos(stance) + above * above
    across = p.r * np.cos(swing) + d * np.cos(stance - swing)
    own = p.m_leg * p.b * p.b + p.I_leg
    return (p.m_hip + p.m_leg) * hip + p.m_leg * leg + p.I_leg, -p.m_leg * p.b * across, own


def _solved(m: tuple[Any, Any, Any], first: Any, second: Any) -> tuple[Any, Any]:
    m11, m12, m22 = m
    determinant = m11 * m22 - m12 * m12
    return (m22 * first - m12 * second) / determinant, (m11 * second - m12 * first) / determinant


def _walking(t: Any, x: Any, p: Any, dx: Any) -> None:
    """The stance foot rolls on the slope, the swing leg hangs from the hip."""
    stance, swing, w, q = x[STANCE], x[SWING], x[STANCE_RATE], x[SWING_RATE]
    d, above, upper = _below(p), _below(p) - p.b, p.m_hip + p.m_leg
    apart = np.sin(stance - swing)
    rolling = p.r * np.sin(stance) * (upper * d + p.m_leg * above)
    first = rolling * w * w - p.m_leg * p.b * (p.r * np.sin(swing) - d * apart) * q * q
    along = upper * (p.r + d * np.cos(stance)) + p.m_leg * (p.r + above * np.cos(stance))
    first += p.g * np.sin(p.gamma) * along
    first += p.g * np.cos(p.gamma) * (upper * d + p.m_leg * above) * np.sin(stance)
    second = -p.m_leg * p.b * d * apart * w * w - p.m_leg * p.g * p.b * np.sin(swing + p.gamma)
    dx[STANCE], dx[SWING] = w, q
    dx[STANCE_RATE], dx[SWING_RATE] = _solved(_masses(stance, swing, p), first, second)


def _in_front(t: Any, x: Any, p: Any) -> Any:
    return x[STANCE] - x[SWING]


def _both_feet_down(t: Any, x: Any, p: Any) -> Any:
    return x[STANCE] + x[SWING]


def _heel_strike(t: Any, x: Any, p: Any, x_plus: Any) -> None:
    """The legs change their names; moments of momentum about the new contact and about the hip are kept.

    Written as the momenta that belong to the new rates, of the velocities right before.
    """
    old, new, w, q = x[STANCE], x[SWING], x[STANCE_RATE], x[SWING_RATE]
    d, above = _below(p), _below(p) - p.b

    def hung(angle: Any, distance: Any) -> tuple[Any, Any]:
        """Velocity, along and away from the slope, of a point so far above a rolling foot, at unit rate."""
        return p.r + distance * np.cos(angle), -distance * np.sin(angle)

    def swung(angle: Any) -> tuple[Any, Any]:
        return -p.b * np.cos(angle), p.b * np.sin(angle)

    def dot(a: tuple[Any, Any], b: tuple[Any, Any]) -> Any:
        return a[0] * b[0] + a[1] * b[1]

    hip = tuple(v * w for v in hung(old, d))
    standing = tuple(v * w for v in hung(old, above))
    swinging = tuple(v * w + u * q for v, u in zip(hung(old, d), swung(new), strict=True))
    first = p.m_hip * dot(hung(new, d), hip) + p.m_leg * dot(hung(new, above), swinging) + p.I_leg * q
    first += p.m_leg * dot(hung(new, d), standing)
    second = p.m_leg * dot(swung(old), standing) + p.I_leg * w
    x_plus[STANCE], x_plus[SWING] = new, old
    x_plus[STANCE_RATE], x_plus[SWING_RATE] = _solved(_masses(new, old, p), first, second)


def _way(t: Any, x: Any, p: Any) -> Any:
    """Where the centre of the standing foot is along the slope, shape (k,); a strike changes the foot."""
    lasting = np.diff(t) > SAME_TIME * max(1.0, abs(t[-1]))
    rolled, stepped = p.r * np.diff(x[:, STANCE]), 2.0 * _below(p) * np.sin(x[:-1, STANCE])
    swaps = ~lasting & (x[1:, STANCE] != x[:-1, STANCE])
    steps = np.where(lasting, rolled, np.where(swaps, stepped, 0.0))
    return np.concatenate([[0.0], np.cumsum(steps)])


def _speed(t: Any, x: Any, p: Any) -> Any:
    if len(t) == 1:
        return 0.0
    hips = p.r * x[:, STANCE] + _below(p) * np.sin(x[:, STANCE])
    return np.where(np.diff(t) > 0.0, np.diff(hips), 0.0).sum() / (t[-1] - t[0])


def _draw(axes: Any, t: float, x: Any, p: Any, so_far: Any = None) -> None:
    """Both legs with their feet on the slope; the leg that stands first is blue."""
    times, states = (np.array([t]), x[None]) if so_far is None else map(np.asarray, so_far)
    way, d = _way(times, states, p)[-1], _below(p)
    changed = np.flatnonzero((np.diff(times) == 0.0) & (np.diff(states[:, STANCE]) != 0.0)).size % 2

    def upright(along: Any, away: Any) -> tuple[Any, Any]:
        sine, cosine = math.sin(p.gamma), math.cos(p.gamma)
        return along * cosine + away * sine, away * cosine - along * sine

    hip = way + d * math.sin(x[STANCE]), p.r + d * math.cos(x[STANCE])
    turn = np.linspace(-0.5, 0.5, 21)
    for leg, angle in enumerate((x[STANCE], x[SWING])):
        colour = COLOURS[(leg + changed) % 2]
        name = "leg that stands first" if (leg + changed) % 2 == 0 else "the other leg"
        centre = hip[0] - d * math.sin(angle), hip[1] - d * math.cos(angle)
        foot = centre[0] - p.r * np.sin(turn + angle), centre[1] - p.r * np.cos(turn + angle)
        axes.plot(*upright(np.array([hip[0], foot[0][10]]), np.array([hip[1], foot[1][10]])), color=colour)
        axes.plot(*upright(*foot), color=colour, linewidth=2.4, label=name)
    axes.plot(*upright(np.array([hip[0]]), np.array([hip[1]])), "o", color="black", markersize=6.0)
    ends = np.array([-p.l, way + p.l])
    axes.plot(*upright(ends, 0.0 * ends), color="#5b6770", linewidth=1.2, zorder=0, gid=SCENERY)
    axes.set_xlim(upright(way - p.l, 0.0)[0], upright(way + p.l, 0.0)[0])
    axes.set_aspect("equal")
    axes.set_axis_off()


SYSTEM = System(
    name="straight_walker",
    about="two straight legs on round feet that walk down a slope in a plane",
    states=(
        State(
            "stance", "rad", about="standing leg from the slope's normal, positive with the hip ahead of it"
        ),
        State("swing", "rad", about="swinging leg from the slope's normal, likewise"),
        State("stance_rate", "rad/s", about="rate of stance"),
        State("swing_rate", "rad/s", about="rate of swing"),
    ),
    parameters=(
        Parameter("g", 1.0, "m/s2", (0.0, None), "gravity"),
        Parameter("l", 1.0, "m", (0.0, None), "length of a leg with its foot"),
        Parameter("r", 0.0, "m", (0.0, None), "radius of the feet; of points 0"),
        Parameter("b", 1.0, "m", about="centre of mass of a leg, from the hip"),
        Parameter("m_hip", 1.0, "kg", (0.0, None), "mass of the hip"),
        Parameter("m_leg", 1e-9, "kg", (0.0, None), "mass of a leg; not zero"),
        Parameter("I_leg", 0.0, "kg m2", (0.0, None), "moment of inertia of a leg about its centre of mass"),
        Parameter("gamma", 0.009, "rad", about="inclination of the slope"),
    ),
    modes=(
        Mode("behind", _walking, about="the swinging leg is behind"),
        Mode("ahead", _walking, about="it is ahead"),
    ),
    transitions=(
        Transition("legs_pass", "behind", "ahead", _in_front, direction="rising", about="the legs pass"),
        Transition(
            "heel_strike",
            "ahead",
            "behind",
            _both_feet_down,
            direction="rising",
            reset=_heel_strike,
            about="the foot ahead lands, and the other one leaves the ground",
        ),
    ),
    observables=(Observable("speed", _speed, "m/s", "mean speed along the slope"),),
    presets={
        "point_masses": {},
        "walking_wheel": {"g": 9.81, "r": 1.0, "b": 0.5, "gamma": 0.0},
        "round_feet": {
            "g": 9.81,
            "r": 0.3,
            "b": 0.355,
            "m_hip": 0.0,
            "m_leg": 0.5,
            "I_leg": 0.053138,
            "gamma": 0.025,
        },
    },
    draw=_draw,
    fallen=lambda t, x, p: abs(x[STANCE]) - math.pi / 3.0,
    study=Study(
        "gamma",
        (0.001, 0.019),
        {
            "simulate": {
                "state": {"stance": -0.2003, "swing": 0.2003, "stance_rate": 0.1998, "swing_rate": 0.184},
                "mode": "behind",
                "until": "settled",
            }
        },
    ),
    reference="M. Garcia, A. Chatterjee, A. Ruina, M. Coleman (1998), J. Biomech. Eng. 120, 281-288; "
    "T. McGeer (1990), Int. J. Robotics Research 9(2), 62-82",
)

"""Numbers read off a motion: t of shape (k,), x of shape (k, 28).

A motion may be made of pieces that each begin where the machine's own mirror image or name says: where two
instants have one time, the way along the slope goes on, whatever the positions there. A toe is on the ground
where its anchor is not zero.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np

from contwalk.system import Observable, Signal

from .bodies import total_mass
from .centre import centre_of_mass
from .forces import ground_force
from .model import CLIPPED, TWO_SIDED, Model
from .motion import toe_place, toe_velocity
from .states import KNEE, KNEE_RATE, LEGS, Q1, Q2, Q3, THIGH_ANGLE, TOES, anchor

# Of a toe that bears less than this share of the weight no friction is told: at lift-off it is infinite.
HARDLY = 1e-3
SAME_TIME = 1e-12


def lasting(t: Any) -> Any:
    """Durations between instants; 0 where two of them are sides of one event. Shape (k - 1,)."""
    steps = np.diff(t)
    return np.where(steps > SAME_TIME * max(1.0, abs(t[-1])), steps, 0.0)


def way(t: Any, x: Any) -> Any:
    """Where T is on the slope, to the side and downhill, as it has moved; shape (k, 2)."""
    steps = np.where(lasting(t)[:, None] > 0.0, np.diff(x[:, [Q1, Q3]], axis=0), 0.0)
    return x[0, [Q1, Q3]] + np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])


def on_ground(x: Any, leg: int, toe: int) -> Any:
    """Whether a toe is on the ground; shape (k,)."""
    side, down = anchor(leg, toe)
    return x[:, side] * x[:, side] + x[:, down] * x[:, down] > 0.0


def strides(x: Any) -> int:
    """How often leg 1 lands, 1 at least."""
    stands = on_ground(x, 1, 1) | on_ground(x, 1, 2)
    return max(1, int(np.count_nonzero(stands[1:] & ~stands[:-1])) + int(stands[0] and not stands[-1]))


def larger(a: Any, b: Any) -> Any:
    """The larger of two numbers, without a comparison: of equilibria it is differentiated."""
    return 0.5 * (a + b + abs(a - b))


def force_of_ground(x: Any, p: Any, leg: int, toe: int, model: Model) -> Any:
    """Force on a toe along the axes of the slope; shape (3, k)."""
    columns, end = x.T, f"{leg}{toe}"
    place, speed = (move(columns, p, leg, toe, model) for move in (toe_place, toe_velocity))
    into, out = -larger(-speed[1], 0.0), larger(speed[1], 0.0)
    if model.ground_damper != TWO_SIDED:
        speed = speed[0], into, speed[2]
    touches = np.where(on_ground(x, leg, toe), 1.0, 0.0)
    acting = {f"{name}{end}": touches for name in ("on", "damped", "pressed")} | {f"rising{end}": 0.0}
    side, down = anchor(leg, toe)
    held, known = (columns[side], columns[down]), SimpleNamespace(**{**vars(p), **acting})
    force = ground_force(place, speed, held, known, end, model)
    if model.ground_damper == CLIPPED:
        # It damps as the toe moves out, too, and never pulls.
        force = force[0], touches * larger(force[1] - p.c_y_rebound * out, 0.0), force[2]
    return np.stack(force)


def _stride_time(t: Any, x: Any, p: Any) -> Any:
    return (t[-1] - t[0]) / strides(x)


def _stride_length(t: Any, x: Any, p: Any) -> Any:
    return np.hypot(*(way(t, x)[-1] - way(t, x)[0])) / strides(x)


def _speed(t: Any, x: Any, p: Any) -> Any:
    return np.hypot(*(way(t, x)[-1] - way(t, x)[0])) / (t[-1] - t[0]) if len(t) > 1 else 0.0


def _heading(t: Any, x: Any, p: Any) -> Any:
    side, down = way(t, x)[-1] - way(t, x)[0]
    return np.arctan2(side, down)


def _hip_height(t: Any, x: Any, p: Any) -> Any:
    if len(t) == 1:
        return x[0, Q2]
    return np.sum(lasting(t) * 0.5 * (x[1:, Q2] + x[:-1, Q2])) / (t[-1] - t[0])


def _hip_bob(t: Any, x: Any, p: Any) -> Any:
    return np.ptp(x[:, Q2])


def _hip_sway(t: Any, x: Any, p: Any) -> Any:
    passed = way(t, x)
    side, down = passed[-1] - passed[0]
    length = np.hypot(side, down)
    return np.ptp(passed @ (np.array([down, -side]) / length)) if length > 0.0 else np.ptp(passed[:, 0])


def _hyperextension(t: Any, x: Any, p: Any) -> Any:
    return -x[:, list(KNEE.values())].min()


def _energy(t: Any, x: Any, p: Any, model: Model) -> Any:
    down = way(t, x)[-1, 1] - way(t, x)[0, 1]
    return total_mass(p, model) * p.g * np.sin(p.alpha) * down / strides(x)


def _largest_load(t: Any, x: Any, p: Any, model: Model) -> Any:
    up = sum(force_of_ground(x, p, leg, toe, model)[1] for leg in LEGS for toe in TOES)
    return up.max() / (total_mass(p, model) * p.g)


def _needs(force: Any, x: Any, p: Any, leg: int, toe: int, model: Model) -> tuple[Any, Any]:
    """The friction (2) that a toe needs, and whether it bears weight; shape (k,) each."""
    bears = on_ground(x, leg, toe) & (force[1] > HARDLY * total_mass(p, model) * p.g)
    return np.hypot(force[0], force[2]) / np.where(bears, force[1], 1.0), bears


def _friction(t: Any, x: Any, p: Any, leg: int, toe: int, model: Model) -> Any:
    needed, bears = _needs(force_of_ground(x, p, leg, toe, model), x, p, leg, toe, model)
    before, here, after = needed[:-2], needed[1:-1], needed[2:]
    within = bears[:-2] & bears[2:] & (here >= before) & (here >= after)
    return np.where(within, here, 0.0).max(initial=0.0)


def _release(t: Any, x: Any, p: Any) -> Any:
    return x[KNEE_RATE[1]]


def _slipping(t: Any, x: Any, p: Any, leg: int, toe: int, model: Model) -> Any:
    side, up, down = force_of_ground(x, p, leg, toe, model)
    beyond = np.hypot(side, down) - up
    first, last = beyond[:-1], beyond[1:]
    higher, lower = np.maximum(first, last), np.minimum(first, last)
    # The part of each interval in which the straight line between both ends is positive.
    apart = np.where(higher > lower, higher - lower, 1.0)
    part = np.where(lower >= 0.0, np.where(higher > 0.0, 1.0, 0.0), np.clip(higher / apart, 0.0, 1.0))
    return np.sum(lasting(t) * part) / strides(x)


def _height(t: Any, x: Any, p: Any, leg: int, toe: int, model: Model) -> Any:
    return toe_place(x.T, p, leg, toe, model)[1]


def _friction_needed(t: Any, x: Any, p: Any, leg: int, toe: int, model: Model, axis: int) -> Any:
    """A part of the force along the slope over the normal one; beyond one, its logarithm is added to one."""
    force = force_of_ground(x, p, leg, toe, model)
    size, bears = _needs(force, x, p, leg, toe, model)
    shown = np.where(size > 1.0, (1.0 + np.log10(np.where(size > 1.0, size, 1.0))) / size, 1.0)
    return np.where(bears, shown * force[axis] / np.where(bears, force[1], 1.0), np.nan)


def _centre(t: Any, x: Any, p: Any, model: Model, axis: int) -> Any:
    """Where the centre of mass is on the slope, as it has moved; axis 1 is its height."""
    from_hip = centre_of_mass(x.T, p, model)[axis]
    return from_hip + (x[:, Q2] if axis == 1 else way(t, x)[:, axis // 2])


def _load(t: Any, x: Any, p: Any, leg: int, toe: int, model: Model) -> Any:
    return force_of_ground(x, p, leg, toe, model)[1]


def _shank(t: Any, x: Any, p: Any, leg: int) -> Any:
    return x[:, THIGH_ANGLE[leg]] + x[:, KNEE[leg]]


def make_signals(model: Model) -> tuple[Signal, ...]:
    """What figures show along a motion: the centre of mass, shanks, heights of toes and forces on them."""
    found = [
        Signal(
            f"com_{name}",
            _of(_centre, model=model, axis=axis),
            "m",
            words,
            extremes=axis == 1,
        )
        for name, axis, words in (
            ("side", 0, "way of the centre of mass to the side"),
            ("height", 1, "height of the centre of mass above the slope"),
            ("down", 2, "way of the centre of mass downhill"),
        )
    ]
    for leg in LEGS:
        found.append(
            Signal(f"shank{leg}", _of(_shank, leg=leg), "rad", f"angle of shank {leg}, as that of its thigh")
        )
        for toe in TOES:
            of = {"leg": leg, "toe": toe, "model": model}
            name = f"{leg}{toe}"
            found += [
                Signal(f"height{name}", _of(_height, **of), "m", f"height of toe {name}"),
                Signal(f"load{name}", _of(_load, **of), "N", f"force of the ground on toe {name}, upwards"),
                *(
                    Signal(
                        f"friction_{way}{name}",
                        _of(_friction_needed, **of, axis=axis),
                        "1",
                        f"friction that toe {name} needs, {words}; beyond one on a logarithmic scale",
                    )
                    for way, axis, words in (("side", 0, "to the side"), ("down", 2, "downhill"))
                ),
            ]
    return tuple(found)


def make_observables(model: Model) -> tuple[Observable, ...]:
    """What is read off a motion of this machine; of motions of several strides, the mean of a stride."""
    of_toes = [
        Observable(
            f"{name}{leg}{toe}", _of(function, leg=leg, toe=toe, model=model), unit, words.format(leg, toe)
        )
        for name, function, unit, words in (
            ("friction", _friction, "1", "largest friction (2) that toe {}{} needs inside its stance"),
            ("slip_time", _slipping, "s", "time in a stride in which toe {}{} needs a friction above 1"),
        )
        for leg in LEGS
        for toe in TOES
    ]
    return (
        Observable("stride_time", _stride_time, "s", "time of a stride"),
        Observable("stride_length", _stride_length, "m", "way of T along the slope in a stride"),
        Observable("speed", _speed, "m/s", "mean speed along the slope"),
        Observable(
            "heading", _heading, "rad", "where the walker goes: 0 straight down, positive towards leg 1"
        ),
        Observable("hip_height", _hip_height, "m", "mean height of T above the slope"),
        Observable("hip_bob", _hip_bob, "m", "between the lowest and the highest T"),
        Observable(
            "hip_sway", _hip_sway, "m", "how far T goes across the way of the walker, from side to side"
        ),
        Observable("hyperextension", _hyperextension, "rad", "how far the knees give beyond straight"),
        Observable(
            "release",
            _release,
            "rad/s",
            "how fast knee 1 bends where it is first let go",
            at="knee1_unlocks",
        ),
        Observable(
            "energy_per_stride", _of(_energy, model=model), "J", "what gravity gives and dampers take"
        ),
        Observable("peak_load", _of(_largest_load, model=model), "1", "largest normal force over weight"),
        *of_toes,
    )


def _of(function: Callable[..., Any], **chosen: Any) -> Callable[[Any, Any, Any], Any]:
    return partial(function, **chosen)

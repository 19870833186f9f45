"""Mass matrix and inertia forces of the free walker, written in the frame V.

All bodies turn about lines parallel to the hip line. In V their angular velocities are (r, u5, u6), where r
is the rate of the body about its line: u4 of the torso, a = u7 + w1 of a thigh and b = a + u8 of its shank,
with the angular velocity (w1, u5, u6) of V itself, w1 = -tan(q5) u6. In the unknowns

    v* = v' + (w1, u5, u6) x v - g,   u4',   u5* = u5' - w1 u6,   u6* = u6' + w1 u5,   a', b' of both legs

the angular acceleration of a body is (r', u5* + r u6, u6* - r u5), and neither w1 nor gravity is left in the
equations M (v*, u4', u5*, u6*, a1', b1', a2', b2') = F. They are Kane's equations in other rates.

With P and J the first moment of a body and its inertia about the point where its line passes the plane x = 0
of V, in V, torso and thighs add

    to M:  v2 r: -Pz,  v3 r: Py,  u5 r: Jxy,  u6 r: Jxz,  r r: Jxx,
           v1 u5: Pz,  v1 u6: -Py,  v2 u6: Px,  v3 u5: -Px,  and Jyy, Jyz, Jzz to u5 and u6,

and a shank moreover what follows from the arm k of its knee.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from . import bodies
from .elimination import Entries, add
from .frames import Attitude, Plane, directed, turned
from .model import BALANCED, LOCKED, Model
from .motion import Leg, torso_pitch, torso_rate
from .states import U5, U6

V1, V2, V3, TORSO, W5, W6 = range(6)
THIGH = {1: 6, 2: 8}
SHANK = {1: 7, 2: 9}
# From the outside to the inside.
ORDER = (SHANK[1], THIGH[1], SHANK[2], THIGH[2], TORSO, V1, V2, V3, W5, W6)
Shares = tuple[tuple[int, float], ...]


@dataclass(frozen=True)
class Equations:
    """M, its nonzero entries, and F while they are put together."""

    matrix: Entries
    forces: list[Any]


@dataclass(frozen=True)
class Turned:
    """A body in V: first moment and inertia, of which (Jyy + Jzz) / 2 does not change with its angle.

    Attributes
    ----------
    x, y, z : first moment
    xx, mean : Jxx, (Jyy + Jzz) / 2
    half, yz, xy, xz : (Jyy - Jzz) / 2, Jyz, Jxy, Jxz
    """

    x: Any
    y: Any
    z: Any
    xx: Any
    mean: Any
    half: Any
    yz: Any
    xy: Any
    xz: Any


def in_v(body: bodies.Body, direction: Plane) -> Turned:
    """A body turned about its line."""
    cosine, sine = direction
    xx, yy, zz, xy, xz, yz = body.inertia
    y, z = turned(body.first[1], body.first[2], direction)
    # A tensor across the line turns by twice the angle.
    half, yz = turned(0.5 * (yy - zz), yz, (1.0 - 2.0 * sine * sine, 2.0 * sine * cosine))
    return Turned(body.first[0], y, z, xx, 0.5 * (yy + zz), half, yz, *turned(xy, xz, direction))


def free_walker(x: Any, p: Any, model: Model, frame: Attitude, legs: dict[int, Leg]) -> Equations:
    """M, and F without any force: what is left of the accelerations where the unknowns are zero."""
    equations = Equations({}, [0.0] * 10)
    turning = [add_torso(equations, x, p, frame, model)]
    for number, leg in legs.items():
        thigh = in_v(bodies.thigh(p, number, model), leg.thigh)
        shank = in_v(bodies.shank(p, number, model), leg.shank)
        add_body(equations, x, thigh, leg.thigh_rate, ((THIGH[number], 1.0),))
        add_body(equations, x, shank, leg.shank_rate, ((SHANK[number], 1.0),))
        add_knee(equations, x, number, leg, shank)
        turning += [thigh, shank]
    add_whole(equations, x, turning, bodies.total_mass(p, model))
    return equations


def add_torso(equations: Equations, x: Any, p: Any, frame: Attitude, model: Model) -> Turned:
    """Add what the torso does by its rate. With hips in gear that is the mean rate of the thighs."""
    shares = ((THIGH[1], 0.5), (THIGH[2], 0.5)) if model.hip == LOCKED else ((TORSO, 1.0),)
    rate = torso_rate(x, frame, model)
    if model.torso == BALANCED:
        body = in_v(bodies.torso(p, model), (1.0, 0.0))
        add_rate(equations, body, shares)
        force(equations, W5, -(rate * (x[U6] * body.xx)))
        force(equations, W6, rate * (x[U5] * body.xx))
    else:
        body = in_v(bodies.torso(p, model), directed(torso_pitch(x, model)))
        add_body(equations, x, body, rate, shares)
    return body


def add_rate(equations: Equations, body: Turned, shares: Shares) -> None:
    """Add the inertia of a body about its line; its rate is the sum of unknowns by their shares."""
    for i, share in shares:
        for j, other in shares:
            if i <= j:
                add(equations.matrix, i, j, share * other * body.xx)


def add_body(equations: Equations, x: Any, body: Turned, rate: Any, shares: Shares) -> None:
    """Add what a body does by its rate r."""
    add_rate(equations, body, shares)
    u5, u6, square = x[U5], x[U6], rate * rate
    turning = 2.0 * (u5 * u6) * body.half - (u5 * u5 - u6 * u6) * body.yz
    for i, share in shares:
        for row, entry in ((V2, -body.z), (V3, body.y), (W5, body.xy), (W6, body.xz)):
            add(equations.matrix, row, i, share * entry)
        force(equations, i, share * turning)
    force(equations, V1, -2.0 * (rate * (u5 * body.y + u6 * body.z)))
    force(equations, V2, square * body.y)
    force(equations, V3, square * body.z)
    five = u6 * body.xx + 2.0 * (u6 * body.half - u5 * body.yz)
    six = u5 * body.xx - 2.0 * (u5 * body.half + u6 * body.yz)
    force(equations, W5, square * body.xz - rate * five)
    force(equations, W6, rate * six - square * body.xy)


def add_knee(equations: Equations, x: Any, number: int, leg: Leg, shank: Turned) -> None:
    """Add what a shank does because its knee is not on the hip line but at the arm k from it."""
    u5, u6, (y, z) = x[U5], x[U6], leg.arm
    yy, yz, zy, zz = y * shank.y, y * shank.z, z * shank.y, z * shank.z
    five, both, six = u5 * u5, u5 * u6, u6 * u6
    a, b = leg.thigh_rate, leg.shank_rate
    add(equations.matrix, THIGH[number], SHANK[number], yy + zz)
    add(equations.matrix, W5, W5, 2.0 * zz)
    add(equations.matrix, W5, W6, -(yz + zy))
    add(equations.matrix, W6, W6, 2.0 * yy)
    across, bent = both * (zz - yy), zy - yz
    force(equations, THIGH[number], across - b * b * bent - six * zy + five * yz)
    force(equations, SHANK[number], across + a * a * bent - six * yz + five * zy)
    of_shank = 2.0 * (b * (u5 * shank.y + u6 * shank.z))
    of_thigh = 2.0 * (a * (u5 * y + u6 * z))
    force(equations, W5, -(z * of_shank + shank.z * of_thigh))
    force(equations, W6, y * of_shank + shank.y * of_thigh)


def add_whole(equations: Equations, x: Any, turning: list[Turned], mass: Any) -> None:
    """Add what all bodies do together by the velocity of T and by u5 and u6."""
    u5, u6 = x[U5], x[U6]
    five, both, six = u5 * u5, u5 * u6, u6 * u6
    side = sum(body.x for body in turning)
    y, z = sum(body.y for body in turning), sum(body.z for body in turning)
    xy, xz = sum(body.xy for body in turning), sum(body.xz for body in turning)
    mean, half = sum(body.mean for body in turning), sum(body.half for body in turning)
    for row, column, entry in (
        (V1, V1, mass),
        (V2, V2, mass),
        (V3, V3, mass),
        (V1, W5, z),
        (V1, W6, -y),
        (V2, W6, side),
        (V3, W5, -side),
        (W5, W5, mean + half),
        (W5, W6, sum(body.yz for body in turning)),
        (W6, W6, mean - half),
    ):
        add(equations.matrix, row, column, entry)
    force(equations, V1, side * (five + six))
    force(equations, V2, six * y - both * z)
    force(equations, V3, five * z - both * y)
    force(equations, W5, -(both * xy + six * xz))
    force(equations, W6, five * xy + both * xz)


def force(equations: Equations, row: int, value: Any) -> None:
    """Add to F."""
    equations.forces[row] = equations.forces[row] + value

"""The bodies as their parameters make them, each about the point of the hip line or knee it turns about.

Torso and thighs turn about the hip line, a shank about the line through its knee parallel to it. What counts
of a body is its mass, its first moment and its inertia about the point where that line passes the plane x =
0 of V. The mass of a shank takes part in the turning of its thigh as if it were at the knee.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .model import BALANCED, MIRRORED, Model

Vector = tuple[Any, Any, Any]


@dataclass(frozen=True)
class Body:
    """Mass, first moment (x, y, z) and inertia (xx, yy, zz, xy, xz, yz), in the axes of the body."""

    mass: Any
    first: Vector
    inertia: tuple[Any, Any, Any, Any, Any, Any]


def about(mass: Any, centre: Vector, inertia: tuple[Any, ...]) -> Body:
    """A body about a point from which its centre of mass is at `centre`; `inertia` is about the centre."""
    x, y, z = centre
    mx, my, mz = mass * x, mass * y, mass * z
    xx, yy, zz, xy, xz, yz = inertia
    moved = (
        xx + my * y + mz * z,
        yy + mx * x + mz * z,
        zz + mx * x + my * y,
        xy - mx * y,
        xz - mx * z,
        yz - my * z,
    )
    return Body(mass, (mx, my, mz), moved)


def torso(p: Any, model: Model) -> Body:
    """The torso about T; between mirrored legs it is its own mirror image."""
    if model.torso == BALANCED:
        return Body(p.m_torso, (0.0, 0.0, 0.0), (p.I_torso, p.I_torso, p.I_torso, 0.0, 0.0, 0.0))
    if model.legs == MIRRORED:
        inertia = (p.I_torso_xx, p.I_torso_yy, p.I_torso_zz, 0.0, 0.0, p.I_torso_yz)
        return about(p.m_torso, (0.0, p.torso_y, p.torso_z), inertia)
    return about(p.m_torso, (p.torso_x, p.torso_y, p.torso_z), _inertia(p, "torso", 1.0))


def thigh(p: Any, leg: int, model: Model) -> Body:
    """A thigh about T, with the mass of its shank at the knee."""
    own = _limb(p, "thigh", leg, model)
    carried, y = shank(p, leg, model), knee(p, leg, model)
    xx, yy, zz, xy, xz, yz = own.inertia
    hung = carried.mass * y
    inertia = (xx + hung * y, yy, zz + hung * y, xy - carried.first[0] * y, xz, yz)
    return Body(own.mass, (own.first[0], own.first[1] + hung, own.first[2]), inertia)


def shank(p: Any, leg: int, model: Model) -> Body:
    """A shank about the point beside T on the level of its knee."""
    return _limb(p, "shank", leg, model)


def knee(p: Any, leg: int, model: Model) -> Any:
    """From the hip line to the knee, along axis 2 of the thigh."""
    return p.knee_y if model.legs == MIRRORED else getattr(p, f"knee{leg}_y")


def hip(p: Any, leg: int, model: Model) -> Any:
    """Place of a hip joint on the hip line."""
    return p.hip_x * _side(leg) if model.legs == MIRRORED else getattr(p, f"hip{leg}_x")


def toe(p: Any, leg: int, number: int, model: Model) -> Vector:
    """Place of a toe: x from T, y and z from the knee along the axes of the shank. Toe 1 is the outer one."""
    if model.legs == MIRRORED:
        name, side = ("toe_outer", "toe_inner")[number - 1], _side(leg)
    else:
        name, side = f"toe{leg}{number}", 1.0
    x, y, z = _point(p, name, side)
    return hip(p, leg, model) + x, y, z


def total_mass(p: Any, model: Model) -> Any:
    """Mass of the walker."""
    limbs = [_limb(p, name, leg, model).mass for leg in (1, 2) for name in ("thigh", "shank")]
    return sum(limbs, p.m_torso)


def _limb(p: Any, name: str, leg: int, model: Model) -> Body:
    if model.legs == MIRRORED:
        named, side = name, _side(leg)
    else:
        named, side = f"{name}{leg}", 1.0
    x, y, z = _point(p, named, side)
    return about(getattr(p, f"m_{named}"), (hip(p, leg, model) + x, y, z), _inertia(p, named, side))


def _side(leg: int) -> float:
    """Mirrored legs: the coordinates are those of leg 1."""
    return 1.0 if leg == 1 else -1.0


def _point(p: Any, name: str, side: float) -> Vector:
    return side * getattr(p, f"{name}_x"), getattr(p, f"{name}_y"), getattr(p, f"{name}_z")


def _inertia(p: Any, name: str, side: float) -> tuple[Any, ...]:
    signs = (1.0, 1.0, 1.0, side, side, 1.0)
    parts = zip(signs, ("xx", "yy", "zz", "xy", "xz", "yz"), strict=True)
    return tuple(sign * getattr(p, f"I_{name}_{component}") for sign, component in parts)

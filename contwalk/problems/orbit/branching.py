"""Where two branches of orbits cross: their tangents, and the branch that leaves."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.orbit import variations
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.problem import Located, Sample, Seed

# Components of a critical vector below this part of its largest set no scale.
FAINT = 1e-6
# A second direction of solutions is one where DF's second smallest singular value is rounding.
SINGULAR = 1e-9
# A parameter below this part of its usual size is zero: orbits beside a special point are not known better.
NO_PARAMETER = 1e-8


def filled_magnitudes(problem: OrbitData, z: np.ndarray) -> np.ndarray:
    """Typical magnitudes at z, one where nothing tells. Both have the shape (N + 1,).

    A parameter that is zero but for rounding tells no magnitude.
    """
    magnitudes = problem.magnitudes_near(z)
    filled = np.where(np.isfinite(magnitudes) & (magnitudes > 0.0), magnitudes, 1.0)
    usual = problem.line.usual(problem.system)
    if abs(z[-1]) <= NO_PARAMETER * usual:
        filled[-1] = usual
    return filled


@dataclass(frozen=True)
class NullVectors:
    """Those of DF where two branches cross: two right ones, shape (2, N + 1), and the left one, (N,)."""

    plane: np.ndarray
    left: np.ndarray


def directions(there: OrbitData, z: np.ndarray, null: NullVectors, weights: np.ndarray) -> list[np.ndarray]:
    """Tangents of the two branches through a branch point z, each a unit vector in the metric.

    Each has the shape (N + 1,), as z and the weights have.
    """
    t1, t2 = (np.linalg.qr((null.plane / weights).T)[0] * weights[:, None]).T
    psi = null.left
    h1, h2 = psi @ variations.derivative_along(there, z, t1), psi @ variations.derivative_along(there, z, t2)
    form = np.array([[h1 @ t1, h1 @ t2], [h1 @ t2, h2 @ t2]])
    values, axes = np.linalg.eigh(form)
    if not values[0] < 0.0 < values[1]:
        return []
    found = []
    for sign in (1.0, -1.0):
        xy = np.sqrt(values[1]) * axes[:, 0] + sign * np.sqrt(-values[0]) * axes[:, 1]
        t = xy[0] * t1 + xy[1] * t2
        found.append(t / np.linalg.norm(t / weights))
    return found


def tangent_through(problem: OrbitData, located: Located, near: Sample) -> np.ndarray | None:
    """The tangent of a branch at its branch point: of the two, the one nearest to `near`, facing its way.

    Shape (N + 1,).
    """
    there, null = located.problem or problem, located.data
    found = directions(there, located.z, null, near.weights) if isinstance(null, NullVectors) else []
    if not found:
        return None
    products = [float((t / near.weights) @ (near.tangent / near.weights)) for t in found]
    best = int(np.argmax(np.abs(products)))
    return found[best] * np.sign(products[best])


def crossing(problem: Any, z: np.ndarray, point: SpecialPoint) -> Sequence[Seed]:
    """The branches that cross, along tangents that the parent does not have. z has the shape (N + 1,)."""
    weights, rows = filled_magnitudes(problem, z), problem.equation_scales
    count = int(point.coefficients.get("multiplicity", 1))
    u, _, vh = np.linalg.svd(problem.linearize(z).jacobian / rows[:, None] * weights)
    left, parent = u[:, -count:] / rows[:, None], np.array(point.tangent)
    if count == 1:
        nulls = [NullVectors(vh[-2:] * weights, left[:, 0])]
    else:
        kept = problem.kept_directions(z, 1.0, count)[0]
        nulls = [_in_plane(problem, z, np.array([np.append(v, 0.0), parent]), left) for v in kept]
    seeds: list[Seed] = []
    for null in nulls:
        found = directions(problem, z, null, weights)
        if len(found) < 2:
            continue
        products = [abs(float((t / weights) @ (parent / weights))) for t in found]
        other = found[int(np.argmin(products))]
        share = other[-1] / weights[-1]
        lead = share if abs(share) > 1e-6 else other[int(np.argmax(np.abs(other / weights)))]
        tangent = other * np.sign(lead)
        seeds.append(Seed("BP", z, tangent, amplitude(tangent), problem))
    return seeds


def _in_plane(problem: OrbitData, z: np.ndarray, plane: np.ndarray, left: np.ndarray) -> NullVectors:
    """A plane of null vectors that a symmetry keeps, (2, N + 1), with the one of the left ones, (N, k), that
    second derivatives along it have a part in: the symmetry keeps that as well.
    """
    bends = [left.T @ variations.derivative_along(problem, z, t) for t in plane]
    forms = [bend @ t for bend in bends for t in plane]
    return NullVectors(plane, left @ np.linalg.svd(np.array(forms))[2][0])


def second_direction(problem: OrbitData, z: np.ndarray) -> np.ndarray | None:
    """A second direction of solutions, where there is one to rounding. Both have the shape (N + 1,)."""
    jacobian = problem.linearize(z).jacobian
    weights = filled_magnitudes(problem, z)
    rows = problem.equation_scales
    _, sizes, vh = np.linalg.svd(jacobian / rows[:, None] * weights)
    return vh[-2] * weights if sizes[-1] < SINGULAR * sizes[0] else None


def amplitude(tangent: np.ndarray) -> Callable[[float], np.ndarray]:
    """How far unknowns move along a branch that begins at a right angle: the orbit's own size bounds it.

    The tangent and what is moved have the shape (N + 1,).
    """

    def reach(change: float) -> np.ndarray:
        moved = np.abs(tangent) / max(float(np.abs(tangent).max()), 1e-300)
        moved[moved < FAINT] = 0.0  # rounding of a component that the deviation has not
        moved[-1] = change
        return moved

    return reach

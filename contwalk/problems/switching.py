"""Leaving a branch point along the other solution of the algebraic branching equation (Keller 1977)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.linear import null_vectors
from contwalk.problems.problem import Seed

if TYPE_CHECKING:
    from contwalk.problems.equilibrium import Equilibrium


def directions(problem: Equilibrium, z: np.ndarray, weights: np.ndarray) -> list[np.ndarray]:
    """Tangents of the two branches through a simple branch point, each a unit vector in the metric.

    With t1, t2 spanning the null space of DF and psi its left null vector, the tangents are x t1 + y t2 with
    psi.D2F(t1,t1) x^2 + 2 psi.D2F(t1,t2) x y + psi.D2F(t2,t2) y^2 = 0. Empty where it has no real solutions.
    """
    right, left, _ = null_vectors(problem.jacobian(z), 2)
    # An orthonormal basis in the metric of the weights keeps the quadratic well scaled.
    q, _ = np.linalg.qr(right / weights[:, None])
    t1, t2 = q[:, 0] * weights, q[:, 1] * weights
    psi, inputs = left[:, 0], problem.inputs(z)
    a, b, c = (
        float(psi @ problem.kernels.second(*inputs, v.tolist(), w.tolist()))
        for v, w in ((t1, t1), (t1, t2), (t2, t2))
    )
    # The symmetric form [[a, b], [b, c]] vanishes on two lines if its eigenvalues differ in sign.
    values, vectors = np.linalg.eigh(np.array([[a, b], [b, c]]))
    if not (values[0] < 0 < values[1]):
        return []
    tangents = []
    for sign in (1.0, -1.0):
        xy = np.sqrt(values[1]) * vectors[:, 0] + sign * np.sqrt(-values[0]) * vectors[:, 1]
        t = xy[0] * t1 + xy[1] * t2
        tangents.append(t / np.linalg.norm(t / weights))
    return tangents


def tangent_through(
    problem: Equilibrium, z: np.ndarray, weights: np.ndarray, near: np.ndarray
) -> np.ndarray | None:
    """The tangent of a branch at its branch point: of the two, the one nearest to `near`, pointing the same way."""
    found = directions(problem, z, weights)
    if not found:
        return None
    products = [float((t / weights) @ (near / weights)) for t in found]
    best = int(np.argmax(np.abs(products)))
    return found[best] * np.sign(products[best])


def branch_point_seeds(problem: Equilibrium, point: SpecialPoint) -> Sequence[Seed]:
    """The branch that crosses at a branch point: its tangent there is the one that the parent does not have."""
    z = np.array(point.unknowns)
    magnitudes = problem.magnitudes(z, problem.linearize(z))
    weights = np.where(np.isfinite(magnitudes), magnitudes, 1.0)
    found = directions(problem, z, weights)
    if len(found) < 2:
        return ()
    parent = np.array(point.tangent)
    parent = parent / np.linalg.norm(parent / weights)
    products = [abs(float((t / weights) @ (parent / weights))) for t in found]
    other = found[int(np.argmin(products))]
    # Grow towards larger parameter, or where the branch leaves at a right angle, towards a larger first state.
    lead = other[-1] if abs(other[-1] / weights[-1]) > 1e-6 else other[int(np.argmax(np.abs(other / weights)))]
    return (Seed("BP", z, other * np.sign(lead), f"the other branch through {point.name or 'BP'}"),)

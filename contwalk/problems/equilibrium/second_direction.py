"""Leaving a branch point along the other solution of the algebraic branching equation (Keller 1977)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.numerics.linear import (
    EPSILON,
    Factored,
    bordered_by,
    critical_pair,
    deficiency,
    solution_plane,
    unit_in,
)
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.problem import Seed

# What two directions leave of each other, against their sizes, is rounding below this.
CANCELLED = 1e-12
# F_lambda lies in the range of F_u if what the left vector sees of it is this small a part of its terms.
IN_RANGE = 1e-8
# A coefficient this small against its terms is zero: parameters are rounded to 1e-16.
EQUAL = 1e-12
# A matrix with this condition number is singular to rounding.
SINGULAR = 1e13
# A move is rounding of zero if it is this small a part of a magnitude, or of what else moves a rate.
DUST = 1e-13


def second_direction(problem: EquilibriumEquations, z: np.ndarray) -> np.ndarray | None:
    """A null vector of F_u where F_lambda lies in its range, a second direction of solutions; else None.

    z has the shape (N + 1,), the vector (N,).
    """
    jacobian = problem.jacobian(z)
    matrix = jacobian[:, : problem.size]
    errors = problem.errors_of_matrix(z)
    if Factored(matrix).regular(10.0 * errors):
        return None
    pair = critical_pair(matrix, errors)
    column = jacobian[:, -1]
    seen, terms = abs(pair.left @ column), np.abs(pair.left) @ np.abs(column)
    noise = 1e-12 * np.linalg.norm(pair.left) * np.linalg.norm(column)
    return None if seen > IN_RANGE * terms + noise else pair.right.real


def crossing(jacobian: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """At a branch point, the left null vector of DF and the two directions of solutions.

    Shapes (N,) and (N + 1, 2) for a Jacobian of shape (N, N + 1) and weights of shape (N + 1,). Where both
    branches keep the parameter F_u alone has two null vectors, and F_lambda need not lie in its range: there
    they are those of DF.

    Raises
    ------
    numpy.linalg.LinAlgError
        If there are more than two directions.
    """
    size = len(jacobian)
    pair = critical_pair(jacobian[:, :size])
    simple = bordered_by(jacobian[:, :size], pair.right.real, pair.left.real).condition() < SINGULAR
    seen = abs(float(pair.left.real @ jacobian[:, -1])) * weights[-1]
    in_range = seen <= IN_RANGE * float(np.abs(pair.left) @ (np.abs(jacobian) @ weights))
    if not (simple and in_range):
        found = deficiency(jacobian, weights)
        if found.next * SINGULAR > 1.0:
            return found.left, found.plane
    if not simple:
        raise np.linalg.LinAlgError("There are more than two directions of solutions.")
    return pair.left.real, solution_plane(jacobian, pair)


def keep_parameter(problem: EquilibriumEquations, z: np.ndarray, weights: np.ndarray) -> bool:
    """Whether both branches through a branch point keep the parameter, so that nothing is told against it.

    z and the weights have the shape (N + 1,).
    """
    plane = crossing(problem.jacobian(z), weights)[1] / weights[:, None]
    return bool(np.all(np.abs(plane[-1]) <= IN_RANGE * np.linalg.norm(plane, axis=0)))


def directions(problem: EquilibriumEquations, z: np.ndarray, weights: np.ndarray) -> list[np.ndarray]:
    """Tangents of the two branches through a simple branch point, each a unit vector in the metric.

    With t1, t2 spanning the null space of DF, (q, 0) and (h, 1), and psi its left null vector, they are x t1
    + y t2 with psi.D2F(t1,t1) x^2 + 2 psi.D2F(t1,t2) x y + psi.D2F(t2,t2) y^2 = 0. Empty where it has no
    real solutions.
    """
    inputs = problem.inputs(z)
    try:
        psi, basis = crossing(problem.jacobian(z), weights)
    except np.linalg.LinAlgError:  # more than two branches meet here
        return []
    # An orthonormal basis in the metric of the weights keeps the quadratic well scaled.
    t1, t2 = (np.linalg.qr(basis / weights[:, None])[0] * weights[:, None]).T
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
        # What is left of terms that cancel is rounding, and would be taken for the scale of an unknown.
        t[np.abs(t) <= CANCELLED * np.linalg.norm(xy) * (np.abs(t1) + np.abs(t2))] = 0.0
        tangents.append(t / np.linalg.norm(t / weights))
    return tangents


def tangent_through(
    problem: EquilibriumEquations, z: np.ndarray, weights: np.ndarray, near: np.ndarray
) -> np.ndarray | None:
    """The tangent of a branch at its branch point: of the two, the one nearest to `near`, facing its way.

    All vectors have the shape (N + 1,). None where there are no two, or `near` is at a right angle to both.
    What of z is less than a rounding of its weight is none: a row of F_u that is made of it is zero.
    """
    found = directions(problem, np.where(np.abs(z) > EPSILON * weights, z, 0.0), weights)
    if not found:
        return None
    products = [float((t / weights) @ (near / weights)) for t in found]
    best = int(np.argmax(np.abs(products)))
    return found[best] * np.sign(products[best]) if products[best] != 0.0 else None


def branch_point_seeds(problem: EquilibriumEquations, point: SpecialPoint) -> Sequence[Seed]:
    """The branch that crosses at a branch point, along the tangent that the parent does not have."""
    z = np.array(point.unknowns)
    magnitudes = problem.linearize(z).magnitudes
    weights = np.where(np.isfinite(magnitudes), magnitudes, 1.0)
    try:
        found = directions(problem, z, weights)
    except np.linalg.LinAlgError:
        return ()
    if len(found) < 2:
        return ()
    parent = unit_in(np.array(point.tangent), weights)
    products = [abs(float((t / weights) @ (parent / weights))) for t in found]
    other = found[int(np.argmin(products))]
    # Grow towards larger parameter, or where the branch leaves at a right angle, towards a larger first
    # state.
    lead = (
        other[-1] if abs(other[-1] / weights[-1]) > 1e-6 else other[int(np.argmax(np.abs(other / weights)))]
    )
    tangent = other * np.sign(lead)

    vertical = keep_parameter(problem, z, weights)

    declared = [i for i, state in enumerate(problem.system.states) if state.scale is not None]

    def moved(change: float) -> np.ndarray:
        """How far the branch moves; what it leaves at rest moves on the parent. Declared scales stay."""
        if vertical:  # however far: the parameter does not move with it
            return np.append(np.zeros(problem.size), change)
        own = reach(problem, z, tangent, change)
        far = np.where(own > 0.0, own, reach(problem, z, parent, change))
        far[dust(problem, z, far, magnitudes)] = 0.0
        far[declared] = 0.0
        return far

    return (Seed("BP", z, tangent, moved, problem),)


def dust(problem: EquilibriumEquations, z: np.ndarray, far: np.ndarray, magnitudes: np.ndarray) -> np.ndarray:
    """Which unknowns move by nothing but rounding of zero, bool of shape (N + 1,).

    A pinned state, or the drift along a neutral direction, stays where it is; what elimination leaves of that
    would be taken for a magnitude. Of a drift the field tells: no rate changes by more than a rounding of how
    it changes by all others.
    """
    parts = np.abs(problem.jacobian(z)[: problem.states]) * far
    others = parts.sum(axis=1, keepdims=True) - parts
    unseen = np.all(parts <= DUST * others, axis=0) & np.any(others > 0.0, axis=0)
    unseen[: problem.states], unseen[-1] = False, False
    return unseen | (far <= DUST * np.nan_to_num(magnitudes, nan=0.0))


def reach(problem: EquilibriumEquations, z: np.ndarray, tangent: np.ndarray, change: float) -> np.ndarray:
    """How far each unknown moves on a branch while the parameter changes by about `change`, shape (N + 1,).

    Along a tangent with a parameter component it is linear. Without one, as at a pitchfork, the amplitude is
    the root of change / curvature, and unknowns outside the critical direction move with its square.
    """
    size = problem.size
    if tangent[-1] != 0.0 and abs(tangent[-1]) > 1e-9 * np.linalg.norm(tangent):
        return np.abs(tangent * change / tangent[-1])
    jacobian, inputs = problem.jacobian(z), problem.inputs(z)
    pair = critical_pair(jacobian[:, :size])
    q, p = pair.right.real, pair.left.real
    q1 = np.append(q, 0.0).tolist()
    bordered = Factored(np.block([[jacobian[:, :size], p[:, None]], [q[None, :], np.zeros((1, 1))]]))
    h2 = bordered.solve(np.append(-problem.kernels.second(*inputs, q1, q1), 0.0))[:size]
    h = np.append(bordered.solve(np.append(-jacobian[:, -1], 0.0))[:size], 1.0).tolist()
    cubic = problem.kernels.third(*inputs, q1, q1, q1)
    mixed = 3.0 * problem.kernels.second(*inputs, q1, np.append(h2, 0.0).tolist())
    curvature = abs(float(p @ (cubic + mixed))) / 6.0
    if 6.0 * curvature <= EQUAL * float(np.abs(p) @ (np.abs(cubic) + np.abs(mixed))):
        curvature = 0.0  # a vertical branch, as far as its rounding tells
    drive = abs(float(p @ problem.kernels.second(*inputs, q1, h)))
    amplitude = float(np.sqrt(drive * change / curvature)) if curvature > 0.0 and drive > 0.0 else 0.0
    return np.append(np.maximum(np.abs(amplitude * q), 0.5 * amplitude**2 * np.abs(h2)), change)

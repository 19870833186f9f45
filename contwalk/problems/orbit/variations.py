"""Derivatives of an orbit's Jacobian: for multipliers along a branch, and for special points."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contwalk.problems.orbit.equations import period_of
from contwalk.problems.orbit.lifts import TANGENT
from contwalk.problems.orbit.orbit_data import OrbitData


def cycle_matrix(orbit: OrbitData, jacobian: np.ndarray, multiplier: complex) -> np.ndarray:
    """L(mu): F_u, but what closes is mu times what began. Singular where mu is a multiplier.

    Shape (N, N), of the jacobian (N, N + 1).
    """
    matrix = jacobian[:, : orbit.size].astype(complex if np.imag(multiplier) else float)
    rows, place = orbit.layout.matches[-1], orbit.layout.states[0]
    matrix[rows, place] += (1.0 - multiplier) * np.eye(rows.stop - rows.start)
    if orbit.layout.sum is not None and orbit.layout.start is not None:
        matrix[orbit.layout.sum, orbit.layout.start] += 1.0 - multiplier
    return matrix


def cycle_return(orbit: OrbitData, psi: np.ndarray, v: np.ndarray) -> complex:
    """-psi* L' v, where L' is the derivative of `cycle_matrix` by the multiplier.

    Both vectors have the shape (N,).
    """
    result = complex(psi[orbit.layout.matches[-1]].conj() @ v[orbit.layout.states[0]])
    if orbit.layout.sum is not None and orbit.layout.start is not None:
        result += complex(np.conj(psi[orbit.layout.sum]) * v[orbit.layout.start])
    return result


def cycle_derivative(orbit: OrbitData, z: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Derivative by z of L v for a real v, shape (N, N + 1)."""
    return derivative_along(orbit, z, np.append(v, 0.0))


def cycle_rate(orbit: OrbitData, z: np.ndarray, v: np.ndarray, tangent: np.ndarray) -> np.ndarray:
    """Derivative of L v along a direction, for a real v, shape (N,)."""
    return rate_along(orbit, z, np.append(v, 0.0), tangent)


def rate_along(orbit: OrbitData, z: np.ndarray, v: np.ndarray, tangent: np.ndarray) -> np.ndarray:
    """Derivative of DF(z) v along a direction, for a real v, shape (N,); all others have the shape (N + 1,).

    It is symmetric in both, and costs far less than `derivative_along`.
    """
    layout, result = orbit.layout, np.zeros(orbit.size)
    for segment, piece in zip(layout.segments, orbit.segments, strict=True):
        direction, along = layout.inputs_of(segment, v), layout.inputs_of(segment, tangent)
        moved = piece.changing(*layout.inputs_of(segment, z), direction, along)
        width, rows = len(moved) // 2, segment.ends
        n = rows.stop - rows.start
        result[rows] = moved[width : width + n]
        if width > n:
            result[layout.guards + segment.leg] = moved[width + n]
    if layout.sum is not None and v[-1] != 0.0 and tangent[-1] != 0.0:
        result[layout.sum] = -tangent[-1] * period_of(orbit, z, TANGENT, v[-1:])[1]
    return result


def by_parameter(
    orbit: OrbitData, z: np.ndarray, psi: np.ndarray, vectors: Sequence[np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives by the orbit's parameter of F, shape (N,), and of -psi.(L v), shape (m,).

    `psi` has the shape (m, k, N) and there are k real v, shape (N,): m sums of k terms. One direction costs
    far less than `cycle_derivative`.
    """
    unit = np.zeros(len(z))
    unit[-1] = 1.0
    moved = [cycle_rate(orbit, z, v, unit) for v in vectors]
    values = -sum(psi[:, k] @ rate for k, rate in enumerate(moved))
    return orbit.linearize(z).jacobian[:, -1], np.asarray(values)


def derivative_along(orbit: OrbitData, z: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Derivative by z of DF(z) v for a real v of length N + 1, shape (N, N + 1)."""
    layout, result = orbit.layout, np.zeros((orbit.size, orbit.size + 1))
    for segment, piece in zip(layout.segments, orbit.segments, strict=True):
        x, scalars = layout.inputs_of(segment, z)
        direction, along = layout.inputs_of(segment, v)
        _, moved = piece.differentiated(TANGENT, np.concatenate([x, direction]), scalars, along)
        width = len(moved) // 2
        derivative = layout.along(segment, moved[width:])
        rows = segment.ends
        n = rows.stop - rows.start
        result[rows] += derivative[:n]
        if width > n:
            result[layout.guards + segment.leg] = derivative[n]
    if layout.sum is not None and v[-1] != 0.0:
        result[layout.sum, -1] = -period_of(orbit, z, TANGENT, v[-1:])[1]
    return result

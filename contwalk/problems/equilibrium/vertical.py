"""Branches along which the parameter stands still: curves of equilibria at one value of it.

Along such a branch A t = 0 for its own direction t: one eigenvalue is zero at every point. Where a second one
passes zero the two are one defective eigenvalue, known to half the digits. So the zero is taken out by going
over to the space beside t, in which the second one is simple and its sign certain.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.numerics.linear import balanced
from contwalk.numerics.spectrum import EPSILON, Spectrum, complement, spectrum
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.problem import Linearization

# A branch is not vertical with a larger share of the parameter in its tangent, in the metric; nor with more
# of it than so many roundings of the equations make; nor with so much of it in the curvature, as at a fold.
SMALL, ROUNDINGS, TURNS = 1e-9, 16.0, 1e-12
# Solutions are not taken to be known less well than by so many roundings of their weights.
UNSURE = 1e5


def bending(
    problem: EquilibriumEquations,
    z: np.ndarray,
    tangent: np.ndarray,
    weights: np.ndarray,
    here: Linearization,
    error: float,
) -> np.ndarray | None:
    """The tangent's derivative along a branch on which the parameter stands still; None on any other.

    Vectors have the shape (N + 1,). `error` is the solution's own, in the metric of `weights`.
    """
    if abs(float(tangent[-1])) > SMALL * float(weights[-1]):
        return None
    inputs, along = problem.inputs(z), tangent.tolist()
    n, last = problem.states, np.zeros(len(z))
    last[-1] = 1.0
    try:
        bordered = here.bordered(tangent / weights**2, weights)
        told = np.abs(bordered.solve_adjoint(last))[:-1]  # what the parameter takes of each equation
        curvature = bordered.solve(np.append(-problem.kernels.second(*inputs, along, along), 0.0))
    except np.linalg.LinAlgError:  # a branch point
        return None
    rounding = np.abs(here.jacobian) @ np.abs(tangent)
    rounding[:n] += problem.kernels.rounding_of_matrix(*inputs) @ np.abs(tangent[:n])
    # Terms that cancel exactly, or are noise themselves, are known as well as the place is.
    place = np.maximum(np.abs(z), min(error / EPSILON, UNSURE) * weights)
    rounding += np.abs(problem.kernels.jacobian_of_first(*inputs, along)) @ place
    noise = ROUNDINGS * EPSILON * float(told @ rounding)
    moves = abs(float(tangent[-1])) > noise
    size = float(np.linalg.norm(curvature / weights))
    turns = not abs(curvature[-1]) <= TURNS * (1.0 + size) * weights[-1] + noise
    return None if moves or turns else curvature


def spectrum_beside(
    matrices: tuple[np.ndarray, np.ndarray, np.ndarray],
    tangent: np.ndarray,
    curvature: np.ndarray,
    generators: np.ndarray,
    zeros: int,
) -> Spectrum:
    """Eigenvalues of A beside the zero of the direction t with A t = 0, which comes last.

    Parameters
    ----------
    matrices : tuple of ndarray, shape (n, n)
        A, its derivative along the branch, and the error bounds of its entries.
    tangent, curvature : ndarray, shape (n,)
        t and its derivative along the branch.
    generators, zeros
        Pinned neutral directions, as for `spectrum`.
    """
    matrix, rate, rounding = matrices
    matrix = np.where(np.abs(matrix) <= 2.0 * rounding, 0.0, matrix)
    scaled, d = balanced(matrix)
    rate, rounding = rate / d[:, None] * d, rounding / d[:, None] * d
    along, bent = tangent / d, curvature / d
    length = float(np.linalg.norm(along))
    along, bent = along / length, bent / length
    beside = complement(np.column_stack([generators / d[:, None], along]))
    # The space beside t turns as t does, which adds to the rate of what is left of A in it.
    turned = np.outer(beside.T @ bent, along @ scaled @ beside)
    rest = spectrum(
        beside.T @ scaled @ beside,
        beside.T @ rate @ beside - turned,
        np.abs(beside.T) @ rounding @ np.abs(beside),
        None,
        zeros,
    )
    return replace(
        rest,
        values=np.append(rest.values, 0.0),
        errors=np.append(rest.errors, 0.0),
        rates=np.append(rest.rates, 0.0),
        still=True,
        bordering=None if rest.bordering is None else np.append(rest.bordering, False),
    )

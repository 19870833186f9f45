"""Defining systems of the special points of equilibria.

| point | unknowns | equations | source |
|---|---|---|---|
| fold (LP) | u, lambda, v | F = 0, F_u v = 0, c.v = 1 | Moore & Spence (1980), SIAM J. Numer. Anal. 17, 567 |
| branch point (BP) | u, lambda, psi, mu | F + mu b = 0, psi F_u = 0, psi F_lambda = 0, b.psi = 1 | Moore (1980), Numer. Funct. Anal. Optim. 2, 441 |
| Hopf point (HB) | u, lambda, v, w, omega | F = 0, (A - sigma)(v + i w) = i omega (v + i w), c.(v + i w) = 1 | Griewank & Reddien (1983), IMA J. Numer. Anal. 3, 295 |
| eigenvalue at sigma | u, lambda, v | F = 0, (A - sigma) v = 0, c.v = 1 | |
| observable at c | u, lambda | F = 0, phi(u, lambda) = c | |

A is the Jacobian of the vector field by the states; sigma is zero at a bifurcation, and the wanted real part at a
mark of `max_re`.
"""  # noqa: E501 - a table

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from contwalk.fields.kernel import Kernel
from contwalk.numerics.linear import critical_pair
from contwalk.numerics.refine import DefiningSystem, Solution, newton, refine
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.problem import Located, Sample

# With this share of the parameter in it, in the metric, or less, the tangent is that of the fold nearby.
TURNING = 1e-2
# Eigenvalues this small against what they become in a unit of arclength have vanished.
VANISHED = 1e-12
# Passes of Newton's method in extended precision, and what a correction may be of the last one: at a root
# that is nearly double they halve, from the square root of a rounding to that in those digits.
NEARLY_DOUBLE = 40, 0.75
# What refinement may move Newton's solution by, in typical magnitudes.
LEFT = 1e-3


def solve(
    system: DefiningSystem,
    start: np.ndarray,
    described: Callable[[Solution], Located | None],
    unfoldings: Sequence[int] = (),
) -> Located | None:
    """Newton's method now, refinement when it is asked for; `described` reads a point out of a solution.

    `unfoldings` are the numbers of unknowns that are the rounding of the equations, which goes where these
    are exact.

    `start` holds the unknowns of the system, shape (k,).
    """
    found = newton(system, start)
    if found is None:
        return None
    # What is not refined has no error: Newton's last correction tells nothing where equations are singular.
    located = described(Solution(found, [], np.full(len(found), np.inf), refined=False))
    if located is None:
        return None

    def refined() -> Located | None:
        solution = refine(system, found)
        if not solution.refined:
            solution = refine(system, start, *NEARLY_DOUBLE)
        moved = np.abs(solution.values - found) if solution.refined else solution.errors
        moved = moved / np.maximum(np.abs(found), system.scale)
        # Refinement that ends elsewhere, or nowhere near, has left the neighbourhood of Newton's solution.
        moved[list(unfoldings)] = 0.0
        return None if np.max(moved[: system.deficient]) > LEFT else described(solution)

    return replace(located, refine=refined)


def dot(a: Sequence[float], b: Sequence[Any]) -> Any:
    """The sum of products, in the arithmetic of `b`: floats, or numbers of `mpmath`.

    Raises
    ------
    ValueError
        If one is longer than the other.
    """
    total: Any = 0
    for x, y in zip(a, b, strict=True):
        total = total + float(x) * y
    return total


def real_eigenvalue(
    problem: EquilibriumEquations, sample: Sample, shift: float | None, deficient: bool = False
) -> Located | None:
    """The point near a sample at which a real eigenvalue of A is `shift`.

    `shift` None: at which F_u is singular, pinned equations included; `deficient`: in more than one way.
    """
    size = problem.size
    m = size if shift is None else problem.states
    sigma = 0.0 if shift is None else shift
    if shift is None and not deficient and abs(sample.tangent[-1]) <= TURNING * sample.weights[-1]:
        start = sample.tangent[:m] / np.linalg.norm(sample.tangent[:m])  # the null vector at a fold
    else:
        start = critical_pair(problem.jacobian(sample.z)[:m, :m] - sigma * np.eye(m)).right.real
    c = start / np.dot(start, start)

    def split(u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        v = np.zeros(size + 1)
        v[:m] = u[size + 1 :]
        return u[: size + 1], v

    def residual(u: np.ndarray) -> np.ndarray:
        z, v = split(u)
        product = problem.kernels.first(*problem.inputs(z), v)[:m] - sigma * v[:m]
        return np.concatenate([problem.linearize(z).residual, product, [c @ v[:m] - 1.0]])

    def jacobian(u: np.ndarray) -> np.ndarray:
        z, v = split(u)
        f = problem.jacobian(z)
        matrix = np.zeros((size + m + 1, size + m + 1))
        matrix[:size, : size + 1] = f
        matrix[size : size + m, : size + 1] = problem.kernels.jacobian_of_first(*problem.inputs(z), v)[:m]
        matrix[size : size + m, size + 1 :] = f[:m, :m] - sigma * np.eye(m)
        matrix[-1, size + 1 :] = c
        return matrix

    def exactly(u: Sequence[Any]) -> list[Any]:
        z, v = u[: size + 1], [*u[size + 1 :], *[0] * (size + 1 - m)]
        inputs = problem.exact_inputs(z)
        product = problem.kernels.first.exactly(*inputs, v)[:m]
        product = [a - sigma * b for a, b in zip(product, v[:m], strict=True)]
        return [*problem.kernels.residual.exactly(*inputs), *product, dot(c, v[:m]) - 1]

    scale = np.concatenate([sample.weights, np.full(m, 1.0)])
    system = DefiningSystem(scale, residual, jacobian, exactly, size + 1 if deficient else None)

    def described(found: Solution) -> Located:
        z, v = found.values[: size + 1], found.values[size + 1 :]
        return Located(z, float(found.errors[size]), refined=found.refined, critical=v)

    return solve(system, np.concatenate([sample.z, start]), described)


def observed(
    problem: EquilibriumEquations,
    sample: Sample,
    kernels: tuple[Kernel, Kernel],
    level: float,
    limit: int | None = None,
) -> Located | None:
    """The point near a sample at which an observable has the value `level`, of a limit with its number."""
    value, gradient = kernels

    def residual(u: np.ndarray) -> np.ndarray:
        inputs = problem.inputs(u)
        return np.concatenate([problem.kernels.residual(*inputs), value(*inputs) - level])

    def jacobian(u: np.ndarray) -> np.ndarray:
        return np.vstack([problem.jacobian(u), gradient(*problem.inputs(u))])

    def exactly(u: Sequence[Any]) -> list[Any]:
        inputs = problem.exact_inputs(u)
        return [*problem.kernels.residual.exactly(*inputs), value.exactly(*inputs)[0] - level]

    def described(found: Solution) -> Located:
        return Located(found.values, float(found.errors[-1]), refined=found.refined, limit=limit)

    return solve(DefiningSystem(sample.weights, residual, jacobian, exactly), sample.z, described)

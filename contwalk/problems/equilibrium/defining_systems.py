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
from typing import TYPE_CHECKING, Any

import numpy as np

from contwalk.fields.kernel import Kernel
from contwalk.numerics.linear import EPSILON, balanced, critical_pair, deficiency, nearest_eigenpair
from contwalk.numerics.refine import DefiningSystem, Solution, newton, refine
from contwalk.problems.problem import Located, Sample

if TYPE_CHECKING:
    from contwalk.problems.equilibrium.equilibrium import Equilibrium


# With this share of the parameter in it, in the metric, or less, the tangent is that of the fold nearby.
TURNING = 1e-2
# Eigenvalues this small against what they become in a unit of arclength have vanished.
VANISHED = 1e-12


def _solve(
    system: DefiningSystem,
    start: np.ndarray,
    described: Callable[[Solution], Located | None],
    unfolds: bool = False,
) -> Located | None:
    """Newton's method now, refinement when it is asked for; `described` reads a point out of a solution.

    `unfolds`: the last unknown is the rounding of the equations, which goes where these are exact.
    """
    found = newton(system, start)
    if found is None:
        return None
    rough = Solution(found, [], np.maximum(np.abs(found), system.scale) * 1e-10, refined=False)
    located = described(rough)
    if located is None:
        return None

    def refined() -> Located | None:
        solution = refine(system, found)
        if not solution.refined:
            return located
        moved = np.abs(solution.values - found) / np.maximum(np.abs(found), system.scale)
        # Refinement that ends elsewhere has left the neighbourhood of Newton's solution.
        return None if np.max(moved[:-1] if unfolds else moved) > 1e-3 else described(solution)

    return replace(located, refine=refined)


def _dot(a: Sequence[float], b: Sequence[Any]) -> Any:
    total: Any = 0
    for x, y in zip(a, b, strict=True):
        total = total + float(x) * y
    return total


def fold(problem: Equilibrium, sample: Sample) -> Located | None:
    """The fold near a sample."""
    return _real_eigenvalue(problem, sample, shift=None)


def real_eigenvalue(problem: Equilibrium, sample: Sample, shift: float) -> Located | None:
    """The point near a sample at which a real eigenvalue of A is `shift`."""
    return _real_eigenvalue(problem, sample, shift)


def multiple_zero(problem: Equilibrium, sample: Sample) -> Located | None:
    """The point near a sample at which F_u has a null space of more than one dimension.

    The equations are those of a fold; their Jacobian is deficient, since v may turn in the null space.
    """
    located = _real_eigenvalue(problem, sample, shift=None, deficient=True)
    if located is None:
        return None
    values = np.linalg.eigvals(balanced(problem.jacobian(located.z)[:, : problem.size])[0])
    # Where all of them vanish together, what they become along the branch is a measure.
    fastest = max((abs(sample.rates[k]) for k in range(len(sample.eigenvalues))), default=0.0)
    nothing = max(1e-6 * np.abs(values).max(), VANISHED * np.nan_to_num(fastest))
    count = int(np.sum(np.abs(values) < nothing))
    if count < 2:
        return None
    refine_fold = located.refine

    def refined() -> Located | None:
        found = refine_fold() if refine_fold is not None else located
        return found and replace(found, vectors={**found.vectors, "multiplicity": count}, refine=None)

    return replace(located, vectors={**located.vectors, "multiplicity": count}, refine=refined)


def _real_eigenvalue(
    problem: Equilibrium, sample: Sample, shift: float | None, deficient: bool = False
) -> Located | None:
    """`shift` None: F_u is singular, pinned equations included; else A - shift is."""
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
        f = problem.kernels.linearization(*problem.inputs(z))
        product = problem.kernels.first(*problem.inputs(z), v)[:m] - sigma * v[:m]
        return np.concatenate([f[:, 0], product, [c @ v[:m] - 1.0]])

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
        return [*problem.kernels.residual.exactly(*inputs), *product, _dot(c, v[:m]) - 1]

    scale = np.concatenate([sample.weights, np.full(m, 1.0)])
    system = DefiningSystem(scale, residual, jacobian, exactly, deficient)

    def described(found: Solution) -> Located:
        vectors = {"right": found.values[size + 1 :], "exact": found.exact}
        return Located(found.values[: size + 1], float(found.errors[size]), vectors, found.refined)

    return _solve(system, np.concatenate([sample.z, start]), described)


def branch_point(problem: Equilibrium, sample: Sample) -> Located | None:
    """The simple branch point near a sample; None where the nearest one is unfolded (mu is not zero)."""
    there = problem.jacobian(sample.z)
    left = critical_pair(there[:, : problem.size]).left.real
    # Along a vertical branch F_u is singular everywhere, and beside a fold for another reason: DF tells.
    located = None if sample.still else _branch_point_from(problem, sample, left)
    if located is not None:
        return located
    return _branch_point_from(problem, sample, deficiency(there, sample.weights).left)


def _branch_point_from(problem: Equilibrium, sample: Sample, left: np.ndarray) -> Located | None:
    """The branch point near a sample whose left critical vector is near a given one."""
    size = problem.size
    b = start = left / np.linalg.norm(left)

    def residual(u: np.ndarray) -> np.ndarray:
        z, psi, mu = u[: size + 1], u[size + 1 : -1], u[-1]
        inputs = problem.inputs(z)
        f = problem.kernels.residual(*inputs) + mu * b
        return np.concatenate([f, problem.kernels.adjoint(*inputs, psi), [b @ psi - 1.0]])

    def jacobian(u: np.ndarray) -> np.ndarray:
        z, psi = u[: size + 1], u[size + 1 : -1]
        f = problem.jacobian(z)
        matrix = np.zeros((2 * size + 2, 2 * size + 2))
        matrix[:size, : size + 1] = f
        matrix[:size, -1] = b
        matrix[size:-1, : size + 1] = problem.kernels.jacobian_of_adjoint(*problem.inputs(z), psi)
        matrix[size:-1, size + 1 : -1] = f.T
        matrix[-1, size + 1 : -1] = b
        return matrix

    def exactly(u: Sequence[Any]) -> list[Any]:
        z, psi, mu = u[: size + 1], u[size + 1 : -1], u[-1]
        inputs = problem.exact_inputs(z)
        f = [a + float(c) * mu for a, c in zip(problem.kernels.residual.exactly(*inputs), b, strict=True)]
        return [*f, *problem.kernels.adjoint.exactly(*inputs, psi), _dot(b, psi) - 1]

    # What the roundings of the equations, and of the unknowns in them, could pass for an unfolding.
    here = problem.linearize(sample.z)
    rounding = here.levels[0] + EPSILON * (np.abs(here.jacobian) @ sample.weights)
    unfolding = float(np.max(rounding[b != 0] / np.abs(b[b != 0])))
    scale = np.concatenate([sample.weights, np.abs(start).max() * np.ones(size), [unfolding]])
    system = DefiningSystem(scale, residual, jacobian, exactly)

    def described(found: Solution) -> Located | None:
        # mu is what would have to be added to the equations for a branch point: nothing, or there is none.
        # What is below the rounding of the equations is nothing: parameters such as pi are rounded too.
        if abs(found.values[-1]) > 16.0 * unfolding:
            return None
        vectors = {"left": found.values[size + 1 : -1], "exact": found.exact}
        return Located(found.values[: size + 1], float(found.errors[size]), vectors, found.refined)

    return _solve(system, np.concatenate([sample.z, start, [0.0]]), described, unfolds=True)


def hopf(problem: Equilibrium, sample: Sample, which: int, shift: float = 0.0) -> Located | None:
    """The point near a sample at which the pair of eigenvalue number `which` has real part `shift`."""
    size, n = problem.size, problem.states
    eigenvalue = sample.eigenvalues[which]
    omega = abs(eigenvalue.imag)
    a = problem.jacobian(sample.z)[:n, :n]
    start = nearest_eigenpair(a, complex(eigenvalue.real, omega)).right.astype(complex)
    c = np.conj(start) / np.vdot(start, start).real

    def parts(u: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        return u[: size + 1], u[size + 1 : size + 1 + n] + 1j * u[size + 1 + n : -1], u[-1]

    def padded(v: np.ndarray) -> np.ndarray:
        return np.concatenate([v, np.zeros(size + 1 - n)])

    def residual(u: np.ndarray) -> np.ndarray:
        z, v, w = parts(u)
        inputs = problem.inputs(z)
        product = problem.kernels.first(*inputs, padded(v))[:n] - (shift + 1j * w) * v
        norm = c @ v - 1.0
        f = problem.kernels.residual(*inputs)
        return np.concatenate([f, product.real, product.imag, [norm.real, norm.imag]])

    def jacobian(u: np.ndarray) -> np.ndarray:
        z, v, w = parts(u)
        inputs = problem.inputs(z)
        f = problem.jacobian(z)
        matrix = np.zeros((size + 2 * n + 2, size + 2 * n + 2))
        matrix[:size, : size + 1] = f
        real, imag = slice(size, size + n), slice(size + n, size + 2 * n)
        vectors = slice(size + 1, size + 1 + 2 * n)
        matrix[real, : size + 1] = problem.kernels.jacobian_of_first(*inputs, padded(v.real))[:n]
        matrix[imag, : size + 1] = problem.kernels.jacobian_of_first(*inputs, padded(v.imag))[:n]
        matrix[size : size + 2 * n, vectors] = _complex_as_real(f[:n, :n] - shift * np.eye(n), w)
        matrix[real, -1] = v.imag
        matrix[imag, -1] = -v.real
        matrix[-2, vectors] = np.concatenate([c.real, -c.imag])
        matrix[-1, vectors] = np.concatenate([c.imag, c.real])
        return matrix

    def exactly(u: Sequence[Any]) -> list[Any]:
        z, v, y, w = u[: size + 1], u[size + 1 : size + 1 + n], u[size + 1 + n : -1], u[-1]
        inputs = problem.exact_inputs(z)
        rest = [0] * (size + 1 - n)
        av = problem.kernels.first.exactly(*inputs, [*v, *rest])[:n]
        ay = problem.kernels.first.exactly(*inputs, [*y, *rest])[:n]
        real = [p - shift * q + w * r for p, q, r in zip(av, v, y, strict=True)]
        imag = [p - shift * q - w * r for p, q, r in zip(ay, y, v, strict=True)]
        norm = [_dot(c.real, v) - _dot(c.imag, y) - 1, _dot(c.imag, v) + _dot(c.real, y)]
        return [*problem.kernels.residual.exactly(*inputs), *real, *imag, *norm]

    scale = np.concatenate([sample.weights, np.ones(2 * n), [max(omega, 1e-300)]])
    system = DefiningSystem(scale, residual, jacobian, exactly)

    def described(found: Solution) -> Located | None:
        z, v, w = parts(found.values)
        # omega = 0 is the degenerate solution of the same equations (a fold, a Bogdanov-Takens point).
        if not abs(w) > 1e-6 * omega:
            return None
        vectors = {"right": v if w > 0 else np.conj(v), "omega": abs(w), "exact": found.exact}
        return Located(z, float(found.errors[size]), vectors, found.refined)

    return _solve(system, np.concatenate([sample.z, start.real, start.imag, [omega]]), described)


def _complex_as_real(a: np.ndarray, omega: float) -> np.ndarray:
    """(A - i omega)(v + i w) as a real matrix acting on (v, w)."""
    i = omega * np.eye(len(a))
    return np.block([[a, i], [-i, a]])


def observed(
    problem: Equilibrium, sample: Sample, kernels: tuple[Kernel, Kernel], level: float
) -> Located | None:
    """The point near a sample at which an observable has the value `level`."""
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
        return Located(found.values, float(found.errors[-1]), {}, found.refined)

    return _solve(DefiningSystem(sample.weights, residual, jacobian, exactly), sample.z, described)

"""Special points of orbits as regular solutions of minimally augmented systems.

Beside F(u, lambda) = 0 stands a scalar g that vanishes where a matrix L is singular: the corner of its
bordered inverse, [L b; c* 0] [v; g] = [0; 1], with gradient g' = -psi* L' v and psi from the adjoint
system (W. Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria, 2000, chapter 3).

| point | L | further unknowns |
|---|---|---|
| LP | F_u | |
| PD | segments' derivatives, closed by -1 | |
| NS | segments' derivatives, closed by exp(i theta) | theta |
| BP | [F_u F_lambda], bordered by two rows | an unfolding mu b of F, zero where the point is one |

In an explosion of cycles the parameter stands still to the errors of the steps, and F_u is singular all
along to the same errors. A multiplier that passes one tells the fold from its neighbours (`FLAT_FOLD`): the
point is then the solution of F = 0 and that multiplier = 1, along the branch.

L' v is a second derivative of the flow. It is integrated as the derivative of the tangent lift, on the same
steps; nothing is differenced. What is left is the error of the steps themselves: a point is solved for again
on steps of a hundredth of the tolerance, and on still finer ones, whose correction is the error estimate.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from contwalk import quantities
from contwalk.errors import NotFinite
from contwalk.numerics.linear import EPSILON
from contwalk.problems.orbit.discretization import TIGHTEST
from contwalk.problems.orbit.null_vectors import bordered, critical_vectors
from contwalk.problems.orbit.protocol import Orbit
from contwalk.problems.problem import FLAT_FOLD, Located, Sample

ITERATIONS = 14
# A correction this small, in the metric, ends the iteration at once; one that no longer shrinks below the
# second bound is rounding.
SMALL, ROUNDED = 1e-13, 1e-6
# Steps of the check that gives the error, in units of the tolerance before.
CHECK = 0.03
MOST_REFINEMENTS = 4
# Displacement along the branch, in the metric, for the rate of a multiplier.
BESIDE = 1e-4

# residual (N + r,) and Jacobian (N + r, N + 1 + r') of an augmented system at its unknowns
Evaluate = Callable[["Orbit", np.ndarray], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class Augmented:
    """An augmented system for any discretisation of a problem, its start, and typical magnitudes."""

    evaluate: Evaluate
    start: np.ndarray
    scale: np.ndarray
    vectors: Callable[[Orbit, np.ndarray], dict]


def located(problem: Orbit, label: str, sample: Sample, which: int) -> Located | None:
    """The point near a sample, found on its own steps; `refine` finds it on finer ones."""
    builders = {"LP": _fold, "PD": _flip, "SB": _flip, "NS": _torus, "BP": _crossing, FLAT_FOLD: _flat_fold}
    if label not in builders:
        return None
    try:
        system = builders[label](problem, sample, which)
        return None if system is None else solved(problem, system, sample)
    except (np.linalg.LinAlgError, NotFinite):
        return None


def solved(problem: Orbit, system: Augmented, sample: Sample) -> Located | None:
    """The solution of an augmented system with its refinement."""
    rough = _newton(problem, system, system.start)
    if rough is None:
        return None
    size = problem.size
    walking = 1e3 * problem.mesh.tolerance * abs(float(rough[size]))
    located = Located(rough[: size + 1], walking, system.vectors(problem, rough), problem=problem)
    return replace(located, refine=lambda: _refined(problem, system, rough, sample))


def _refined(problem: Orbit, system: Augmented, rough: np.ndarray, sample: Sample) -> Located | None:
    """The point on steps fine enough for the accuracy that is asked for, with its estimated error."""
    size, wanted = problem.size, problem.discretization.accuracy
    tolerance = min(problem.discretization.locating, problem.mesh.tolerance)
    found, error, finer = rough, np.inf, problem
    best: tuple[float, np.ndarray, Orbit] | None = None
    for _ in range(MOST_REFINEMENTS):
        try:  # on finer steps a motion may meet what it stepped over before
            finer = problem.refined(found[: size + 1], sample.weights, tolerance)
            solution = _newton(finer, system, found)
            if solution is None:
                break
            found = solution
            checked = max(CHECK * tolerance, TIGHTEST)
            check = problem.refined(found[: size + 1], sample.weights, checked)
            correction = _correction(check, system, found)
        except NotFinite:
            break
        if correction is None:
            break
        error = 4.0 * abs(float(correction[size])) + _rounding(check, system, found)
        found, finer = found - correction, check
        if best is None or error < best[0]:
            best = (error, found, finer)
        if error <= 0.3 * wanted * abs(float(found[size])) or tolerance <= 4.0 * TIGHTEST:
            break
        tolerance = max(0.01 * tolerance, 4.0 * TIGHTEST)
    if best is None:
        return None
    error, found, finer = best
    moved = np.abs(found - rough)[: size + 1] / sample.weights
    if not np.max(moved) < 1e-2:
        return None  # refinement has left the neighbourhood
    vectors = system.vectors(finer, found)
    if "plane" in vectors:
        vectors["fallen_back"] = finer.fallen_back(found[: size + 1], sample.tangent)
    return Located(found[: size + 1], error, vectors, refined=True, problem=finer)


def _rounding(problem: Orbit, system: Augmented, y: np.ndarray) -> float:
    """What rounding of the equations does to the free parameter."""
    size = problem.size
    level, _ = problem.linearize(y[: size + 1]).levels
    own = np.minimum(
        level, 1e2 * EPSILON * (np.abs(problem.jacobian(y[: size + 1])) @ system.scale[: size + 1])
    )
    _, jacobian = system.evaluate(problem, y)
    # The last rows are bordered inverses: their terms are of size one.
    noise = np.concatenate([own, np.full(len(jacobian) - size, 1e2 * EPSILON)])
    row = problem.factored(jacobian, system.scale).solve_adjoint(np.eye(len(y))[size])
    return float(np.abs(row) @ noise) + EPSILON * abs(float(y[size]))


def _newton(problem: Orbit, system: Augmented, start: np.ndarray) -> np.ndarray | None:
    """Newton's method to the rounding of the equations; None where it does not get there."""
    y, before = start.copy(), np.inf
    for iteration in range(ITERATIONS):
        correction = _correction(problem, system, y)
        if correction is None:
            return None
        size = float(np.max(np.abs(correction) / system.scale))
        if iteration and size > 0.5 * before and before < ROUNDED:
            return y
        if not size < 1e3:
            return None
        y, before = y - correction, size
        # One more step from here would be the square of this one.
        if size < SMALL or size**2 < 1e-3 * problem.mesh.tolerance:
            return y
    return None


def _correction(problem: Orbit, system: Augmented, y: np.ndarray) -> np.ndarray | None:
    try:
        residual, jacobian = system.evaluate(problem, y)
        if not (np.all(np.isfinite(residual)) and np.all(np.isfinite(jacobian))):
            return None
        return problem.factored(jacobian, system.scale).solve(residual)
    except (np.linalg.LinAlgError, NotFinite):
        return None


# -- the systems -------------------------------------------------------------------------------------------


def _fold(problem: Orbit, sample: Sample, which: int) -> Augmented:
    """F_u singular."""
    size = problem.size
    rows, columns = problem.equation_scales, sample.weights[:size]
    b, c = critical_vectors(problem, problem.jacobian(sample.z)[:, :size] / rows[:, None] * columns)

    def scaled(there: Orbit, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, float, np.ndarray]:
        jacobian = there.linearize(z).jacobian
        v, psi, g = bordered(there, jacobian[:, :size] / rows[:, None] * columns, b, c)
        return v * columns, psi / rows, float(g.real), jacobian

    def evaluate(there: Orbit, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        v, psi, g, jacobian = scaled(there, z)
        gradient = -psi @ there.derivative_along(z, np.append(v, 0.0))
        residual = np.append(there.linearize(z).residual, g)
        return residual, np.vstack([jacobian, gradient])

    def vectors(there: Orbit, z: np.ndarray) -> dict:
        v, psi, _, _ = scaled(there, z)
        return {"right": v, "left": psi}

    return Augmented(evaluate, sample.z, sample.weights, vectors)


def _flip(problem: Orbit, sample: Sample, which: int) -> Augmented:
    """A multiplier at -1."""
    size, (rows, columns) = problem.size, problem.cycle_scales
    start = problem.cycle_matrix(problem.jacobian(sample.z), -1.0)
    b, c = critical_vectors(problem, start / rows[:, None] * columns)

    def scaled(there: Orbit, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, float, np.ndarray]:
        jacobian = there.linearize(z).jacobian
        matrix = there.cycle_matrix(jacobian, -1.0)
        v, psi, g = bordered(there, matrix / rows[:, None] * columns, b, c)
        return v * columns, psi / rows, float(g.real), jacobian

    def evaluate(there: Orbit, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        v, psi, g, jacobian = scaled(there, z)
        residual = np.append(there.linearize(z).residual, g)
        return residual, np.vstack([jacobian, -psi @ there.cycle_derivative(z, v)])

    def vectors(there: Orbit, z: np.ndarray) -> dict:
        v, psi, _, _ = scaled(there, z[: size + 1])
        return {"right": v, "left": psi, "multiplier": -1.0}

    return Augmented(evaluate, sample.z, sample.weights, vectors)


def _torus(problem: Orbit, sample: Sample, which: int, modulus: float = 1.0) -> Augmented:
    """A pair of multipliers at modulus exp(+-i theta)."""
    size, (rows, columns) = problem.size, problem.cycle_scales
    value = sample.eigenvalues[which]
    theta = abs(float(np.angle(value)))
    start = problem.cycle_matrix(problem.jacobian(sample.z), complex(value.real, abs(value.imag)))
    b, c = critical_vectors(problem, start / rows[:, None] * columns)

    def scaled(there: Orbit, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, complex, np.ndarray]:
        jacobian = there.linearize(y[: size + 1]).jacobian
        matrix = there.cycle_matrix(jacobian, modulus * np.exp(1j * y[-1]))
        v, psi, g = bordered(there, matrix / rows[:, None] * columns, b, c)
        return v * columns, psi / rows, complex(g), jacobian

    def evaluate(there: Orbit, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        z = y[: size + 1]
        v, psi, g, jacobian = scaled(there, y)
        derivative = there.cycle_derivative(z, v.real) + 1j * there.cycle_derivative(z, v.imag)
        gradient = -psi.conj() @ derivative
        turning = 1j * modulus * np.exp(1j * y[-1]) * there.cycle_return(psi, v)
        matrix = np.zeros((size + 2, size + 2))
        matrix[:size, : size + 1] = jacobian
        matrix[size, : size + 1], matrix[size + 1, : size + 1] = gradient.real, gradient.imag
        matrix[size, -1], matrix[size + 1, -1] = turning.real, turning.imag
        return np.concatenate([there.linearize(z).residual, [g.real, g.imag]]), matrix

    def vectors(there: Orbit, y: np.ndarray) -> dict:
        v, psi, _, _ = scaled(there, y)
        return {"right": v, "left": psi, "multiplier": modulus * np.exp(1j * y[-1]), "theta": float(y[-1])}

    return Augmented(evaluate, np.append(sample.z, theta), np.append(sample.weights, 1.0), vectors)


def _crossing(problem: Orbit, sample: Sample, which: int) -> Augmented:
    """[F_u F_lambda] of deficient rank: another branch passes."""
    size = problem.size
    rows, columns = problem.equation_scales, sample.weights
    own = sample.tangent / columns
    start = np.vstack([problem.jacobian(sample.z) / rows[:, None] * columns, own / np.linalg.norm(own)])
    left, other = critical_vectors(problem, start)
    b = left[:size] / np.linalg.norm(left[:size])
    c = np.linalg.qr(np.column_stack([own, other]))[0].T  # the plane of this branch and the other one

    def scaled(there: Orbit, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        jacobian = there.linearize(z).jacobian
        whole = np.zeros((size + 2, size + 2))
        whole[:size, : size + 1] = jacobian / rows[:, None] * columns
        whole[:size, -1], whole[size:, : size + 1] = b, c
        factored = there.factored(whole, np.ones(size + 2))
        right = factored.solve(np.eye(size + 2)[:, size:])
        left = factored.solve_adjoint(np.eye(size + 2)[:, -1])
        return (right[: size + 1] * columns[:, None]).T, left[:size] / rows, left[size:], jacobian

    def evaluate(there: Orbit, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        z, mu = y[: size + 1], y[-1]
        vs, psi, g, jacobian = scaled(there, z)
        matrix = np.zeros((size + 2, size + 2))
        matrix[:size, : size + 1], matrix[:size, -1] = jacobian, b * rows
        for k in range(2):
            matrix[size + k, : size + 1] = psi @ there.derivative_along(z, vs[k])
        residual = there.linearize(z).residual + mu * b * rows
        return np.concatenate([residual, -g]), matrix

    def vectors(there: Orbit, y: np.ndarray) -> dict:
        vs, psi, _, _ = scaled(there, y[: size + 1])
        return {"plane": vs, "left": psi, "unfolding": float(y[-1])}

    return Augmented(evaluate, np.append(sample.z, 0.0), np.append(sample.weights, 1.0), vectors)


# -- marks -------------------------------------------------------------------------------------------------


def observed(problem: Orbit, name: str, level: float, sample: Sample) -> Located | None:
    """The point near a sample at which an observable has a value: Newton's method along the branch."""
    from contwalk.problems.orbit import rates

    def value(there: Orbit, z: np.ndarray) -> float:
        if name != there.observable_names[-1]:
            return there.observable(name, z) - level
        found = there.multipliers(z, there.linearize(z).jacobian)
        return float(there.observables(z, found)[-1]) - level

    try:
        if name == quantities.PERIOD:
            system: Augmented | None = _lasting(level, sample)
        else:
            system = _along(sample, value, rates.of_observable(problem, name, sample))
        found = None if system is None else solved(problem, system, sample)
    except (np.linalg.LinAlgError, NotFinite):
        return None
    return found if found is not None and np.all(np.isfinite(found.z[: problem.size + 1])) else None


def _lasting(level: float, sample: Sample) -> Augmented:
    """A closure that lasts so long; unlike other observables its derivatives are known."""

    def evaluate(there: Orbit, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        linearization = there.linearize(z)
        residual = np.append(linearization.residual, there.duration(z) - level)
        return residual, np.vstack([linearization.jacobian, there.duration_gradient(z)])

    return Augmented(evaluate, sample.z, sample.weights, lambda there, z: {})


def _flat_fold(problem: Orbit, sample: Sample, which: int) -> Augmented | None:
    """A real multiplier at one, where the parameter stands still."""

    def value(there: Orbit, z: np.ndarray) -> float:
        found = there.multipliers(z, there.linearize(z).jacobian).values
        nearest = complex(found[int(np.argmin(np.abs(found - 1.0)))])
        return float(np.log(nearest.real)) if nearest.imag == 0.0 < nearest.real else float("nan")

    aside = BESIDE * sample.tangent
    slope = (value(problem, sample.z + aside) - value(problem, sample.z - aside)) / (2.0 * BESIDE)
    return _along(sample, value, slope)


def _along(sample: Sample, value: Callable[[Orbit, np.ndarray], float], slope: float) -> Augmented | None:
    """F = 0 and a function that vanishes at a point of the branch; `slope` is its rate along it there."""
    if not np.isfinite(slope) or slope == 0.0:
        return None
    gradient = slope * sample.tangent / sample.weights**2

    def evaluate(there: Orbit, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        linearization = there.linearize(z)
        residual = np.append(linearization.residual, value(there, z))
        return residual, np.vstack([linearization.jacobian, gradient])

    return Augmented(evaluate, sample.z, sample.weights, lambda there, z: {})

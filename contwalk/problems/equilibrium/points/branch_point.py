"""Simple branch points (BP), at which two branches cross.

F + mu b = 0, psi F_u = 0, psi F_lambda = 0, b.psi = 1 (Moore 1980, Numer. Funct. Anal. Optim. 2, 441); mu is
zero where it is one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.numerics.linear import EPSILON, Factored, bordered_by, critical_pair, deficiency, norm_in
from contwalk.numerics.refine import DefiningSystem, Solution
from contwalk.problems import neutral as neutrals
from contwalk.problems.equilibrium.defining_systems import dot, real_eigenvalue, solve
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.equilibrium.held_by_force import takes_force
from contwalk.problems.equilibrium.normal_forms import SURE, Forms, critical_vectors, rounded
from contwalk.problems.equilibrium.points.point import EquilibriumPoint, Form
from contwalk.problems.equilibrium.second_direction import (
    EQUAL,
    branch_point_seeds,
    keep_parameter,
    tangent_through,
)
from contwalk.problems.problem import Located, Sample, Seed, Test
from contwalk.system import Symmetry


class BranchPoint(EquilibriumPoint):
    """Another branch passes."""

    label, test, changes, singular, daughters = "BP", Test.ORIENTATION, (-1, 0, 1), True, 1

    def locate(self, problem: EquilibriumEquations, sample: Sample, which: int) -> Located | None:
        """The branch point near a sample."""
        return branch_point(problem, sample)

    def at_level(self, problem: Any, sample: Sample, which: int, level: float) -> Located | None:
        """Where the real eigenvalue is `level`."""
        return real_eigenvalue(problem, sample, level)

    def tangent(self, problem: EquilibriumEquations, located: Located, near: Sample) -> np.ndarray | None:
        """Of the two tangents there, that of the branch that `near` is on, shape (N + 1,)."""
        return tangent_through(problem, located.z, near.weights, near.tangent)

    def form(self, problem: EquilibriumEquations, located: Located, sample: Sample) -> Form:
        """Transcritical or a pitchfork, and to which side that opens."""
        return _form(problem, located, sample.weights)

    def seeds(self, problem: EquilibriumEquations, point: SpecialPoint) -> Sequence[Seed]:
        """The branch that crosses, unless what does is held by a force."""
        found = branch_point_seeds(problem, point)
        return [s for s in found if s.tangent is None or not takes_force(problem, s.z, s.tangent)]

    def has(self, point: SpecialPoint) -> bool:
        """A branch point without a multiplicity."""
        return point.label == self.label and "multiplicity" not in point.coefficients


def _form(problem: EquilibriumEquations, located: Located, weights: np.ndarray) -> Form:
    if keep_parameter(problem, located.z, weights):
        return None, None, {}, "both branches that cross here keep the parameter: there is no criticality"
    c = branch_point_coefficients(problem, located, weights)
    if takes_force(problem, located.z, np.append(c["q"], 0.0)):
        return None, None, {}, "no branch leaves: a family of equilibria changes its stability along itself"
    numbers = {name: c[name] for name in ("c11", "c12", "c22", "c", "c_error")}
    numbers["convention"] = (
        "c11 s^2 + 2 c12 s t + c22 t^2 = 0 for the directions s q + t h; "
        "c = p.(C(q,q,q) - 3 B(q, A^-1 B(q,q)))/6, |q| = 1, p.q = 1"
    )
    if c["c11"] != 0.0:
        return "transcritical", None, numbers, None
    if c["c"] == 0.0:
        note = "the other branch keeps the parameter to third order: it may be vertical"
        return "pitchfork", None, numbers, note
    if abs(c["c"]) <= SURE * c["c_error"]:
        return "pitchfork", None, numbers, "degenerate: the cubic coefficient is zero to its error"
    critical = "supercritical" if c["c"] < 0 else "subcritical"
    symmetry = _breaks(problem, located.z, c["q"])
    if symmetry is None:
        return "pitchfork", critical, numbers, None
    note = f"the branches that leave are images of each other under the symmetry '{symmetry.name}'"
    kind = "symmetry-breaking" if symmetry.role == "spatial" else "pitchfork"
    return kind, critical, numbers, note


def _breaks(problem: EquilibriumEquations, z: np.ndarray, q: np.ndarray) -> Symmetry | None:
    """The declared symmetry that a branch point's state has and its critical vector has not."""
    x, aside = z[: problem.states], 1e-3 * q[: problem.states]
    for symmetry in problem.system.symmetries:
        apart = _asymmetry(problem, symmetry, z, 0.0 * aside)
        kept = np.allclose(x + apart, x, rtol=1e-9, atol=1e-12)
        moved = aside + _asymmetry(problem, symmetry, z, aside) - apart
        if kept and not np.allclose(moved, aside, rtol=1e-6, atol=1e-12):
            return symmetry
    return None


def _asymmetry(
    problem: EquilibriumEquations, symmetry: Symmetry, z: np.ndarray, aside: np.ndarray
) -> np.ndarray:
    """How far the image of a state beside a solution is from that state, shape (n,).

    The image is moved along neutral directions and turned to where it is nearest: of angles that count from
    anywhere, the image of one that is pinned need not be that.
    """
    n, x = problem.states, z[: problem.states] + aside
    near = np.append(x, z[n:])
    shifts = [pin for pin in problem.pins if pin in problem.system.neutral]

    def shifted(image: np.ndarray) -> np.ndarray:
        values, one = problem.values_of(z), np.ones(n)
        apart = neutrals.apart_at_least(problem.system, shifts, image, x, values, one, range(n))
        return np.append(x + apart, z[n:])

    image = shifted(problem.image(symmetry.name, near)[:n])
    turned = shifted(problem.nearest_turn(image, near)[:n])[:n]
    return turned - x


# -- the equations -----------------------------------------------------------------------------------------


def branch_point(problem: EquilibriumEquations, sample: Sample) -> Located | None:
    """The simple branch point near a sample; None where the nearest one is unfolded (mu is not zero)."""
    there = problem.jacobian(sample.z)
    left = critical_pair(there[:, : problem.size], problem.errors_of_matrix(sample.z)).left.real
    # Along a vertical branch F_u is singular everywhere, and beside a fold for another reason: DF tells.
    located = None if sample.still else _branch_point_from(problem, sample, left)
    # Farther off errors tell little of which direction is critical: an entry that is small is known as well.
    other = _branch_point_from(problem, sample, deficiency(there, sample.weights).left)
    if located is None or other is None:
        return located or other
    away, nearer = (norm_in(found.z - sample.z, sample.weights) for found in (located, other))
    return other if nearer < 0.5 * away else located


def _branch_point_from(problem: EquilibriumEquations, sample: Sample, left: np.ndarray) -> Located | None:
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
        return [*f, *problem.kernels.adjoint.exactly(*inputs, psi), dot(b, psi) - 1]

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
        return Located(found.values[: size + 1], float(found.errors[size]), found.exact, found.refined)

    return solve(system, np.concatenate([sample.z, start, [0.0]]), described, unfoldings=(-1,))


# -- the normal form ---------------------------------------------------------------------------------------


def branch_point_coefficients(
    problem: EquilibriumEquations, located: Located, weights: np.ndarray
) -> dict[str, Any]:
    """Coefficients of the algebraic branching equation and of the reduced equation along the critical vector.

    With q the null vector of F_u and h solving F_u h = -F_lambda, the branches leave along s q + t h, where
    c11 s^2 + 2 c12 s t + c22 t^2 = 0 (Keller 1977). c11 = 0: one branch has no component in the parameter,
    a pitchfork, and the cubic coefficient c = p.(C(q,q,q) - 3 B(q, A^-1 B(q,q))) / 6 decides. Its error is
    how far it moves while the solution moves by roundings of its own and of its weights, shape (N + 1,), and
    F_u by its errors, so that c is not known where another eigenvalue is hardly known from zero.
    "q" of the result has the shape (N,).
    """
    size, z = problem.size, located.z
    jacobian = problem.jacobian(z)
    q, p = critical_vectors(problem, z)
    bordered = bordered_by(jacobian[:, :size], q, p)
    h = bordered.solve(np.append(-jacobian[:, -1], 0.0))[:size]
    forms = Forms(problem, z)
    q1, h1 = np.append(q, 0.0), np.append(h, 1.0)
    c11 = float(p @ forms.second(q1, q1))
    moving = forms.second(q1, h1)
    c12 = float(p @ moving)
    c22 = float(p @ forms.second(h1, h1))
    errors = problem.errors_of_matrix(z)
    c = _cubic(problem, z, bordered, q, p)
    moves = zip(rounded(z, weights), (errors, -errors), strict=True)
    c_error = max(abs(_moved_cubic(problem, there, more, q, p) - c) for there, more in moves)
    # Where c12 is rounding p may as well be that of another eigenvalue, which is not known from zero either.
    if abs(c12) <= SURE * EPSILON * float(np.linalg.norm(p) * np.linalg.norm(moving)):
        c_error = np.inf
    # How far the parameter moves while the unknowns move by their typical magnitudes along q, to second and
    # to third order, against its own magnitude.
    reach = 1.0 / float(np.linalg.norm(q / weights[:-1]))
    drive = abs(2.0 * c12 * weights[-1])
    if abs(c11) * reach <= EQUAL * drive or is_pitchfork(problem, located, q, p):
        c11 = 0.0
    return {"c11": c11, "c12": c12, "c22": c22, "c": c, "c_error": c_error, "q": q}


def _cubic(
    problem: EquilibriumEquations, z: np.ndarray, bordered: Factored, q: np.ndarray, p: np.ndarray
) -> float:
    """c of the reduced equation along the critical vector, zero where it is nothing against its terms."""
    size, forms = problem.size, Forms(problem, z)
    h2 = bordered.solve(np.append(forms.second(q, q), 0.0))[:size]
    cubic, mixed = forms.third(q, q, q), 3.0 * forms.second(q, h2)
    c = float(p @ (cubic - mixed)) / 6.0
    return c if abs(6.0 * c) > EQUAL * float(np.abs(p) @ (np.abs(cubic) + np.abs(mixed))) else 0.0


def _moved_cubic(
    problem: EquilibriumEquations, z: np.ndarray, more: np.ndarray, q: np.ndarray, p: np.ndarray
) -> float:
    """c at a place beside the point, with F_u changed by as much as it is not known to, shape (N, N).

    Its critical vectors are as large along q and p as these: a state in large units would change lengths.
    """
    size, signs = problem.size, np.cos(np.arange(1.0, problem.size + 1.0))  # none of a machine's symmetries
    matrix = problem.jacobian(z)[:, :size] + more * np.sign(np.outer(signs, signs[::-1]))
    unit = np.append(np.zeros(size), 1.0)
    bordered = bordered_by(matrix, q, p)
    right, left = bordered.solve(unit)[:size], bordered.solve_adjoint(unit)[:size]
    return _cubic(problem, z, bordered, right, left * float(p @ p))


def is_pitchfork(
    problem: EquilibriumEquations, located: Located[list[Any]], q: np.ndarray, p: np.ndarray
) -> bool:
    """Whether p.B(q, q) vanishes, judged in extended precision at the refined point.

    A pitchfork is a statement of equality; in floats it could not be told from a transcritical point
    that is nearly one.
    """
    if not located.refined:
        return False
    import mpmath

    from contwalk.numerics.refine import DIGITS

    size = problem.size
    with mpmath.workdps(DIGITS):
        exact = located.data
        inputs = problem.exact_inputs(exact[: size + 1])
        psi = exact[size + 1 : 2 * size + 1]
        vector = _refined_null_vector(problem, inputs, q, p)
        product = problem.kernels.second.exactly(*inputs, vector, vector)
        value = sum((a * b for a, b in zip(psi, product, strict=True)), mpmath.mpf(0))
        magnitude = sum((abs(a * b) for a, b in zip(psi, product, strict=True)), mpmath.mpf(0))
        cubic = problem.kernels.third.exactly(*inputs, vector, vector, vector)
        magnitude += sum((abs(a * b) for a, b in zip(psi, cubic, strict=True)), mpmath.mpf(0))
        return bool(abs(value) <= EQUAL * magnitude)


def _refined_null_vector(
    problem: EquilibriumEquations, inputs: Sequence[Any], q: np.ndarray, p: np.ndarray
) -> list[Any]:
    """The null vector q of F_u in extended precision, padded with a zero for the parameter."""
    import mpmath

    size = problem.size
    z = np.array([float(v) for v in [*inputs[0], *inputs[1]]])
    bordered = bordered_by(problem.jacobian(z)[:, :size], q, p)
    vector = [mpmath.mpf(float(v)) for v in q]
    for _ in range(4):
        residual = problem.kernels.first.exactly(*inputs, [*vector, 0])
        largest = max(abs(r) for r in residual)
        if largest == 0:
            break
        right = np.array([float(r / largest) for r in residual] + [0.0])
        correction = bordered.solve(right)[:size]
        vector = [v - largest * float(c) for v, c in zip(vector, correction, strict=True)]
    return [*vector, 0]

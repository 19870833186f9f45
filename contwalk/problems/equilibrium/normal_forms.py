"""Normal forms of the special points of equilibria, from exact second and third derivatives.

Notation (docs/theory.md): q right and p left critical vector with |q| = 1 and p.q = 1; B and C the second
and third derivatives of the vector field by the states.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from contwalk.numerics.linear import Factored, critical_pair, nearest_eigenpair
from contwalk.problems.equilibrium.second_direction import EQUAL
from contwalk.problems.problem import Located

if TYPE_CHECKING:
    from contwalk.problems.equilibrium.equilibrium import Equilibrium

# How many roundings away a solution is looked at to tell how well a coefficient is known.
ROUNDINGS = 4.0


class _Forms:
    """B and C at one point, for vectors of unknowns or of unknowns and parameter."""

    def __init__(self, problem: Equilibrium, z: np.ndarray) -> None:
        self._inputs = problem.inputs(z)
        self._kernels = problem.kernels
        self._length = problem.size + 1

    def _padded(self, v: np.ndarray) -> np.ndarray:
        return np.concatenate([v, np.zeros(self._length - len(v))])

    def second(self, v: np.ndarray, w: np.ndarray) -> np.ndarray:
        return self._kernels.second(*self._inputs, self._padded(v), self._padded(w))

    def third(self, v: np.ndarray, w: np.ndarray, y: np.ndarray) -> np.ndarray:
        return self._kernels.third(*self._inputs, self._padded(v), self._padded(w), self._padded(y))


def critical_vectors(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """q and p of a singular matrix, |q| = 1, p.q = 1 (or |p| = 1 where p.q vanishes, a double zero).

    The sign of q makes its largest entry positive.
    """
    pair = critical_pair(matrix)
    q, p = pair.right.real, pair.left.real
    sign = np.sign(q[np.argmax(np.abs(q))])
    return sign * q, sign * p


def fold_coefficients(problem: Equilibrium, located: Located) -> dict[str, Any]:
    """a = p.B(q, q) / 2 of the normal form y' = b mu + a y^2 (Kuznetsov 2004, eq. 5.20 and section 3.3).

    `b` = p.f_lambda, mu being the free parameter minus its value at the fold.
    """
    jacobian = problem.jacobian(located.z)
    q, p = critical_vectors(jacobian[:, : problem.size])
    forms = _Forms(problem, located.z)
    return {
        "a": 0.5 * float(p @ forms.second(q, q)),
        "b": float(p @ jacobian[:, -1]),
        "convention": "y' = b mu + a y^2, a = p.B(q,q)/2, |q| = 1, p.q = 1 (Kuznetsov 2004, section 5.4)",
    }


def hopf_coefficients(problem: Equilibrium, located: Located, weights: np.ndarray) -> dict[str, Any]:
    """First Lyapunov coefficient with its estimated error, and how fast the pair crosses.

    The error is how far l1 moves while the solution moves by roundings of its own and of its weights.
    """
    omega = float(located.vectors["omega"])
    q = located.vectors["right"] / np.linalg.norm(located.vectors["right"])
    l1, q, p = _lyapunov(problem, located.z, omega, q)
    moved = [_lyapunov(problem, z, omega, q)[0] for z in _rounded(located.z, weights)]
    return {
        "l1": l1,
        "l1_error": max(abs(value - l1) for value in moved),
        "omega": omega,
        "crossing_rate": problem.crossing_rate(located.z, q, p),
        "convention": "Kuznetsov 2004, eq. 5.34: l1 = Re(c1)/omega with <q,q> = 1, <p,q> = 1",
    }


def _rounded(z: np.ndarray, weights: np.ndarray) -> list[np.ndarray]:
    """Two neighbours of a solution, some roundings away from it in every state, the parameter as it is."""
    apart = ROUNDINGS * np.finfo(float).eps * np.maximum(np.abs(z), weights)
    apart[-1] = 0.0
    signs = np.cos(np.arange(1.0, len(z) + 1.0))  # no symmetry of a machine has these
    return [z + apart * signs, z - apart * signs]


def _lyapunov(
    problem: Equilibrium, z: np.ndarray, omega: float, q: np.ndarray
) -> tuple[float, np.ndarray, np.ndarray]:
    """l1 with its critical vectors q and p (Kuznetsov 2004, eq. 5.34), <q, q> = 1, <p, q> = 1.

    l1 = Re[<p, C(q,q,q*)> - 2 <p, B(q, A^-1 B(q,q*))> + <p, B(q*, (2 i w - A)^-1 B(q,q))>] / (2 w).
    Where neutral directions are pinned, A is singular along the family and A^-1 is taken with the pin in
    place.
    """
    n = problem.states
    a = problem.jacobian(z)[:n, :n]
    p = nearest_eigenpair(a, 1j * omega).left  # a row vector: <p, x> is p @ x
    p = p / (p @ q)
    forms = _Forms(problem, z)
    h11 = problem.solve_states(z, forms.second(q, np.conj(q))[:n])
    h20 = np.linalg.solve(2j * omega * np.eye(n) - a, forms.second(q, q)[:n])
    total = (
        p @ forms.third(q, q, np.conj(q))[:n]
        - 2.0 * p @ forms.second(q, h11)[:n]
        + p @ forms.second(np.conj(q), h20)[:n]
    )
    return float(total.real) / (2.0 * omega), q, p


def branch_point_coefficients(problem: Equilibrium, located: Located, weights: np.ndarray) -> dict[str, Any]:
    """Coefficients of the algebraic branching equation and of the reduced equation along the critical vector.

    With q the null vector of F_u and h solving F_u h = -F_lambda, the branches leave along s q + t h, where
    c11 s^2 + 2 c12 s t + c22 t^2 = 0 (Keller 1977). c11 = 0: one branch has no component in the parameter,
    a pitchfork, and the cubic coefficient c = p.(C(q,q,q) - 3 B(q, A^-1 B(q,q))) / 6 decides. Its error is
    how far it moves while the solution moves by roundings of its own and of its weights.
    """
    size, z = problem.size, located.z
    jacobian = problem.jacobian(z)
    q, p = critical_vectors(jacobian[:, :size])
    h = _bordered(jacobian[:, :size], q, p).solve(np.append(-jacobian[:, -1], 0.0))[:size]
    forms = _Forms(problem, z)
    q1, h1 = np.append(q, 0.0), np.append(h, 1.0)
    c11 = float(p @ forms.second(q1, q1))
    c12 = float(p @ forms.second(q1, h1))
    c22 = float(p @ forms.second(h1, h1))
    c = _cubic(problem, z, q, p)
    c_error = max(abs(_cubic(problem, moved, q, p) - c) for moved in _rounded(z, weights))
    # How far the parameter moves while the unknowns move by their typical magnitudes along q, to second and
    # to third order, against its own magnitude.
    reach = 1.0 / float(np.linalg.norm(q / weights[:-1]))
    drive = abs(2.0 * c12 * weights[-1])
    if abs(c11) * reach <= EQUAL * drive or is_pitchfork(problem, located, q, p):
        c11 = 0.0
    return {"c11": c11, "c12": c12, "c22": c22, "c": c, "c_error": c_error, "q": q}


def _cubic(problem: Equilibrium, z: np.ndarray, q: np.ndarray, p: np.ndarray) -> float:
    """c of the reduced equation along the critical vector, zero where it is nothing against its terms."""
    size, forms = problem.size, _Forms(problem, z)
    matrix = problem.jacobian(z)[:, :size]
    h2 = _bordered(matrix, q, p).solve(np.append(forms.second(q, q), 0.0))[:size]
    cubic, mixed = forms.third(q, q, q), 3.0 * forms.second(q, h2)
    c = float(p @ (cubic - mixed)) / 6.0
    return c if abs(6.0 * c) > EQUAL * float(np.abs(p) @ (np.abs(cubic) + np.abs(mixed))) else 0.0


def _bordered(matrix: np.ndarray, q: np.ndarray, p: np.ndarray) -> Factored:
    """A singular matrix bordered by its critical vectors."""
    return Factored(np.block([[matrix, p[:, None]], [q[None, :], np.zeros((1, 1))]]))


def is_pitchfork(problem: Equilibrium, located: Located, q: np.ndarray, p: np.ndarray) -> bool:
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
        exact: Sequence[Any] = located.vectors["exact"]
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
    problem: Equilibrium, inputs: Sequence[Any], q: np.ndarray, p: np.ndarray
) -> list[Any]:
    """The null vector q of F_u in extended precision, padded with a zero for the parameter."""
    import mpmath

    size = problem.size
    z = np.array([float(v) for v in [*inputs[0], *inputs[1]]])
    bordered = Factored(
        np.block([[problem.jacobian(z)[:, :size], p[:, None]], [q[None, :], np.zeros((1, 1))]])
    )
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

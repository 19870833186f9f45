"""Saddles whose leading stable and leading unstable real eigenvalue add to zero (SQ).

A homoclinic orbit of a saddle with a negative sum gives birth to a stable cycle, of one with a positive sum
to one that is not (L. P. Shilnikov and others, Methods of Qualitative Theory in Nonlinear Dynamics, part II,
2001, chapter 13).

| unknowns | equations |
|---|---|
| u, lambda, v, w, mu | F = 0, A v = mu v, c.v = 1, A w = -mu w, d.w = 1 |
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from contwalk.numerics.refine import DefiningSystem, Solution
from contwalk.problems.equilibrium.defining_systems import dot, solve
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.equilibrium.points.point import EquilibriumPoint, Form
from contwalk.problems.problem import Located, Sample, Test


class SaddleQuantity(EquilibriumPoint):
    """The leading eigenvalues of a saddle, both real, add to zero."""

    label, test = "SQ", Test.VALUE

    def value(self, problem: EquilibriumEquations, sample: Sample) -> float:
        """1 / stable + 1 / unstable: zero with their sum, and a pole where one of them passes zero.

        The sum jumps there. NaN where there is no saddle, or a leading eigenvalue has a partner.
        """
        stable, unstable = _leading(sample.eigenvalues)
        return 1.0 / stable + 1.0 / unstable

    def locate(self, problem: EquilibriumEquations, sample: Sample, which: int) -> Located | None:
        """The point near a sample: both eigenvalues and their vectors are unknowns."""
        n, size = problem.states, problem.size
        v, w, mu = _begun(problem.jacobian(sample.z)[:n, :n], sample.eigenvalues)
        c, d = v / (v @ v), w / (w @ w)

        def split(u: Sequence[Any]) -> tuple[Any, Any, Any, Any]:
            return u[: size + 1], u[size + 1 : size + 1 + n], u[size + 1 + n : -1], u[-1]

        def residual(u: np.ndarray) -> np.ndarray:
            z, v, w, mu = split(u)
            a = problem.jacobian(z)[:n, :n]
            f = problem.linearize(z).residual
            return np.concatenate([f, a @ v - mu * v, [c @ v - 1.0], a @ w + mu * w, [d @ w - 1.0]])

        def jacobian(u: np.ndarray) -> np.ndarray:
            z, v, w, mu = split(u)
            f, inputs = problem.jacobian(z), problem.inputs(z)
            rest = np.zeros(size + 1 - n)
            bent = [problem.kernels.jacobian_of_first(*inputs, np.append(x, rest))[:n] for x in (v, w)]
            a, square = f[:n, :n], np.zeros((n, n))
            return np.block(
                [
                    [f, np.zeros((size, 2 * n + 1))],
                    [bent[0], a - mu * np.eye(n), square, -v[:, None]],
                    [np.zeros(size + 1), c, np.zeros(n + 1)],
                    [bent[1], square, a + mu * np.eye(n), w[:, None]],
                    [np.zeros(size + 1 + n), d, 0.0],
                ]
            )

        def exactly(u: Sequence[Any]) -> list[Any]:
            z, v, w, mu = split(u)
            inputs, rest = problem.exact_inputs(z), [0] * (size + 1 - n)
            turned = [problem.kernels.first.exactly(*inputs, [*x, *rest])[:n] for x in (v, w)]
            first = [a - mu * b for a, b in zip(turned[0], v, strict=True)]
            second = [a + mu * b for a, b in zip(turned[1], w, strict=True)]
            f = problem.kernels.residual.exactly(*inputs)
            return [*f, *first, dot(c, v) - 1, *second, dot(d, w) - 1]

        def described(found: Solution) -> Located:
            modulus = abs(float(found.values[-1]))
            return Located(found.values[: size + 1], float(found.errors[size]), modulus, found.refined)

        scale = np.concatenate([sample.weights, np.ones(2 * n), [abs(mu)]])
        start = np.concatenate([sample.z, v, w, [mu]])
        return solve(DefiningSystem(scale, residual, jacobian, exactly), start, described)

    def form(self, problem: EquilibriumEquations, located: Located[float], sample: Sample) -> Form:
        """The modulus of both eigenvalues."""
        return None, None, {"eigenvalue": located.data}, None


def _leading(eigenvalues: np.ndarray) -> tuple[float, float]:
    """The eigenvalues nearest to zero on both sides; NaN where there are none, or not real ones."""
    real, nothing = eigenvalues.real, complex("nan")
    stable = eigenvalues[real == np.max(real[real < 0.0], initial=-np.inf)]
    unstable = eigenvalues[real == np.min(real[real > 0.0], initial=np.inf)]
    first, second = (side[0] if len(side) == 1 else nothing for side in (stable, unstable))
    return tuple(x.real if x.imag == 0.0 else np.nan for x in (first, second))  # type: ignore[return-value]


def _begun(a: np.ndarray, eigenvalues: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Vectors (n,) of the leading eigenvalues of A, shape (n, n), stable and unstable, and half their gap."""
    values, vectors = np.linalg.eig(a)
    stable, unstable = _leading(eigenvalues)
    v, w = (vectors[:, np.argmin(np.abs(values - wanted))].real for wanted in (stable, unstable))
    return v, w, 0.5 * (stable - unstable)

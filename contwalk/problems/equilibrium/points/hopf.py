"""Hopf points (HB), at which cycles are born.

F = 0, (A - sigma)(v + i w) = i omega (v + i w), c.(v + i w) = 1 (Griewank & Reddien 1983, IMA J. Numer.
Anal. 3, 295); sigma is zero, and the wanted real part where that is marked.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.numerics.linear import EPSILON, nearest_eigenpair
from contwalk.numerics.refine import DefiningSystem, Solution
from contwalk.problems.equilibrium.defining_systems import dot, solve
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.equilibrium.normal_forms import ROUNDINGS, SURE, rounded
from contwalk.problems.equilibrium.points.lyapunov import lyapunov
from contwalk.problems.equilibrium.points.point import EquilibriumPoint, Form
from contwalk.problems.equilibrium.points.several_waves import waves_at
from contwalk.problems.problem import Located, Sample, Seed, Test

# What a critical vector has for itself, where there are several.
OF_ONE = ("l1", "l1_error", "convention")
ZERO_TOO = "degenerate: an eigenvalue is zero as well, so there is no first Lyapunov coefficient"


@dataclass(frozen=True)
class ImaginaryPair:
    """The eigenvalues +-i omega of a Hopf point, and the complex right vector of i omega, shape (n,)."""

    omega: float
    right: np.ndarray


class Hopf(EquilibriumPoint):
    """A pair of complex eigenvalues passes the imaginary axis."""

    label, test, changes, births, daughters = "HB", Test.STABILITY, (-2, 2), True, 1

    def tells(self, problem: EquilibriumEquations, sample: Sample, which: int) -> bool:
        """A complex pair; real eigenvalues are told by the tests of folds and branch points."""
        return bool(sample.eigenvalues[which].imag != 0.0)

    def locate(self, problem: EquilibriumEquations, sample: Sample, which: int) -> Located | None:
        """The Hopf point near a sample."""
        return hopf(problem, sample, which)

    def at_level(self, problem: Any, sample: Sample, which: int, level: float) -> Located | None:
        """Where the real part is `level`."""
        return hopf(problem, sample, which, level)

    def form(self, problem: EquilibriumEquations, located: Located[ImaginaryPair], sample: Sample) -> Form:
        """The first Lyapunov coefficient, and the side to which cycles are born."""
        try:
            coefficients = hopf_coefficients(problem, located, sample.weights)
        except np.linalg.LinAlgError:  # A is singular: right at a fold
            return None, None, {"omega": located.data.omega}, ZERO_TOO
        criticality, note = _criticality(problem, coefficients)
        waves = waves_at(problem, located.z, coefficients["omega"])
        if waves is None:
            return None, criticality, coefficients, note
        # Along any other vector the coefficient is another one.
        each = [hopf_coefficients(problem, located, sample.weights, q) for q in waves.vectors]
        kinds = [_criticality(problem, own)[0] for own in each]
        told = {name: value for name, value in coefficients.items() if name not in OF_ONE}
        sentence = waves.sentence(problem.system.state_names, kinds)
        common = kinds[0] if len(set(kinds)) == 1 else None
        return None, common, told | {"multiplicity": waves.pairs}, sentence

    def seeds(self, problem: EquilibriumEquations, point: SpecialPoint) -> Sequence[Seed]:
        """The cycle that is born."""
        # Compiled flows, where they are wanted.
        from contwalk.problems.equilibrium.points.hopf_to_orbit import from_hopf

        seeds = from_hopf(problem, point)
        if not problem.system.has_events:
            return seeds
        from contwalk.problems.hybrid.birth import eventful

        return [eventful(seed) for seed in seeds]

    def critical(self, point: SpecialPoint, sample: Sample) -> complex:
        """i omega."""
        return 1j * float(point.coefficients["omega"])


def _criticality(
    problem: EquilibriumEquations, coefficients: dict[str, Any]
) -> tuple[str | None, str | None]:
    """Criticality and note of a Hopf point."""
    if abs(coefficients["l1"]) <= SURE * coefficients["l1_error"]:
        return None, "degenerate: the first Lyapunov coefficient is zero to its error"
    criticality = "supercritical" if coefficients["l1"] < 0 else "subcritical"
    held = "l1 is that of the motion with the pinned neutral directions held"
    return criticality, held if problem.pins else None


# -- the equations -----------------------------------------------------------------------------------------


def hopf(problem: EquilibriumEquations, sample: Sample, which: int, shift: float = 0.0) -> Located | None:
    """The point near a sample at which the pair of eigenvalue number `which` has real part `shift`."""
    size, n = problem.size, problem.states
    eigenvalue = sample.eigenvalues[which]
    omega = abs(eigenvalue.imag)
    a = problem.jacobian(sample.z)[:n, :n]
    start = nearest_eigenpair(a, complex(eigenvalue.real, omega)).right.astype(complex)
    equations = _Equations(problem, np.conj(start) / np.vdot(start, start).real, shift)
    scale = np.concatenate([sample.weights, np.ones(2 * n), [max(omega, 1e-300)]])
    system = DefiningSystem(scale, equations.residual, equations.jacobian, equations.exactly)

    def described(found: Solution) -> Located | None:
        z, v, w = equations.parts(found.values)
        # omega = 0 is the degenerate solution of the same equations (a fold, a Bogdanov-Takens point).
        if not abs(w) > 1e-6 * omega:
            return None
        own = ImaginaryPair(abs(float(w)), v if w > 0 else np.conj(v))
        return Located(z, float(found.errors[size]), own, found.refined)

    begun = np.concatenate([sample.z, start.real, start.imag, [omega]])
    # Where pairs pass together, with one frequency, the vector may turn among theirs.
    turning = replace(system, deficient=size + 1)
    return solve(system, begun, described) or solve(turning, begun, described)


class _Equations:
    """The equations of a Hopf point in u = (z, v, w, omega), of shape (N + 2 n + 2,).

    Parameters
    ----------
    problem : EquilibriumEquations
    c : ndarray, shape (n,)
        Complex; what the eigenvector is scaled by.
    shift : float
        The real part that is wanted.
    """

    def __init__(self, problem: EquilibriumEquations, c: np.ndarray, shift: float) -> None:
        self._problem, self._shift = problem, shift
        self._c: Any = c
        self._size, self._n = problem.size, problem.states

    def parts(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        """z, the complex eigenvector and omega."""
        size, n = self._size, self._n
        return u[: size + 1], u[size + 1 : size + 1 + n] + 1j * u[size + 1 + n : -1], u[-1]

    def _padded(self, v: np.ndarray) -> np.ndarray:
        return np.concatenate([v, np.zeros(self._size + 1 - self._n)])

    def residual(self, u: np.ndarray) -> np.ndarray:
        problem, n = self._problem, self._n
        z, v, w = self.parts(u)
        inputs = problem.inputs(z)
        product = problem.kernels.first(*inputs, self._padded(v))[:n] - (self._shift + 1j * w) * v
        norm = self._c @ v - 1.0
        f = problem.kernels.residual(*inputs)
        return np.concatenate([f, product.real, product.imag, [norm.real, norm.imag]])

    def jacobian(self, u: np.ndarray) -> np.ndarray:
        problem, size, n, c = self._problem, self._size, self._n, self._c
        z, v, w = self.parts(u)
        inputs = problem.inputs(z)
        f = problem.jacobian(z)
        matrix = np.zeros((size + 2 * n + 2, size + 2 * n + 2))
        matrix[:size, : size + 1] = f
        real, imag = slice(size, size + n), slice(size + n, size + 2 * n)
        vectors = slice(size + 1, size + 1 + 2 * n)
        matrix[real, : size + 1] = problem.kernels.jacobian_of_first(*inputs, self._padded(v.real))[:n]
        matrix[imag, : size + 1] = problem.kernels.jacobian_of_first(*inputs, self._padded(v.imag))[:n]
        matrix[size : size + 2 * n, vectors] = _complex_as_real(f[:n, :n] - self._shift * np.eye(n), w)
        matrix[real, -1] = v.imag
        matrix[imag, -1] = -v.real
        matrix[-2, vectors] = np.concatenate([c.real, -c.imag])
        matrix[-1, vectors] = np.concatenate([c.imag, c.real])
        return matrix

    def exactly(self, u: Sequence[Any]) -> list[Any]:
        """As `residual`, in numbers of `mpmath`."""
        kernels, size, n, c, shift = self._problem.kernels, self._size, self._n, self._c, self._shift
        z, v, y, w = u[: size + 1], u[size + 1 : size + 1 + n], u[size + 1 + n : -1], u[-1]
        inputs = self._problem.exact_inputs(z)
        rest = [0] * (size + 1 - n)
        av = kernels.first.exactly(*inputs, [*v, *rest])[:n]
        ay = kernels.first.exactly(*inputs, [*y, *rest])[:n]
        real = [p - shift * q + w * r for p, q, r in zip(av, v, y, strict=True)]
        imag = [p - shift * q - w * r for p, q, r in zip(ay, y, v, strict=True)]
        norm = [dot(c.real, v) - dot(c.imag, y) - 1, dot(c.imag, v) + dot(c.real, y)]
        return [*kernels.residual.exactly(*inputs), *real, *imag, *norm]


def _complex_as_real(a: np.ndarray, omega: float) -> np.ndarray:
    """(A - i omega)(v + i w) as a real matrix acting on (v, w)."""
    i = omega * np.eye(len(a))
    return np.block([[a, i], [-i, a]])


# -- the normal form ---------------------------------------------------------------------------------------


def hopf_coefficients(
    problem: EquilibriumEquations,
    located: Located[ImaginaryPair],
    weights: np.ndarray,
    along: np.ndarray | None = None,
) -> dict[str, Any]:
    """First Lyapunov coefficient with its estimated error, and how fast the pair crosses.

    The weights have the shape (N + 1,), a critical vector (n,), where there are several. The error is how far
    l1 moves while the solution moves by roundings of its own and of its weights, and a rounding of the terms
    that l1 is the sum of, or as many as critical vectors lose that are several: where all terms are
    imaginary, as in a conservative machine, their real parts are rounding.
    """
    omega, q = located.data.omega, located.data.right if along is None else along
    q = q / np.linalg.norm(q)
    here = lyapunov(problem, located.z, omega, q)
    moved = [lyapunov(problem, z, omega, q).l1 for z in rounded(located.z, weights)]
    # Several that pass together are known by the condition of their space, whatever the states' units are.
    loss = 1.0 if along is None else ROUNDINGS * float(np.linalg.norm(here.left) * np.linalg.norm(q))
    return {
        "l1": here.l1,
        "l1_error": max(abs(value - here.l1) for value in moved) + loss * EPSILON * here.size,
        "omega": omega,
        "crossing_rate": problem.crossing_rate(located.z, q, here.left),
        "convention": "Kuznetsov 2004, eq. 5.34: l1 = Re(c1)/omega with <q,q> = 1, <p,q> = 1",
    }

"""Neimark-Sacker points (NS): the segments' derivatives, closed by exp(i theta), are singular.

theta is a further unknown.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.orbit import normal_forms, variations
from contwalk.problems.orbit.augmented import Augmented
from contwalk.problems.orbit.null_vectors import bordered, critical_vectors
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.point_records import Form, criticality_of, known, negligible
from contwalk.problems.orbit.points.point import OrbitPoint
from contwalk.problems.orbit.scales import cycle_scales
from contwalk.problems.problem import Located, Sample, Test

# Where theta is this near to 2 pi k / q, q = 1..4, the point is a strong resonance.
RESONANT = 1e-6


class NeimarkSacker(OrbitPoint):
    """A pair of complex multipliers passes the unit circle."""

    label, test, changes = "NS", Test.STABILITY, (-2, 2)

    def tells(self, problem: OrbitData, sample: Sample, which: int) -> bool:
        """A complex pair; a real multiplier at one is told by the tests of folds and branch points."""
        return bool(sample.eigenvalues[which].imag != 0.0)

    def system(self, problem: OrbitData, sample: Sample, which: int) -> Augmented | None:
        """A pair of multipliers at exp(+-i theta)."""
        return _torus(problem, sample, which)

    def form(self, problem: OrbitData, located: Located[float], sample: Sample) -> Form:
        """The cubic coefficient, and the side on which tori are, if it is no strong resonance."""
        return _form(problem, located, sample)

    def critical(self, point: SpecialPoint, sample: Sample) -> complex:
        """exp(i theta)."""
        return complex(np.exp(1j * float(point.coefficients["theta"])))


def _form(problem: OrbitData, located: Located[float], sample: Sample) -> Form:
    theta = located.data
    resonance = _resonance(theta)
    if resonance is not None:
        note = f"strong resonance {resonance}: the normal form is another one"
        return None, None, {"theta": theta, "rotation_number": theta / (2.0 * np.pi)}, note
    coefficients = known(problem, located, sample, "d", lambda map_: normal_forms.torus(map_, theta))
    _, fold = problem.whole
    if fold > 1:
        coefficients["theta_full"] = float(abs(np.angle(np.exp(1j * fold * theta))))
    least = negligible(problem, located, np.exp(1j * theta))
    criticality, vanishes = criticality_of(coefficients["d"], coefficients.get("d_error"), least)
    return None, criticality, coefficients, vanishes


def _resonance(theta: float) -> str | None:
    """`1:q` where exp(i theta) is a q-th root of one, q = 1..4."""
    for q in (1, 2, 3, 4):
        distance = abs(np.angle(np.exp(1j * q * theta))) / q
        if distance < RESONANT:
            return f"1:{q}"
    return None


def _torus(problem: OrbitData, sample: Sample, which: int, modulus: float = 1.0) -> Augmented:
    """A pair of multipliers at modulus exp(+-i theta)."""
    size, (rows, columns) = problem.size, cycle_scales(problem)
    value = sample.eigenvalues[which]
    theta = abs(float(np.angle(value)))
    start = variations.cycle_matrix(problem, problem.jacobian(sample.z), complex(value.real, abs(value.imag)))
    b, c = critical_vectors(problem, start / rows[:, None] * columns)

    def scaled(there: OrbitData, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, complex, np.ndarray]:
        jacobian = there.linearize(y[: size + 1]).jacobian
        matrix = variations.cycle_matrix(there, jacobian, modulus * np.exp(1j * y[-1]))
        v, psi, g = bordered(there, matrix / rows[:, None] * columns, b, c)
        return v * columns, psi / rows, complex(g), jacobian

    def evaluate(there: OrbitData, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        z = y[: size + 1]
        v, psi, g, jacobian = scaled(there, y)
        real, imaginary = (variations.cycle_derivative(there, z, part) for part in (v.real, v.imag))
        gradient = -psi.conj() @ (real + 1j * imaginary)
        turning = 1j * modulus * np.exp(1j * y[-1]) * variations.cycle_return(there, psi, v)
        matrix = np.zeros((size + 2, size + 2))
        matrix[:size, : size + 1] = jacobian
        matrix[size, : size + 1], matrix[size + 1, : size + 1] = gradient.real, gradient.imag
        matrix[size, -1], matrix[size + 1, -1] = turning.real, turning.imag
        return np.concatenate([there.linearize(z).residual, [g.real, g.imag]]), matrix

    def described(found: Located, y: np.ndarray) -> Located:
        return replace(found, data=float(y[-1]))

    return Augmented(evaluate, np.append(sample.z, theta), np.append(sample.weights, 1.0), described)

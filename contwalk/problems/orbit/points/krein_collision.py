"""Krein collisions of orbits (NS): the Hamiltonian Hopf bifurcation of a symplectic map."""

from __future__ import annotations

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.numerics import krein
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.point_records import Form
from contwalk.problems.orbit.points.point import OrbitPoint
from contwalk.problems.problem import Located, Sample, Test

NOTE = (
    "Krein collision: two pairs of multipliers meet on the unit circle and leave it as a quadruple "
    "(Hamiltonian Hopf of the map); the normal form of a dissipative map, and its criticality, do not apply"
)


class KreinCollision(OrbitPoint):
    """Two pairs of multipliers meet and leave the unit circle."""

    label, test, changes, along = "NS", Test.STABILITY, (-2, 2), True

    def tells(self, problem: OrbitData, sample: Sample, which: int) -> bool:
        """A quadruple, of multipliers that come as mu and 1/mu."""
        values = sample.eigenvalues
        return (
            bool(values[which].imag != 0.0) and krein.symplectic(values) and self.value(problem, sample) < 0.0
        )

    def value(self, problem: OrbitData, sample: Sample) -> float:
        """How far two pairs are apart: positive on the circle, negative of a quadruple."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return krein.parted(sample.eigenvalues, sample.eigenvalues + 1.0 / sample.eigenvalues)

    def form(self, problem: OrbitData, located: Located, sample: Sample) -> Form:
        """The angle at which the pairs meet."""
        theta = abs(float(np.angle(sample.eigenvalues[located.which])))
        return None, None, {"theta": theta, "rotation_number": theta / (2.0 * np.pi), "pairs": 2}, NOTE

    def has(self, point: SpecialPoint) -> bool:
        """A stored point of two pairs."""
        return point.label == self.label and "pairs" in point.coefficients

    def critical(self, point: SpecialPoint, sample: Sample) -> complex:
        """exp(i theta)."""
        return complex(np.exp(1j * float(point.coefficients["theta"])))

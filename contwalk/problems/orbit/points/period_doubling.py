"""Points at which a multiplier is -1: the segments' derivatives, closed by -1, are singular.

The orbit is doubled (PD); of half a symmetric orbit, its whole loses the symmetry (BP). So it is of any part
that an even number make a whole of; of an odd number of parts the whole has the multiplier -1 as well.

In an explosion of cycles other steps have the multiplier elsewhere along the branch, by far more than an
augmented system is solved for: the point is then where F = 0 and that multiplier is -1, along the branch.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.orbit import normal_forms, variations
from contwalk.problems.orbit.augmented import Augmented, Near
from contwalk.problems.orbit.critical_along import along_branch
from contwalk.problems.orbit.null_vectors import bordered, critical_vectors
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.point_records import PAIR, Form, criticality_of, known, negligible
from contwalk.problems.orbit.points.point import OrbitPoint
from contwalk.problems.orbit.scales import cycle_scales
from contwalk.problems.problem import Located, Sample, Seed, Test


class _Flip(OrbitPoint):
    """A multiplier passes -1."""

    test, changes, daughters, multiplier = Test.STABILITY, (-1, 1), 1, -1.0

    def system(self, problem: OrbitData, sample: Sample, which: int) -> Augmented | None:
        """A multiplier at -1."""
        return flip_system(problem, sample)

    def seeds(self, problem: OrbitData, point: SpecialPoint) -> Sequence[Seed]:
        """The orbits that leave along critical vectors."""
        return problem.leaving(self, point)

    def critical(self, point: SpecialPoint, sample: Sample) -> complex:
        """-1."""
        return -1.0 + 0.0j


class FlatDoubling(_Flip):
    """The orbit is doubled where the parameter stands still."""

    label = "PD"

    def system(self, problem: OrbitData, sample: Sample, which: int) -> Augmented | None:
        """A real multiplier at -1, along the branch."""
        return along_branch(problem, sample, self.multiplier)

    def tells(self, problem: OrbitData, sample: Sample, which: int) -> bool:
        """A negative multiplier of a whole orbit, or of an odd part of one."""
        value = sample.eigenvalues[which]
        return bool(value.imag == 0.0 and value.real <= 0.0 and problem.rounds % 2)

    def form(self, problem: OrbitData, located: Located, sample: Sample) -> Form:
        """The cubic coefficient, and the side to which the doubled orbit leaves."""
        coefficients = known(problem, located, sample, "c", normal_forms.flip)
        criticality, vanishes = criticality_of(
            -coefficients["c"], coefficients.get("c_error"), negligible(problem, located, -1.0)
        )
        return None, criticality, coefficients, vanishes

    def branches(self, problem: OrbitData, z: np.ndarray, point: SpecialPoint) -> Sequence[Seed]:
        """The doubled orbits. z has the shape (N + 1,)."""
        return problem.doubled_from(z, point.coefficients.get("multiplicity", 1))


class PeriodDoubling(FlatDoubling):
    """The orbit is doubled."""

    flat = (FlatDoubling(),)

    def system(self, problem: OrbitData, sample: Sample, which: int) -> Augmented | None:
        """A multiplier at -1."""
        return flip_system(problem, sample)


class SymmetryBreaking(_Flip):
    """Half a symmetric orbit is no longer what its other half is the image of."""

    # Its row tells no error, as those of all branch points.
    label, singular = "BP", True

    def tells(self, problem: OrbitData, sample: Sample, which: int) -> bool:
        """A negative multiplier of half an orbit, or of another even part."""
        value = sample.eigenvalues[which]
        return bool(value.imag == 0.0 and value.real <= 0.0 and problem.rounds % 2 == 0)

    def form(self, problem: OrbitData, located: Located, sample: Sample) -> Form:
        """As of a doubling; of the whole orbit it is a pitchfork."""
        coefficients = known(problem, located, sample, "c", normal_forms.flip)
        criticality, vanishes = criticality_of(
            -coefficients["c"], coefficients.get("c_error"), negligible(problem, located, -1.0)
        )
        note = vanishes or f"the orbits that leave have lost '{problem.whole[0]}'"
        return "symmetry-breaking", criticality, coefficients, note

    def form_of_pair(self, problem: OrbitData, located: Located, sample: Sample) -> Form:
        """As `form`, without coefficients."""
        return "symmetry-breaking", None, {}, PAIR

    def branches(self, problem: OrbitData, z: np.ndarray, point: SpecialPoint) -> Sequence[Seed]:
        """The whole orbits without the symmetry. z has the shape (N + 1,)."""
        return problem.unfolded_from(z, point.coefficients.get("multiplicity", 1))

    def has(self, point: SpecialPoint) -> bool:
        """A branch point of that kind."""
        return point.label == self.label and point.kind == "symmetry-breaking"


def flip_system(problem: OrbitData, near: Near) -> Augmented:
    """A multiplier at -1, near a place."""
    size, (rows, columns) = problem.size, cycle_scales(problem, near.weights)
    start = variations.cycle_matrix(problem, problem.jacobian(near.z), -1.0)
    b, c = critical_vectors(problem, start / rows[:, None] * columns)

    def scaled(there: OrbitData, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        matrix = variations.cycle_matrix(there, there.linearize(z).jacobian, -1.0)
        v, psi, g = bordered(there, matrix / rows[:, None] * columns, b, c)
        return v * columns, psi / rows, float(g.real)

    def evaluate(there: OrbitData, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        v, psi, g = scaled(there, z)
        return there.linearize(z).with_row(g, -psi @ variations.cycle_derivative(there, z, v))

    def in_plane(
        there: OrbitData, across: OrbitData, z: np.ndarray, second: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        v, psi, g = scaled(there, z)
        found = there.linearize(z).with_row(g, -psi @ variations.cycle_derivative(there, z, v))
        place = np.append(z[:size], second)
        return *found, np.concatenate(variations.by_parameter(across, place, psi[None, None], [v]))

    return Augmented(evaluate, near.z, near.weights, in_plane=in_plane)

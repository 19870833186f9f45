"""Points at which the condition of another curve holds as well: LPPD, LPNS, PDNS, NSNS, GRLP, GRPD, GRNS."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.hybrid.adjacent.at_limit import built_at
from contwalk.problems.hybrid.adjacent.orbit import NoAdjacentOrbit
from contwalk.problems.hybrid.soft_equations import SoftEquations
from contwalk.problems.locus.orbit_curves import CURVES
from contwalk.problems.locus.orbit_places import Held
from contwalk.problems.locus.orbit_points import tangency
from contwalk.problems.locus.orbit_points.point import (
    Form,
    OrbitLocusPoint,
    alone,
    known_to,
    near_of,
    together,
    where_zero,
)
from contwalk.problems.locus.orbit_points.switching import born, second_cosine
from contwalk.problems.orbit import scales, variations
from contwalk.problems.orbit.augmented import Augmented
from contwalk.problems.problem import Located, Sample, Seed, Test

# Grazing orbits whose neighbours are kept: folds and doublings ask for the same ones.
MOST_KEPT = 8
# The kind of points whose multiplier one is that of a branch point that persists.
BRANCH_POINT = "branch point"
# A test function is told from errors where it is so many times their estimate.
DOUBT = 10.0


class TwoAtOnce(OrbitLocusPoint):
    """A multiplier beside those of the curve passes the unit circle.

    Parameters
    ----------
    label : str
    other : str
        The label of the curve that crosses: `LP`, `PD` or `NS`.
    """

    test = Test.STABILITY

    def __init__(self, label: str, other: str) -> None:
        self.label, self.other = label, other  # type: ignore[misc]
        self.changes = (-2, 2) if other == "NS" else (-1, 1)  # type: ignore[misc]

    def tells(self, problem: Any, sample: Sample, which: int) -> bool:
        """A multiplier as the other curve holds it, where something bifurcates on this one."""
        if alone(sample, which):  # it is one with the curve's own
            return False
        value = complex(sample.eigenvalues[which])
        told = "NS" if value.imag != 0.0 else "LP" if value.real > 0.0 else "PD"
        return told == self.other and problem.genuine(sample.z)

    def system(self, problem: Any, sample: Sample, which: int) -> Augmented | None:
        """The conditions of both curves."""
        return self.both(problem, sample, float(np.angle(sample.eigenvalues[which])))

    def both(self, problem: Any, sample: Sample, angle: float = 0.0) -> Augmented:
        """The conditions of both curves; `angle` is that of the critical multipliers, where it is unknown."""
        there, own = problem.plane.first(sample.z)
        near = near_of(problem, sample, own)
        curve, width = CURVES[self.other], len(sample.z)
        further = np.full(curve.further, np.cos(angle))
        places = np.arange(width, width + curve.further)
        held = [problem.condition, Held(curve.condition(there, near, further), places)]
        return together(problem, sample, held, further)

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """The other curve."""
        if self.other != "NS":
            return born(problem, point, self.other)
        held = float(problem.further(np.array(point.unknowns))[0]) if problem.curve.of == "NS" else None
        cosine = second_cosine(point, held)
        return () if cosine is None else born(problem, point, "NS", cosine)

    def critical(self, point: SpecialPoint, sample: Sample) -> complex:
        """The multiplier of the other curve."""
        if self.other != "NS":
            return complex(1.0 if self.other == "LP" else -1.0)
        found = second_cosine(point, float(sample.resting[0].real) if len(sample.resting) == 2 else None)
        cosine = 0.0 if found is None else found
        return complex(cosine, np.sqrt(max(1.0 - cosine**2, 0.0)))

    def has(self, point: SpecialPoint) -> bool:
        """A point of that label where both curves cross, no branch point."""
        return point.label == self.label and point.kind not in ("resonant", BRANCH_POINT)

    def form(self, problem: Any, located: Located, sample: Sample) -> Form:
        """The coefficients; of grazings the kind: both curves cross."""
        if self.label.startswith("GR"):
            return "interior", {}, None
        return super().form(problem, located, sample)


class ResonantGrazing(TwoAtOnce):
    """On a curve of grazing orbits: curves of folds or doublings of the orbits with that event begin there.

    Arriving without rate the event makes a multiplier infinite all along, and where that changes its sign
    L(1) and L(-1) are singular at once. What grazes between two events is looked at as the orbit in which the
    touch happens.
    """

    test, of_place, dear = Test.VALUE, True, True

    def __init__(self, label: str, other: str) -> None:
        super().__init__(label, other)
        self.changes = (0,)  # type: ignore[misc]

    def value(self, problem: Any, sample: Sample) -> float:
        """How far L(1), or L(-1), is from singular, with the sign of its determinant; NaN of other grazings.

        Zero where it is no more than errors of the steps: where the event changes nothing, L is singular all
        along whatever the multiplier is, and signs of errors tell nothing.
        """
        found = self._signed(problem, sample.z)
        return 0.0 if abs(found) <= DOUBT * known_to(problem) else found

    def _signed(self, problem: Any, z: np.ndarray) -> float:
        found = problem.known.at("arriving", z, MOST_KEPT, lambda: as_arriving(problem, z))
        if found is None:
            return float("nan")
        there, own = found
        rows, columns = scales.cycle_scales(there)
        multiplier = 1.0 if self.other == "LP" else -1.0
        matrix = variations.cycle_matrix(there, there.linearize(own).jacobian, multiplier)
        scaled = matrix / rows[:, None] * columns
        return float(np.linalg.slogdet(scaled)[0] * np.linalg.svd(scaled, compute_uv=False)[-1])

    def system(self, problem: Any, sample: Sample, which: int) -> Augmented | None:
        """The conditions of both curves; of orbits that do not have the event yet, that function."""
        if problem.curve.limit.test == "rate":
            return self.both(problem, sample)
        return where_zero(sample, problem, self._signed)

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """None: both curves are tangent there, and the other one is of orbits with another signature."""
        return ()

    def has(self, point: SpecialPoint) -> bool:
        """A point of that label where both curves are tangent."""
        return point.label == self.label and point.kind == "resonant"

    def form(self, problem: Any, located: Located, sample: Sample) -> Form:
        """The kind: both curves are tangent there; and how they part."""
        found, second = as_arriving(problem, located.z), float(located.z[-2])
        told = {} if found is None else tangency.coefficients(problem, *found, second, self.other)
        return "resonant", told, None


def as_arriving(problem: Any, z: np.ndarray) -> tuple[Any, np.ndarray] | None:
    """A grazing orbit of a curve as one in which the event happens without rate, and its unknowns.

    Both vectors are of the shape (N + k + 2,) and (M + 1,). None where nothing happens, or the machine goes
    another way.
    """
    limit, (there, own) = problem.curve.limit, problem.plane.first(z)
    if isinstance(there, SoftEquations):  # its legs are divided anew: not told
        return None
    if limit.test == "rate":
        return there, own
    if limit.test != "dip" or not limit.acts:
        return None
    since, lasting = float(problem.further(z)[0]), float(own[there.layout.durations][limit.leg])
    if not 0.0 < since < lasting:  # as of what Newton's method tries
        return None
    try:
        neighbour = built_at(there, own, limit, since / lasting)
    except NoAdjacentOrbit:
        return None
    return neighbour.problem, neighbour.z

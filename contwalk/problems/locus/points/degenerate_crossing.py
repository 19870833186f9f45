"""Branch points at which the coefficient that tells their kind vanishes, and that a curve of folds touches.

With y' = mu y + a y^2 + c y^3 + e y^5 branches cross where mu = 0. Transcritical points have folds beside
them where mu = a^2 / 4c, and these touch them where a = 0. Pitchforks, whose a is zero all along, have folds
where mu = c^2 / 4e, and change there, where c = 0, between super- and subcritical (Golubitsky & Schaeffer
1985, Singularities and Groups in Bifurcation Theory I, section VI.2).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from contwalk.numerics.bracketing import UNSURE
from contwalk.numerics.linear import kernel_direction
from contwalk.problems.equilibrium.points.point import Form
from contwalk.problems.locus.bordered import Borders, Critical, zero_borders, zero_condition
from contwalk.problems.locus.conditions import Augmented
from contwalk.problems.locus.normal_forms import cusp_coefficient, pitchfork_coefficients
from contwalk.problems.locus.plane import FloatPlace, Place, Plane
from contwalk.problems.locus.points.crossing import Crossing
from contwalk.problems.locus.points.persisting import KIND, NOTE, branch_point, persists
from contwalk.problems.locus.points.point import ConditionsMet, LocusPoint, located_by
from contwalk.problems.problem import Located, Sample, Test

# A coefficient below this part of what it would naturally be is rounding of zero.
ZERO = 1e-9
# How far along a curve of branch points it must be zero too, in the metric: at a pitchfork it is everywhere.
BESIDE = 1e-3
PITCHFORK = "pitchforks change between super- and subcritical here, and a curve of folds touches theirs"

# Under which key a problem keeps which coefficient is watched.
KEPT = "coefficient of branch points"

# Of a place, its critical vectors, and the borders that tell these.
Coefficient = Callable[[Place, Critical, Borders], Any]


def quadratic(place: Place, found: Critical, borders: Any) -> Any:
    """p.B(q, q)."""
    return found.left[0] @ place.second(found.right[0], found.right[0])


def cubic(place: Place, found: Critical, borders: Borders) -> Any:
    """p.(C(q, q, q) + 3 B(q, h)) with F_u h = -B(q, q), which is solvable where p.B(q, q) = 0."""
    q, p = found.right[0], found.left[0]
    h = _solved(place, borders, -place.second(q, q))
    return p @ (place.third(q, q, q) + 3 * place.second(q, h))


def _solved(place: Place, borders: Borders, right: np.ndarray) -> np.ndarray:
    """F_u h = right as far as it is solvable, h at a right angle to the border; both of shape (N,)."""
    edge = np.zeros((1, 1))
    bordered = np.block([[place.matrix, borders.column[:, None]], [borders.row[None, :], edge]])
    return np.asarray(place.solver(bordered)(np.append(right, 0.0))[: len(right)])


def are_pitchforks(plane: Plane, z: np.ndarray, along: np.ndarray, units: np.ndarray) -> bool:
    """Whether p.B(q, q) is zero at a branch point z and beside it, `along` their curve; all (N + 2,)."""
    return all(_vanishes(plane, z + aside * BESIDE * along, units) for aside in (0.0, 1.0, -1.0))


def _vanishes(plane: Plane, z: np.ndarray, units: np.ndarray) -> bool:
    place = FloatPlace(plane, z)
    borders = zero_borders(place.matrix)
    return _with_its_error(place, borders, quadratic, units)[1]


def touched(problem: Any, sample: Sample) -> Located | None:
    """The branch point near a sample of a curve of folds at which these touch a curve of branch points."""
    branch_points = Augmented(problem.plane, (branch_point(problem, sample),))
    for coefficient in (quadratic, cubic):
        with suppress(np.linalg.LinAlgError):
            found = _located(problem, sample, branch_points, [0.0], coefficient)
            if found is not None and is_pitchfork(problem, found, sample) == (coefficient is cubic):
                return found
    return None


def is_pitchfork(problem: Any, located: Located[ConditionsMet], sample: Sample) -> bool:
    """Whether a point located on a curve of branch points, near a sample, is one of pitchforks."""
    augmented, z = located.data.augmented, problem.in_plane(located.z)
    u = augmented.joined(z, located.data.own)
    weights = np.maximum(np.abs(u), 1.0)
    along = augmented.split(kernel_direction(augmented.values(u)[1], weights))[0]
    return are_pitchforks(problem.plane, z, along, problem.in_plane(sample.weights))


def _located(
    problem: Any, sample: Sample, augmented: Augmented, own: Sequence[float], coefficient: Coefficient
) -> Located | None:
    plane = problem.plane
    borders = zero_borders(plane.jacobian(problem.in_plane(sample.z))[:, : plane.size])

    def function(place: Place, told: Any, own: Any) -> Any:
        return coefficient(place, zero_condition(place, borders), borders)

    return located_by(problem, augmented, sample, own, function)


def form_of(problem: Any, located: Located, sample: Sample) -> Form:
    """What is told of such a point, located near a sample."""
    z = problem.in_plane(located.z)
    if is_pitchfork(problem, located, sample):
        return KIND, None, pitchfork_coefficients(problem.plane, z), PITCHFORK
    return KIND, None, cusp_coefficient(problem.plane, z), NOTE


class DegenerateBranchPoint(LocusPoint):
    """On a curve of branch points."""

    label, test, of_place = "CP", Test.VALUE, True

    def value(self, problem: Any, sample: Sample) -> float:
        """The coefficient that tells the kind, by borders that are the same on the whole step.

        Where it is zero all along, as on a curve from which vertical branches leave, its sign is rounding.
        """
        coefficient, borders = _watched(problem, sample)
        place = FloatPlace(problem.plane, problem.in_plane(sample.z))
        found, hidden = _with_its_error(place, borders, coefficient, problem.in_plane(sample.weights))
        return math.copysign(UNSURE, found) if hidden else found

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The point near a sample."""
        coefficient, _ = _watched(problem, sample)
        return _located(problem, sample, problem.augmented, [problem.own(sample.z)], coefficient)

    def form(self, problem: Any, located: Located, sample: Sample) -> Form:
        """The next coefficient."""
        return form_of(problem, located, sample)


def _with_its_error(
    place: FloatPlace, borders: Borders, coefficient: Coefficient, weights: np.ndarray
) -> tuple[float, bool]:
    """A coefficient, and whether it is rounding; `weights` have the shape (N + 2,)."""
    critical = zero_condition(place, borders)
    found = float(coefficient(place, critical, borders))
    natural = _natural(place, critical, borders, coefficient, weights[: place.plane.size])
    return found, abs(found) <= ZERO * natural


def _natural(
    place: FloatPlace, found: Critical, borders: Borders, coefficient: Coefficient, units: np.ndarray
) -> float:
    """How large a coefficient would be if q, and what states are, had as much of all states.

    `units` are those of the states, shape (N,). Where all bends away from zero, as in odd equations, it is
    what a unit along q makes of it.
    """
    q, p = found.right[0], np.abs(found.left[0])
    slopes, length = np.abs(place.slopes(q))[:, : len(q)], float(np.linalg.norm(q / units))
    bent = slopes @ (units * length)
    if coefficient is quadratic:
        return float(p @ (bent + np.abs(place.third(q, q, q)) / length))
    h = _solved(place, borders, bent)
    further = slopes @ (units * float(np.linalg.norm(h / units)))
    return float(p @ (np.abs(place.third(q, q, q)) + 3.0 * further))


def _watched(problem: Any, sample: Sample) -> tuple[Coefficient, Borders]:
    """The coefficient whose zeros are looked for on a step of a curve of branch points, and its borders."""
    if KEPT not in problem.kept:
        plane, own = problem.plane, (sample.z, sample.tangent, sample.weights)
        z, along, units = (problem.in_plane(v) for v in own)
        coefficient = cubic if are_pitchforks(plane, z, along, units) else quadratic
        problem.kept[KEPT] = coefficient, zero_borders(plane.jacobian(problem.near)[:, : plane.size])
    watched: tuple[Coefficient, Borders] = problem.kept[KEPT]
    return watched


class CrossingOfFolds(Crossing):
    """On a curve of folds: another one crosses, or they touch pitchforks; equations are singular at both."""

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The crossing, or the degenerate pitchfork, near a sample."""
        return super().locate(problem, sample, which) or touched(problem, sample)

    def tells_of(self, located: Located) -> bool:
        """Not of the pitchfork: that the cusp's function passes zero there says it already."""
        return not persists(located)

"""Where two curves of orbits that solve the same equations cross.

DF of the curve, (W - 1, W), loses rank there: with one column and two rows as borders the inverse has two
corners that both vanish (Govaerts 2000, Numerical Methods for Bifurcations of Dynamical Equilibria, section
5.2), and with F + mu b for F, b the column, such a point is a regular solution. DF contains second
derivatives of the flow already; what the corners change by is the difference of DF to both sides along their
vectors, so that Newton's method is one with nearly exact slopes: where it ends does not depend on them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import NotFinite, PluginError
from contwalk.problems.locus.orbit_points.point import OrbitLocusPoint
from contwalk.problems.locus.orbit_points.switching import crossing_born, where_two_cross
from contwalk.problems.orbit.augmented import Augmented, Described, as_found
from contwalk.problems.problem import Located, Sample, Seed, Test

# How far along a vector of length one, in the metric, DF is looked at for its slope.
BESIDE = 1e-4
# How far along the curve on both sides, in the metric, what it holds is looked at for its units.
ASIDE = 0.1
# How far, in the metric, and how often a located point is displaced to see noise of its equations, which is
# farther than differences of rounded numbers stand still; the error is so many times what is seen.
NUDGE, NUDGES, TIMES = 1e-7, 4, 4.0


@dataclass(frozen=True)
class Borders:
    """A column and two rows that make DF, in units of rows and of unknowns, regular where curves cross.

    `rows` has the shape (W - 1,), `columns` (W,), `left` (W - 1,), `right` (2, W).
    """

    rows: np.ndarray
    columns: np.ndarray
    left: np.ndarray
    right: np.ndarray

    def told(self, jacobian: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Both corners, shape (2,), their vectors in units of the unknowns, (2, W), and p, (W - 1,)."""
        width = jacobian.shape[1]
        matrix = np.zeros((width + 1, width + 1))
        matrix[:-2, :-1] = jacobian / self.rows[:, None] * self.columns
        matrix[:-2, -1], matrix[-2:, :-1] = self.left, self.right
        both = np.linalg.solve(matrix, np.eye(width + 1)[:, -2:])
        adjoint = np.linalg.solve(matrix.T, np.eye(width + 1)[:, -1])
        return both[-1], both[:-1].T, adjoint[:-2]


class Crossing(OrbitLocusPoint):
    """Two curves of one kind cross."""

    label, test, changes, singular = "BP", Test.ORIENTATION, (-1, 0, 1), True

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """Where the curve's equations lose rank."""
        return crossing_near(problem, sample)

    def tangent(self, problem: Any, located: Located, near: Sample) -> np.ndarray | None:
        """That of the curve that `near` is on. Shape (N + k + 2,)."""
        return tangent_through(located, near)

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """The curve that crosses."""
        return crossing_born(problem, point)


def borders(problem: Any, sample: Sample) -> Borders:
    """Borders from the singular vectors of DF near a sample."""
    scaled, rows = problem.linearize(sample.z).jacobian * sample.weights, units(problem, sample)
    u, _, vh = np.linalg.svd(scaled / rows[:, None])
    return Borders(rows, sample.weights, u[:, -1], vh[-2:])


def units(problem: Any, sample: Sample) -> np.ndarray:
    """Units of the curve's equations, shape (W - 1,).

    Their own rows would not do: one that vanishes where curves cross is the critical one. What the curve
    holds has no units of its own: they are what it changes by near the sample, not only at it.
    """
    orbit, n = problem.plane.first(sample.z)[0], problem.plane.size
    places = (sample.z + side * ASIDE * sample.tangent for side in (-1.0, 0.0, 1.0))
    slopes = [np.abs(problem.linearize(z).jacobian[n:] * sample.weights).max(axis=1) for z in places]
    largest = np.nanmax(slopes, axis=0)
    return np.append(orbit.equation_scales, np.where(largest > 0.0, largest, 1.0))


def crossing_near(problem: Any, sample: Sample, further: Described = as_found) -> Located | None:
    """The point near a sample at which two curves of the problem cross.

    `further` tells of it what is known beside the tangents of both, by all unknowns, shape (W + 1,).
    """
    try:
        system = crossing_system(problem, sample, further)
        found: Located | None = problem.located(system, sample)
    except (NotFinite, PluginError, np.linalg.LinAlgError):
        return None
    if found is None or found.refine is None:
        return found
    refine = found.refine

    def refined() -> Located | None:
        finer = refine()
        return None if finer is None else _doubted(finer, system)

    return replace(found, refine=refined)


def _doubted(found: Located, system: Augmented) -> Located:
    """A point whose errors tell what is left of its equations, and what noise of the corners does to it.

    Their slopes are differences, and along a marked value DF is one of differences itself.
    """
    there, y = found.problem, np.append(found.z, 0.0)
    residual, jacobian = system.evaluate(there, y)
    noise = np.abs(residual)
    for k in range(1, NUDGES + 1):
        nudge = NUDGE * system.scale * np.cos(k * np.arange(1.0, len(y) + 1.0))
        left = system.evaluate(there, y + nudge)[0] - residual - jacobian @ nudge
        noise[-2:] = np.maximum(noise[-2:], np.abs(left[-2:]))
    doubt = TIMES * np.abs(np.linalg.inv(jacobian * system.scale) * system.scale[:, None]) @ noise
    errors = {name: found.errors[name] + float(doubt[-2 - k]) for k, name in enumerate(there.line.names)}
    return replace(found, error=errors[there.line.free], errors=errors)


def crossing_system(problem: Any, sample: Sample, further: Described = as_found) -> Augmented:
    """The equations of a point near a sample at which two curves of the problem cross; mu is zero there."""
    held, width = borders(problem, sample), len(sample.z)
    column = held.rows * held.left

    def evaluate(there: Any, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        z = y[:width]
        own = there.linearize(z)
        corners, vectors, p = held.told(own.jacobian)
        jacobian = np.zeros((width + 1, width + 1))
        jacobian[:-2, :-1], jacobian[:-2, -1] = own.jacobian, column
        jacobian[-2:, :-1] = [-slope(there, z, held, p, q) for q in vectors]
        return np.concatenate([own.residual + y[width] * column, corners]), jacobian

    def described(found: Located, y: np.ndarray) -> Located | None:
        tangents = where_two_cross(found.problem, found.z, held.columns, held.rows)
        return further(replace(found, crossing=tangents), y)

    start, scale = np.append(sample.z, 0.0), np.append(sample.weights, 1.0)
    return Augmented(evaluate, start, scale, described)


def slope(there: Any, z: np.ndarray, held: Borders, p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """What p DF changes by along q, by each unknown, shape (W,); F's second derivative is symmetric.

    z has the shape (W,), p (W - 1,) and q (W,), in the units of the borders.
    """
    step = BESIDE / float(np.linalg.norm(q)) * q * held.columns
    ahead, behind = (there.linearize(z + side * step).jacobian for side in (1.0, -1.0))
    change: np.ndarray = (p / held.rows) @ (ahead - behind)
    return change * float(np.linalg.norm(q)) / (2.0 * BESIDE)


def tangent_through(located: Located, near: Sample) -> np.ndarray | None:
    """Of the tangents of the curves that cross at a point that of the one that `near` is on, facing its way.

    Shape (W,). None of a point at which no curves cross.
    """
    found = located.crossing
    if not found:
        return None
    products = [float((t / near.weights) @ (near.tangent / near.weights)) for t in found]
    best = int(np.argmax(np.abs(products)))
    return np.asarray(found[best] * np.sign(products[best]))

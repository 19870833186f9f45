"""Points at which branches cross for good, as on an invariant face: there F_u q = 0 is no fold.

Beside a branch point that persists [F_u F_first F_second] has deficient rank: with the condition of a fold
the equations of a cusp or of a zero-Hopf point are singular, and Newton's method creeps or gets nowhere. With
the branch point's own condition, and F + mu b for F, they are regular; where there is none, mu is not zero.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.numerics.linear import deficiency
from contwalk.problems.locus.branch_points import PERSISTS, BranchPoint
from contwalk.problems.locus.branch_points import branch_point as near
from contwalk.problems.locus.curves import BRANCH_POINTS, FOLDS
from contwalk.problems.locus.points.point import ConditionsMet, born
from contwalk.problems.problem import Located, Sample, Seed

# How near to the creeping solution the regular one is, in typical magnitudes.
THERE = 1e-4
# What such a zero-Hopf point or cusp is told as.
KIND = "branch point"
NOTE = "the zero eigenvalue is that of a branch point that persists, not of a fold"


def branch_point(problem: Any, sample: Sample) -> BranchPoint:
    """The condition of a branch point that persists, with borders for a sample of a curve."""
    return near(problem.plane, problem.in_plane(sample.z), problem.in_plane(sample.weights))


def better(sample: Sample, found: Located | None, crossing: Located | None) -> Located | None:
    """A point near a sample by a fold's condition, or by a branch point's if there is one.

    Newton's method that creeps may end some way off a crossing, farther from the sample than that is.
    """
    if found is None or crossing is None:
        return found or crossing

    def apart(a: np.ndarray, b: np.ndarray) -> float:
        return float(np.max(np.abs(a - b) / sample.weights))

    creeping = apart(crossing.z, sample.z) < apart(found.z, sample.z)
    return crossing if creeping or apart(found.z, crossing.z) < THERE else found


def persists(located: Located) -> bool:
    """Whether a point was located by a branch point's condition."""
    met = located.data.augmented.conditions if isinstance(located.data, ConditionsMet) else ()
    return any(isinstance(condition, BranchPoint) for condition in met)


def zeros_born(problem: Any, point: SpecialPoint) -> list[Seed]:
    """The curve of folds through a point with a zero eigenvalue; of branch points, where these persist.

    There the equations of folds are singular.
    """
    other, z = problem.other(FOLDS, np.array(point.unknowns), 0.0)
    there = other.linearize(z)
    known = np.where(np.isfinite(there.magnitudes) & (there.magnitudes > 0.0), there.magnitudes, 1.0)
    singular = np.all(np.isfinite(there.jacobian)) and deficiency(there.jacobian, known).value < PERSISTS
    return born(problem, point, BRANCH_POINTS if singular else FOLDS)

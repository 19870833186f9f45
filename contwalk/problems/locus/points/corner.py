"""Where another eigenvalue takes over the largest real part that is marked: the corner of its contour.

Along a contour of the largest real part that part is an eigenvalue's, or a pair's. The contour goes on with
another one where that has the same real part, and where a pair becomes two real eigenvalues or two such
become a pair.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.locus.curves import Curve, PairAt, RealEigenvalueAt
from contwalk.problems.locus.lead import apart, lead_of_others
from contwalk.problems.locus.points.crossing import both_born
from contwalk.problems.locus.points.point import born, sizes
from contwalk.problems.problem import Seed

# Imaginary parts below this part of the largest eigenvalue may be rounding of two equal real ones, whose
# difference is known to the root of it.
EQUAL = 1e-5


def beyond_corner(problem: Any, point: SpecialPoint) -> list[Seed]:
    """The contour beyond a corner at which it ends, on the side where its own eigenvalue has the lead."""
    for curve, own in _candidates(problem, point):
        found = both_born if type(curve) is type(problem.curve) else born
        leading = [ahead for seed in found(problem, point, curve, own) if (ahead := _leading(seed))]
        if leading:
            return leading
    return []


def _candidates(problem: Any, point: SpecialPoint) -> list[tuple[Curve, float]]:
    """What may have the largest real part beyond a corner, with its own unknown there."""
    level, z, eigenvalues = problem.curve.real_part, np.array(point.unknowns), np.array(point.spectrum)
    if level is None:
        return []
    real, equal = RealEigenvalueAt(level), EQUAL * float(np.abs(eigenvalues).max())
    if problem.curve.pair and problem.kappa(z) <= equal**2:
        return [(real, 0.0)]
    if lead_of_others(problem, z, eigenvalues)[0] < -equal:
        return []  # it has ended for another reason
    others, _ = apart(problem, z, eigenvalues)
    lead = others[np.argmax(others.real)]
    if abs(lead.imag) > equal:
        return [(PairAt(level), float(lead.imag) ** 2)]
    return [(real, 0.0)] if problem.curve.pair else [(PairAt(level), 0.0), (real, 0.0)]


def _leading(seed: Seed) -> Seed | None:
    """A seed on the side of its corner on which nothing else is ahead; None where there is no such side."""
    curve: Any = seed.problem
    assert seed.other_side is not None
    for z, along in ((seed.z, seed.z - seed.other_side), (seed.other_side, seed.other_side - seed.z)):
        sample = curve.examine(z, along, sizes(curve, z), curve.linearize(z), None)
        ahead, *past = lead_of_others(curve, z, sample.eigenvalues)
        equal = EQUAL * float(np.abs(sample.eigenvalues).max())
        if ahead < 0.0 and all(value < -(equal**2) for value in past):
            return replace(seed, z=z, other_side=None)
    return None

"""The curve of folds of doubled orbits that is born at a generalized period doubling.

There mu = c r^2 + e r^4 holds of the doubled orbit of the amplitude r, with c = 0 at the point itself: beside
it, on the side of the curve of doublings where c has the other sign than e, the doubled orbits fold at
r^2 = -c / (2 e) (Kuznetsov 2004, section 9.3). Both coefficients are read from the first parameter of two
doubled orbits.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import ContwalkError
from contwalk.numerics.linear import kernel_direction
from contwalk.problems.locus.orbit_curves import CURVES
from contwalk.problems.locus.orbit_places import OrbitPlane
from contwalk.problems.orbit.branching import filled_magnitudes
from contwalk.problems.orbit.solving import newton_on
from contwalk.problems.problem import Seed

# How far along the curve of doublings the first doubled orbit is looked for, in the metric.
ASIDE = (1e-2, 3e-2, 3e-3, 1e-1)
# The amplitude of the first of two orbits, over the root of that.
AMPLITUDE = 0.3
# Folds are expected no farther from that amplitude than by these factors,
LEAST, MOST = 0.1, 6.0
# and what is found is the fold that is expected where its amplitude is that by these.
SMALLER, LARGER = 0.7, 1.4


def folds_of_doubled_orbits(problem: Any, point: SpecialPoint) -> Sequence[Seed]:
    """The curve of folds that is born at a generalized period doubling; none where none is found."""
    z, weights = np.array(point.unknowns), problem.weights
    tangent = kernel_direction(problem.jacobian(z), weights)
    for aside in ASIDE:
        for sign in (1.0, -1.0):
            try:
                beside = newton_on(problem, z + sign * aside * tangent, weights, tangent / weights**2)
                found = _fold(problem, beside, AMPLITUDE * aside**0.5, z[-2:])
            except (ContwalkError, np.linalg.LinAlgError):
                continue
            if found is not None:
                return [found]
    return []


def _fold(problem: Any, z: np.ndarray, r: float, origin: np.ndarray) -> Seed | None:
    """The fold of doubled orbits beside a doubling at z, shape (N + 2,).

    `origin` are the second and the first parameter at the generalized doubling, shape (2,).
    """
    orbit, own = problem.plane.first(z)
    (seed,) = orbit.finely(own).doubled_from(own)
    doubled: Any = seed.problem
    sizes = filled_magnitudes(doubled, seed.z)
    sizes[-1] = problem.weights[-1]
    swing = seed.tangent / np.linalg.norm(seed.tangent / sizes)
    normal = swing / sizes**2
    reached = (newton_on(doubled, seed.z + s * swing, sizes, normal) for s in (r, 2.0 * r))
    moved = [float(found[-1] - seed.z[-1]) for found in reached]
    c, e = (16.0 * moved[0] - moved[1]) / (12.0 * r**2), (moved[1] - 4.0 * moved[0]) / (12.0 * r**4)
    if not c * e < 0.0 or not LEAST * r < (expected := float(np.sqrt(-c / (2.0 * e)))) < MOST * r:
        return None
    guess = newton_on(doubled, seed.z + expected * swing, sizes, normal)
    near = np.concatenate([guess[:-1], [z[-2]], guess[-1:]])
    there, place = OrbitPlane(doubled, problem.plane.free).first(near)
    made = there.finely(place)
    weights = np.concatenate([filled_magnitudes(made, place)[:-1], problem.weights[-2:]])
    curve = problem.on(made, near, weights, CURVES["LP"])
    held = np.concatenate([swing[:-1], [0.0, 0.0]]) / weights**2
    solved = newton_on(curve, near, weights, held)
    amplitude = float(held[:-2] @ (solved[:-2] - seed.z[:-1])) / float(held[:-2] @ swing[:-1])
    if not SMALLER * expected < amplitude < LARGER * expected:
        return None
    # Towards the point itself doubled orbits shrink to the single one: only the other way is walked.
    away = kernel_direction(curve.jacobian(solved), weights)
    away = away * (np.sign(float((away / weights**2)[-2:] @ (solved[-2:] - origin))) or 1.0)
    return Seed("LP", solved, away, None, curve, one_sided=True)

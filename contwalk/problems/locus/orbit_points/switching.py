"""The other curve that passes a special point of a curve of orbits, begun a little beside it."""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import NotFinite, PluginError, StartError
from contwalk.numerics.linear import kernel_direction
from contwalk.problems.hybrid import locating_limits
from contwalk.problems.locus.orbit_conditions import At
from contwalk.problems.locus.orbit_curve import OrbitCurve
from contwalk.problems.locus.orbit_curves import CURVES, Limits
from contwalk.problems.locus.orbit_places import OrbitPlane
from contwalk.problems.locus.valued_curves import BranchPoints, SymmetryBreakings
from contwalk.problems.orbit.branching import filled_magnitudes
from contwalk.problems.problem import Seed
from contwalk.problems.solving import newton_on

# How far beside the point the other curve begins, in the metric: walking back finds the point. The farthest
# place counts from which Newton's method goes to the curve by less than a part of that way.
BESIDE, OFF = (1e-2, 1e-3, 1e-4), 0.5
# A singular value of a curve's equations is nothing below this part of the largest one.
PERSISTS = 1e-6
# How far along a direction slopes are looked at for second derivatives, in the metric.
DIFFERENCE = 1e-4


def born(problem: Any, point: SpecialPoint, label: str, cosine: float | None = None) -> list[Seed]:
    """The curve of folds, doublings or tori through a point; of tori with (mu + 1/mu) / 2 there.

    Half a symmetric orbit is not doubled: there the whole loses the symmetry. So it is of any even part.
    """
    further = np.zeros(0) if cosine is None else np.array([cosine])

    def curve(there: Any, near: At) -> tuple[OrbitCurve, np.ndarray]:
        half = label == "PD" and there.rounds % 2 == 0
        return SymmetryBreakings() if half else CURVES[label], further

    return _begun(problem, point, curve)


def ones_born(problem: Any, point: SpecialPoint) -> list[Seed]:
    """The curve of folds through a point with a multiplier one; of branch points, where these persist.

    There the equations of folds are singular.
    """
    folds = born(problem, point, "LP")
    if not any(_singular(seed.problem, np.array(point.unknowns)) for seed in folds):
        return folds
    return _begun(problem, point, lambda there, near: (BranchPoints(), np.zeros(1)))


def _singular(folds: Any, z: np.ndarray) -> bool:
    """Whether the equations of a curve of folds are so at a point z, shape (N + k + 2,), of another curve."""
    place, n = np.concatenate([z[: folds.plane.size], z[-2:]]), folds.plane.size
    rows = np.concatenate([folds.orbit.equation_scales, np.ones(1)])
    values = np.linalg.svd(folds.jacobian(place) / rows[:, None] * folds.weights, compute_uv=False)
    return bool(values[n] < PERSISTS * values[0])


def limit_born(problem: Any, point: SpecialPoint, label: str) -> list[Seed]:
    """The curve of the limit of a label (`GR`) that is met at a point."""

    def curve(there: Any, near: At) -> tuple[OrbitCurve, np.ndarray] | None:
        margins = there.margins(near.z)
        met = [
            k
            for k, limit in enumerate(there.limits)
            if limit.label == label and np.isfinite(margins.relative[k])
        ]
        held = problem.curve.limit if isinstance(problem.curve, Limits) else None
        others = [k for k in met if there.limits[k] != held]
        if not others:
            return None
        which = min(others, key=lambda k: abs(float(margins.relative[k])))
        found = locating_limits.system_of(there, which, near)
        if found is None:
            return None
        further = found.start[len(near.z) :]
        return Limits(there.limits[which], len(further)), further

    return _begun(problem, point, curve)


def crossing_born(problem: Any, point: SpecialPoint) -> list[Seed]:
    """The other curve of the same kind through a point at which two cross."""
    known = np.array(point.tangent)

    def own(there: Any, near: At) -> tuple[OrbitCurve, np.ndarray]:
        return problem.curve, problem.further(np.array(point.unknowns))

    def other(curve: Any, place: np.ndarray, scale: np.ndarray) -> list[np.ndarray]:
        found = where_two_cross(curve, place, scale)
        return sorted(found, key=lambda t: abs(float((t / scale) @ (known / scale))))[:1]

    return _begun(problem, point, own, other)


def both_born(problem: Any, point: SpecialPoint, label: str, cosine: float | None = None) -> list[Seed]:
    """Both curves of a kind, as of `born`, through a point at which two cross."""
    further = np.zeros(0) if cosine is None else np.array([cosine])
    return _begun(problem, point, lambda there, near: (CURVES[label], further), where_two_cross)


def where_two_cross(
    curve: Any, z: np.ndarray, weights: np.ndarray, units: np.ndarray | None = None
) -> list[np.ndarray]:
    """Tangents of both curves through a point, units in the metric; none where they are not told apart.

    With psi DG = 0 they are those solutions of DG t = 0 for which psi.D2G(t, t) = 0. All have the shape
    (N + k + 2,); the second derivatives are differences of slopes. `units` are those of the equations, shape
    (N + k + 1,), where those of what the curve holds are known.
    """
    rows = np.ones(len(z) - 1) if units is None else units
    if units is None:
        rows[: curve.plane.size] = curve.orbit.equation_scales

    def slopes(place: np.ndarray) -> np.ndarray:
        return np.asarray(curve.jacobian(place) / rows[:, None] * weights)

    # Balanced as a matrix of states, equations that vanish on an invariant face would count for nothing.
    left, _, right = np.linalg.svd(slopes(z))
    basis = right[-2:].T

    def second(q: np.ndarray) -> np.ndarray:
        ahead, behind = (slopes(z + sign * DIFFERENCE * weights * q) for sign in (1.0, -1.0))
        return np.asarray(left[:, -1] @ (ahead - behind))

    form = np.array([second(q) @ basis for q in basis.T])
    values, vectors = np.linalg.eigh(0.5 * (form + form.T))
    if not values[0] < 0.0 < values[1]:
        return []
    shares = np.sqrt(np.array([values[1], -values[0]]))
    tangents = [basis @ (vectors @ (shares * np.array([1.0, sign]))) for sign in (1.0, -1.0)]
    return [t / np.linalg.norm(t) * weights for t in tangents]


def _begun(problem: Any, point: SpecialPoint, choose: Any, tangents: Any = None) -> list[Seed]:
    """The curve that `choose` tells of the orbit at a point, begun beside it; at it along `tangents`."""
    z = np.array(point.unknowns)
    there, own = problem.stored(z)
    typical = problem.weights[-2:]
    try:
        orbit = there.finely(own)
        weights = np.append(filled_magnitudes(orbit, own)[:-1], typical[-1])
        plane = OrbitPlane(orbit, problem.plane.free)
        there, own = plane.first(z)
        chosen = choose(there, At(own, weights, float(typical[0])))
        if chosen is None:
            return []
        curve, further = chosen
        place = np.concatenate([own[:-1], further, z[-2:]])
        scale = np.concatenate([weights[:-1], np.where(further == 0.0, 1.0, np.abs(further)), typical])
        other = problem.on(orbit, place, scale, curve)
        jacobian = other.linearize(place).jacobian
        if not np.all(np.isfinite(jacobian)):
            return []
        if tangents is not None:
            return [Seed(curve.of, place, t, None, other) for t in tangents(other, place, scale)]
        aside = _length_beside(other, place, kernel_direction(jacobian, scale), scale)
        return [Seed(curve.of, place + aside, None, None, other, other_side=place - aside)]
    except (NotFinite, PluginError, np.linalg.LinAlgError):
        return []


def _length_beside(curve: Any, place: np.ndarray, along: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """How far along a curve it is begun beside a place on it; as far as any where nothing is found.

    All have the shape (N + k + 2,).
    """
    for length in BESIDE:
        aside = length * along
        try:
            solved = newton_on(curve, place + aside, scale, along / scale**2)
        except (NotFinite, PluginError, StartError, np.linalg.LinAlgError):
            continue
        if np.linalg.norm((solved - place - aside) / scale) < OFF * length:
            return aside
    return BESIDE[0] * along


def second_cosine(point: SpecialPoint, held: float | None) -> float | None:
    """The cosine of the angle of the pair on the unit circle that a curve does not hold; None: there is none.

    `held` is the cosine that the curve holds, if it holds one.
    """
    pairs = [complex(v) for v in point.spectrum if v.imag > 0.0 and abs(abs(v) - 1.0) < 1e-3]
    cosines = [float(v.real / abs(v)) for v in pairs]
    if held is not None:
        cosines = sorted(cosines, key=lambda cosine: abs(cosine - held))[1:]
    return cosines[0] if cosines else None

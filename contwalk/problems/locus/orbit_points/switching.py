"""The other curve that passes a special point of a curve of orbits, begun a little beside it."""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import NotFinite, PluginError
from contwalk.numerics.linear import kernel_direction
from contwalk.problems.hybrid import limit_points
from contwalk.problems.locus.orbit_conditions import At
from contwalk.problems.locus.orbit_curve import OrbitCurve
from contwalk.problems.locus.orbit_curves import CURVES, Limits
from contwalk.problems.locus.orbit_places import OrbitPlane
from contwalk.problems.orbit.branching import filled_magnitudes
from contwalk.problems.problem import Seed

# How far beside the point the other curve begins, in the metric: walking back finds the point.
BESIDE = 1e-2


def born(problem: Any, point: SpecialPoint, label: str, cosine: float | None = None) -> list[Seed]:
    """The curve of folds, doublings or tori through a point; of tori with (mu + 1/mu) / 2 there."""
    further = np.zeros(0) if cosine is None else np.array([cosine])
    return _begun(problem, point, lambda there, near: (CURVES[label], further))


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
        found = limit_points.system_of(there, which, near)
        if found is None:
            return None
        further = found.start[len(near.z) :]
        return Limits(there.limits[which], len(further)), further

    return _begun(problem, point, curve)


def _begun(problem: Any, point: SpecialPoint, choose: Any) -> list[Seed]:
    """The curve that `choose` tells of the orbit at a point."""
    z = np.array(point.unknowns)
    there, own = problem.plane.first(z)
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
        beside = place + BESIDE * kernel_direction(jacobian, scale)
        return [Seed(curve.of, beside, None, None, other)]
    except (NotFinite, PluginError, np.linalg.LinAlgError):
        return []


def second_cosine(point: SpecialPoint, held: float | None) -> float | None:
    """The cosine of the angle of the pair on the unit circle that a curve does not hold; None: there is none.

    `held` is the cosine that the curve holds, if it holds one.
    """
    pairs = [complex(v) for v in point.spectrum if v.imag > 0.0 and abs(abs(v) - 1.0) < 1e-3]
    cosines = [float(v.real / abs(v)) for v in pairs]
    if held is not None:
        cosines = sorted(cosines, key=lambda cosine: abs(cosine - held))[1:]
    return cosines[0] if cosines else None

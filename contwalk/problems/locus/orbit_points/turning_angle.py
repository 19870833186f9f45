"""Points of a curve of tori at which the angle comes to half a turn and turns back.

There the map round the orbit is minus the identity on a plane: half a symmetric orbit has the multipliers i
and -i. The curve's own equations are singular at the point, for its multiplier has two directions, and
regular beside it: the point is where the cosine of the angle, interpolated between solutions on both sides,
has its extremum.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.errors import ContwalkError
from contwalk.problems.locus.orbit_points.point import known_to
from contwalk.problems.problem import Located, Sample
from contwalk.problems.solving import newton_on

SEMISIMPLE = "semisimple"
TURNS_BACK = (
    "the angle turns back: the multiplier minus one has two directions, as where half the orbit of a "
    "symmetric system has the multipliers i and -i; no curve of doublings begins"
)
# How far beside the point solutions are interpolated between, in the metric.
BESIDE = 5e-3
PLACES = BESIDE * np.array([-3.0, -2.0, -1.0, 1.0, 2.0, 3.0])
# How far from a solution an extremum is looked for.
FARTHEST = 0.3
# An extremum this many times nearer to minus one than it is known is there.
SURE = 10.0


def turning_angle(problem: Any, sample: Sample, cosine: float) -> Located | None:
    """The point near a sample at which the cosine of the angle is at a value and has an extremum."""
    rate = float(sample.tangent[problem.plane.size])
    # A parabola with its extremum at the value has it this far ahead.
    ahead = -2.0 * (float(problem.further(sample.z)[0]) - cosine) / rate if rate else 0.0
    if abs(ahead) > FARTHEST:
        return None
    middle = sample.z + ahead * sample.tangent
    try:
        there = problem.refined(sample.z, sample.weights)
        normal = sample.tangent / sample.weights**2
        solved = [newton_on(there, middle + s * sample.tangent, sample.weights, normal) for s in PLACES]
    except (ContwalkError, np.linalg.LinAlgError):
        return None
    values = np.array([float(problem.further(z)[0]) - cosine for z in solved])
    place, rougher = _extremum(PLACES, values), _extremum(PLACES[1:-1], values[1:-1])
    if place is None or rougher is None:
        return None
    z, inner = _interpolated(PLACES, np.array(solved), place), np.array(solved[1:-1])
    least, known = float(problem.further(z)[0]) - cosine, known_to(there)
    between = np.abs(z - _interpolated(PLACES[1:-1], inner, place))
    if abs(least) > SURE * known + float(problem.further(between)[0]):
        return None
    curvature = 2.0 * abs(float(np.polyfit(PLACES, values, 2)[0]))
    off = 2.0 * abs(place - rougher) + known / (curvature * BESIDE)
    errors = np.abs(off * sample.tangent[-2:]) + known * sample.weights[-2:] + between[-2:]
    second, first = problem.plane.free[1], problem.plane.free[0]
    named = {first: float(errors[1]), second: float(errors[0])}
    return Located(z, named[first], SEMISIMPLE, refined=True, problem=there, errors=named)


def _extremum(places: np.ndarray, values: np.ndarray) -> float | None:
    """Where the polynomial through values at places, shape (k,) each, has its extremum between these."""
    roots = np.roots(np.polyder(np.polyfit(places / BESIDE, values, len(places) - 1)))
    real = roots.real[np.abs(roots.imag) <= 1e-9 * np.abs(roots)] * BESIDE
    inside = real[np.abs(real) <= np.abs(places).max()]
    return float(inside[np.argmin(np.abs(inside))]) if len(inside) else None


def _interpolated(places: np.ndarray, solved: np.ndarray, place: float) -> np.ndarray:
    """The solution at a place of the polynomial through k solutions, shape (k, n)."""
    factors = [
        np.prod((place - np.delete(places, k)) / (own - np.delete(places, k))) for k, own in enumerate(places)
    ]
    return np.asarray(np.array(factors) @ solved)

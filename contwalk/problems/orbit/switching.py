"""The branches of orbits that leave a special point of an orbit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from contwalk.problems.orbit import variations
from contwalk.problems.orbit.branching import amplitude
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.null_vectors import null_vectors
from contwalk.problems.orbit.own_image import halved
from contwalk.problems.orbit.scales import cycle_scales
from contwalk.problems.orbit.shooting import velocity
from contwalk.problems.orbit.transport import carried_to, following, segments_for
from contwalk.problems.problem import Seed
from contwalk.system.declarations import ParameterValues


def doubled(problem: DiscretizedOrbit, z: np.ndarray) -> Sequence[Seed]:
    """The orbit of twice the period that leaves along the critical vector.

    It is closed up to a declared symmetry if each half of it is the image of the other one.

    z has the shape (N + 1,).
    """
    there, start, tangent = _followed(problem, z, 2, _doubled(problem))
    half = halved(there, start, tangent)
    if half is not None:
        there, start, tangent = _followed(problem, z, 1, half)
    return (Seed("PD", start, tangent, amplitude(tangent), there, one_sided=True),)


def unfolded(problem: DiscretizedOrbit, z: np.ndarray) -> Sequence[Seed]:
    """The orbit without the symmetry that its parent closes up to. z has the shape (N + 1,)."""
    closures = problem.itinerary.closures
    whole = problem.closing(closures * problem.turns).varied(parts=closures)
    there, start, tangent = _followed(problem, z, closures, whole)
    return (Seed("BP", start, tangent, amplitude(tangent), there),)


def _doubled(problem: DiscretizedOrbit) -> DiscretizedOrbit:
    """The problem of the orbits that close after two of this one's closures."""
    itinerary, turns = problem.itinerary, 2.0 * problem.turns
    if not itinerary.image:
        other = problem.varied(subharmonic=2 * problem.subharmonic) if problem.forced else problem
        return other.closing(turns).varied(parts=2)
    order = itinerary.order // 2 if itinerary.order % 2 == 0 else itinerary.order
    if order == 1:
        return problem.closing(turns).varied(parts=2)
    return problem.closing(turns, itinerary.image, 2 * itinerary.power % itinerary.order, order).varied(
        parts=2
    )


def _followed(
    problem: DiscretizedOrbit, z: np.ndarray, times: int, other: DiscretizedOrbit
) -> tuple[Any, np.ndarray, np.ndarray]:
    """A closure followed several times, the deviation changing its sign each time: an orbit of the other
    problem on steps, and the tangent there.
    """
    matrix = variations.cycle_matrix(problem, problem.linearize(z).jacobian, -1.0)
    v, _ = null_vectors(problem, matrix, *cycle_scales(problem))
    direction = np.append(v.real, 0.0)
    scalars = problem.scalars(z).copy()
    if not problem.forced:
        scalars[0] *= times
    # How deviations grow over the closures is known from one: they are not integrated in one piece to see it.
    if problem.uneven and problem.mesh.segments > 1:
        when = np.concatenate([problem.mesh.cuts + closures for closures in range(times)])
    else:
        count = segments_over(problem, z, times)
        when = np.arange(count) * times / count
    reached = [(*_at(problem, z, direction, float(time)), float(time)) for time in when]
    cut = [(x, w - _hurried(problem, z, direction, x, time)) for x, w, time in reached]
    start = other.layout.joined(np.array([x for x, _ in cut]), scalars, when / times)
    own = np.tile(problem.mesh.variation * np.sqrt(len(when)), len(when))
    weights = other.layout.joined(own, np.abs(scalars), 1.0)
    there = other.adapted_to(start, weights, problem.discretization.walking)
    deviations = other.layout.joined(np.array([w for _, w in cut]), np.zeros(len(scalars)))
    return there, start, there.into_section(start, deviations)


def segments_over(problem: DiscretizedOrbit, z: np.ndarray, times: int) -> int:
    """Number of segments of an orbit that follows a closure several times: no fewer to each than it has, or
    should have.

    Growth over all of them tells nothing of what grows and is forgotten within one.

    z has the shape (N + 1,).
    """
    count = segments_for(problem, z, times)
    if problem.discretization.segments is not None:
        return count
    each = max(problem.mesh.segments, segments_for(problem, z))
    return count if each == 1 else max(count, times * each)


def _hurried(
    problem: DiscretizedOrbit, z: np.ndarray, direction: np.ndarray, x: np.ndarray, time: float
) -> np.ndarray:
    """What a deviation of period and drifts has moved a state by at a time in closures, shape (n,).

    The deviation changes its sign with each closure, and the whole orbit's period and drifts stay what they
    are: its states are those at the same times of a clock that the deviation does not change.
    """
    changes = direction[problem.layout.scalars]
    values, columns = problem.given(z), len(changes)
    since, began = abs((time + 1.0) % 2.0 - 1.0), time % 1.0
    if not np.any(changes) or since == 0.0:
        return np.zeros(problem.states)
    faster = values.copy()
    faster[:columns] += changes  # the field is linear in each
    return since * (
        velocity(problem.passages[0], x, began, faster) - velocity(problem.passages[0], x, began, values)
    )


def _next(
    problem: DiscretizedOrbit, x: np.ndarray, w: np.ndarray, p: ParameterValues
) -> tuple[np.ndarray, np.ndarray]:
    """What follows a closure, with the deviation's sign changed."""
    image, deviation = following(problem, x, w, p)
    return image, -deviation


def _at(
    problem: DiscretizedOrbit, z: np.ndarray, direction: np.ndarray, time: float
) -> tuple[np.ndarray, np.ndarray]:
    """State and deviation at a time in closures, which may exceed one."""
    p = ParameterValues(**problem.values_of(z))
    whole = int(np.floor(time + 1e-12))
    x, v = carried_to(problem, z, direction, min(time - whole, 1.0) if time > whole else 0.0)
    for _ in range(whole):
        x, v = _next(problem, x, v, p)
    return x, v

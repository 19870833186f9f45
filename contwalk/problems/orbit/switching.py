"""The branches of orbits that leave a special point of an orbit, but for changes of the itinerary.

Where a multiplier is -1, what leaves follows the closure several times, with a deviation that changes its
sign each time. Legs that end with events begin as these come, in their own times; a closure that is one leg
goes on in the time of the whole.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import cast

import numpy as np

from contwalk.problems.orbit import variations
from contwalk.problems.orbit.along_pins import held
from contwalk.problems.orbit.branching import amplitude
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit, Kind
from contwalk.problems.orbit.kept_directions import kept_directions
from contwalk.problems.orbit.null_vectors import null_vectors
from contwalk.problems.orbit.own_image import reversing
from contwalk.problems.orbit.scales import cycle_scales
from contwalk.problems.orbit.shooting import velocity
from contwalk.problems.orbit.transport import carried_to, following, segments_for
from contwalk.problems.problem import Seed
from contwalk.system.declarations import ParameterValues


def doubled(problem: DiscretizedOrbit, z: np.ndarray, count: int = 1) -> Sequence[Seed]:
    """The orbits of twice the closure that leave where so many multipliers are -1.

    One is closed up to a declared symmetry if each half of it is the image of the other one, as where a
    symmetry keeps every state of the parent and reverses the critical vector.

    z has the shape (N + 1,).
    """
    seeds: list[Seed] = []
    for v in _critical(problem, z, count):
        name = reversing(problem, z, v)
        half = replace(problem.itinerary, image=name, power=1, order=2)
        other = problem.of_itinerary(half, 2) if name else _gone_round(problem, 2)
        seeds.extend(_leaving(problem, z, v, other, 1 if name else 2, "PD"))
    return seeds


def unfolded(problem: DiscretizedOrbit, z: np.ndarray, count: int = 1) -> Sequence[Seed]:
    """The orbits without the symmetry that their parent closes up to. z has the shape (N + 1,)."""
    times = problem.itinerary.closures
    other = _gone_round(problem, times)
    return [s for v in _critical(problem, z, count) for s in _leaving(problem, z, v, other, times, "BP")]


def whole(problem: Kind, z: np.ndarray) -> tuple[Kind, np.ndarray]:
    """The same orbit over all of its cycle, where it is closed up to a symmetry. z has the shape (N + 1,)."""
    times, still = problem.itinerary.closures, np.zeros(len(z) - 1)
    seed = _leaving(problem, z, still, _gone_round(problem, times), times, "BP")[0]
    return cast(Kind, seed.problem), seed.z


def _critical(problem: DiscretizedOrbit, z: np.ndarray, count: int) -> list[np.ndarray]:
    """The deviation whose multiplier is -1, of all unknowns, shape (N,); of several those symmetries keep."""
    if count > 1:
        return kept_directions(problem, z, -1.0, count)[0]
    matrix = variations.cycle_matrix(problem, problem.linearize(z).jacobian, -1.0)
    return [null_vectors(problem, matrix, *cycle_scales(problem))[0].real]


def _gone_round(problem: Kind, times: int) -> Kind:
    """The problem of the orbits that close after so many of this one's closures."""
    itinerary = problem.itinerary.gone_round(problem.system, times)
    periods = times * itinerary.closures // problem.itinerary.closures
    return problem.of_itinerary(itinerary, periods, times * problem.turns)


def _leaving(
    problem: DiscretizedOrbit, z: np.ndarray, v: np.ndarray, other: DiscretizedOrbit, times: int, label: str
) -> Sequence[Seed]:
    """A closure followed several times, the deviation v, shape (N,), changing its sign each time: an orbit
    of the other problem on steps, and the direction of its branch.
    """
    places, cuts = _places(problem, z, times)
    parts = times if other.parts > 1 and times > 1 else other.parts
    other = other.cut_at(cuts).varied(parts=parts)
    direction, layout, states, deviations = np.append(v, 0.0), other.layout, [], []
    for (leg, time), segment in zip(places, layout.segments, strict=True):
        x, w = _at(problem, z, direction, time, leg)
        if problem.itinerary.single:
            w = w - _hurried(problem, z, direction, x, time)
        own = list(other.passages[segment.leg].states)
        states.append(x[own])
        deviations.append(w[own])
    lasting, changing = (
        _joined(problem, vector[problem.layout.durations], signs)
        for vector, signs in ((z, np.ones(times)), (direction, (-1.0) ** np.arange(times)))
    )
    still = direction.copy()  # drifts change their sign with the closure: those of the whole do not change
    still[problem.layout.drifts] = 0.0
    start = layout.filled(problem.layout, z, states, cuts[1:], lasting)
    tangent = layout.filled(problem.layout, still, deviations, 0.0, changing)
    weights = other.weighted(problem.mesh.variation)
    there = other.adapted_to(start, weights, problem.discretization.walking)
    if problem.pins:
        start, tangent = held(there, start, tangent)
        there = other.adapted_to(start, weights, problem.discretization.walking)
    tangent = there.into_section(start, tangent)
    return (Seed(label, start, tangent, amplitude(tangent), there, one_sided=label == "PD"),)


def _places(
    problem: DiscretizedOrbit, z: np.ndarray, times: int
) -> tuple[list[tuple[int, float]], np.ndarray]:
    """Where the segments of an orbit start that follows a closure several times: in which leg of that, and
    when in it, later ones in later rounds; and the times of each leg at which it is cut.

    How deviations grow over the closures is known from one: they are not integrated in one piece to see it.
    """
    if not problem.itinerary.single:
        rounds = [(k, segment) for k in range(times) for segment in problem.layout.segments]
        own = [(each.leg, k + each.begin) for k, each in rounds if not _goes_on(problem, k, each.leg)]
        return own, np.arange(problem.cuts) / problem.cuts
    if problem.uneven and problem.mesh.segments > 1:
        when = np.concatenate([problem.mesh.cuts + closures for closures in range(times)])
    else:
        count = segments_over(problem, z, times) if problem.in_closure else times * problem.cuts
        when = np.arange(count) * times / count
    return [(0, float(time)) for time in when], when / times


def _goes_on(problem: DiscretizedOrbit, closures: int, leg: int) -> bool:
    """Whether a leg continues the last one of the closure before, which no event ended."""
    return leg == 0 and closures > 0 and not problem.itinerary.eventful


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


def _joined(problem: DiscretizedOrbit, lasting: np.ndarray, signs: np.ndarray) -> np.ndarray:
    """Durations of all legs over several rounds, or changes of them; those of each round have a sign.

    Both have the shape of as many legs as have durations among the unknowns.
    """
    first, *later = [sign * lasting for sign in signs]
    for own in later:
        if problem.itinerary.eventful:
            first = np.concatenate([first, own])
        else:
            first = np.concatenate([first[:-1], first[-1:] + own[:1], own[1:]])
    return first


def _hurried(
    problem: DiscretizedOrbit, z: np.ndarray, direction: np.ndarray, x: np.ndarray, time: float
) -> np.ndarray:
    """What a deviation of period and drifts has moved a state by at a time in closures, shape (n,).

    The deviation changes its sign with each closure, and the whole orbit's period and drifts stay what they
    are: its states are those at the same times of a clock that the deviation does not change.
    """
    values, changes = (problem.layout.inputs(0, vector)[1] for vector in (z, direction))
    values, columns = np.concatenate([values, problem.line.constants]), len(changes)
    since, began = abs((time + 1.0) % 2.0 - 1.0), time % 1.0
    if not np.any(changes) or since == 0.0:
        return np.zeros(problem.states)
    faster, passage = values.copy(), problem.passages[0]
    faster[:columns] += changes  # the field is linear in each
    own = x[list(passage.states)]
    return since * passage.full(velocity(passage, own, began, faster) - velocity(passage, own, began, values))


def _at(
    problem: DiscretizedOrbit, z: np.ndarray, direction: np.ndarray, time: float, leg: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    """Full state and deviation at a time of a leg that may exceed one: in a later round, each of which has
    the deviation of the one before with the other sign. Each has the shape (n,).
    """
    p, passage = ParameterValues(**problem.values_of(z)), problem.passages[leg]
    whole = int(np.floor(time + 1e-12))
    found = carried_to(problem, z, direction, min(time - whole, 1.0) if time > whole else 0.0, leg)
    x, w = (passage.full(own) for own in found)
    for _ in range(whole):
        x, w = following(problem, x, w, p)
        w = -w
    return x, w

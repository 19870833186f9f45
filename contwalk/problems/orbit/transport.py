"""States and tangents of an orbit at any time, to cut it into other segments or to begin it elsewhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TypeVar

import numpy as np

from contwalk import flow
from contwalk.numerics.distinct import distinct
from contwalk.numerics.linear import parameter_held
from contwalk.problems.orbit.closure import imaged
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit, Kind
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.orbit_section import section_through
from contwalk.problems.orbit.shooting import Mesh
from contwalk.problems.problem import Sample
from contwalk.system.declarations import ParameterValues

AnyOrbit = TypeVar("AnyOrbit", bound=OrbitData)

# Growth over one segment that shooting still takes easily: four digits of sixteen.
MOST_GROWTH = 1e4
PARTS = 16
# Growth over a segment beyond which an orbit is cut into twice as many: on the way, and from its start to its
# end (some times what orbits are cut for when they are begun).
TOO_MUCH, STRETCHED = 1e6, 3e4
MOST_SEGMENTS = 24
# Residuals this many times above their error still count as solved, as of any point; how many corrections.
CLOSED, MOST_CORRECTIONS = 20.0, 8
# Parts of the closure within which an instant is that of a step.
AT_STEP = 1e-14
# With this share of the parameter in the tangent, in the metric, an orbit is one of its own at its parameter.
STEEP = 0.1


def carried_to(
    problem: DiscretizedOrbit, z: np.ndarray, tangent: np.ndarray, time: float, leg: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    """State and tangent of an orbit at a time of a leg, 0..1, each of shape (n_i,)."""
    return passed_at(problem, z, tangent, leg, np.array([time]))[0]


def passed_at(
    problem: DiscretizedOrbit, z: np.ndarray, tangent: np.ndarray, leg: int, times: np.ndarray
) -> list[tuple[np.ndarray, np.ndarray]]:
    """States and tangents of an orbit at times of a leg, 0..1, each of shape (n_i,), before what ends it.

    They are those of the orbit's own steps, and of a part of one: where deviations grow, others lead
    elsewhere.
    """
    layout, found = problem.layout, []
    places, first = layout.segments_of(leg), sum(layout.cuts[:leg])
    begins = np.array([segment.begin for segment in places])
    for time in times:
        j = int(np.searchsorted(begins, time + AT_STEP, side="right")) - 1
        segment, piece = places[j], problem.segments[first + j]
        x, scalars = layout.inputs_of(segment, z)
        v, driven = layout.inputs_of(segment, tangent)
        until = _steps_until(piece.steps, float(layout.inside_of(segment, np.array([time]))[0]))
        if len(until) > 1:
            end, moved = replace(piece, steps=until).before_differentiated(PLAIN, x, scalars)
            x, v = end, moved @ np.append(v, driven)
        found.append((x.copy(), v.copy()))
    return found


def _steps_until(steps: np.ndarray, time: float) -> np.ndarray:
    """The steps of a segment up to a time, at which a last one ends."""
    node = min(int(np.searchsorted(steps, time + AT_STEP, side="right")) - 1, len(steps) - 2)
    return np.append(steps[: node + 1], time) if time > steps[node] + AT_STEP else steps[: node + 1]


def growth(problem: DiscretizedOrbit, z: np.ndarray, times: int = 1) -> float:
    """The largest factor by which a deviation grows from the start on, or up to the end, in the metric.

    What grows in between and is forgotten again, as at the jumps of a relaxation oscillation, does no harm.
    The orbit goes through its closure so many `times`.

    z has the shape (N + 1,).
    """
    n, m = problem.states, problem.mesh.segments
    field = problem.passages[0].field(PLAIN)
    values = problem.given(z)
    c = field.constants(values)
    sources, variation, last = np.full(n, -1), problem.mesh.variation, problem.segments[-1]
    factors = []
    for i, (steps, start) in enumerate(zip(problem.mesh.steps, problem.starts(z), strict=True)):
        x = start
        cuts = distinct(np.linspace(0, len(steps) - 1, max(PARTS // m, 1) + 1).astype(int))
        for low, high in pairwise(cuts):
            part = steps[low : high + 1]
            x, moved = flow.tangents(field, c, part, x, np.eye(n), sources, problem.mesh.method)
            if i == m - 1 and high == cuts[-1]:
                moved = last.at_the_end(x, moved, values)
            factors.append(moved / variation[:, None] * variation)
    factors = times * factors
    largest, since = 1.0, np.eye(n)
    for factor in factors:
        since = factor @ since
        largest = max(largest, float(np.linalg.norm(since, 2)))
    until = np.eye(n)
    for factor in reversed(factors):
        until = until @ factor
        largest = max(largest, float(np.linalg.norm(until, 2)))
    return largest


def segments_for(problem: DiscretizedOrbit, z: np.ndarray, times: int = 1) -> int:
    """Number of segments over each of which deviations grow by `MOST_GROWTH` at most.

    z has the shape (N + 1,).
    """
    if problem.discretization.segments is not None:
        return problem.discretization.segments
    largest = growth(problem, z, times)
    if not np.isfinite(largest):
        return MOST_SEGMENTS
    return segments_of_growth(float(np.log(largest)))


def segments_of_growth(exponent: float) -> int:
    """Number of segments over each of which what grows by exp(exponent) grows by `MOST_GROWTH` at most."""
    return int(np.clip(np.ceil(exponent / np.log(MOST_GROWTH)), 1, MOST_SEGMENTS))


def recut(problem: Kind, sample: Sample, cuts: np.ndarray) -> tuple[Kind, Sample]:
    """The same solution in segments that start at other times of each leg, its tangent and the sign of its
    Jacobian with it.

    Where cuts are chosen it stays on its own steps: where deviations grow, others lead elsewhere.

    `cuts` have the shape (m,).
    """
    own = problem.cut_at(cuts).uneven and problem.reference_orbit is None
    mesh = problem.mesh.divided(cuts) if own else None
    cuts = cuts if mesh is None else mesh.cuts
    passed = [
        passed_at(problem, sample.z, sample.tangent, i, cuts[:1] if leg.momentary else cuts)
        for i, leg in enumerate(problem.itinerary.legs)
    ]
    return _in_segments(problem, sample, [each for leg in passed for each in leg], cuts, mesh)


def moved(problem: Kind, sample: Sample, time: float, cuts: np.ndarray) -> tuple[Kind, Sample]:
    """The same solution of one leg, beginning at another time in 0..1 of its closure; `cuts` count from
    there.

    `cuts` have the shape (m,).
    """
    mesh = None
    if problem.uneven and problem.mesh.segments > 1 and problem.reference_orbit is None:
        mesh, time = problem.mesh.begun(time)
        mesh = mesh.divided(cuts)
        cuts = mesh.cuts
    p, instants = ParameterValues(**problem.values_of(sample.z)), time + cuts
    passed = passed_at(problem, sample.z, sample.tangent, 0, instants - np.floor(instants))
    later = [
        following(problem, *each, p) if when >= 1.0 else each
        for when, each in zip(instants, passed, strict=True)
    ]
    return _in_segments(problem, sample, later, cuts, mesh)


def _in_segments(
    problem: Kind,
    sample: Sample,
    passed: Sequence[tuple[np.ndarray, np.ndarray]],
    cuts: np.ndarray,
    mesh: Mesh | None,
) -> tuple[Kind, Sample]:
    """The solution whose segments start with such states and tangents at times of each leg, shape (m,)."""
    other, before = problem.cut_at(cuts), problem.layout
    layout = other.layout
    z = layout.filled(before, sample.z, [x for x, _ in passed], cuts[1:])
    tangent = layout.filled(before, sample.tangent, [v for _, v in passed], 0.0)
    # Each state's share of the metric stays what it is: the squares of all segments add up.
    share = np.sqrt(len(layout.segments) / len(before.segments))
    own = [share * sample.weights[before.states[segment.leg]] for segment in layout.segments]
    weights = layout.filled(before, sample.weights, own, 1.0)
    if mesh is None:  # made for the orbit
        other = other.adapted_to(z, weights)
    else:
        section = section_through(problem, z[layout.states[0]], other.given(z), mesh.magnitudes)
        other = other.on(mesh, section)
    return other, _examined(other, z, other.into_section(z, tangent), weights, sample)


def _examined(
    problem: DiscretizedOrbit, z: np.ndarray, tangent: np.ndarray, weights: np.ndarray, sample: Sample
) -> Sample:
    """What is watched at the same solution in other segments; a branch point that a walk begins at stays one.

    All have the shape (N + 1,).
    """
    again = problem.examine(z, tangent, weights, problem.linearize(z), sample.unstable)
    orientation = 0.0 if sample.orientation == 0.0 else again.orientation
    return replace(again, iterations=sample.iterations, orientation=orientation)


def closed(problem: AnyOrbit, rough: Sample) -> tuple[AnyOrbit, Sample] | None:
    """The orbit corrected on the steps that it was cut or moved to; None where that does not converge.

    Where deviations grow, what was a solution on other steps is none on these: its gap is the error of both,
    times the growth. The parameter stays, as at an end of its range it must, unless the branch turns there.
    At a branch point nothing is: the equations tell neither where it is nor which way a branch goes.
    """
    linearization = problem.linearize(rough.z)
    if linearization.finite and linearization.excess <= CLOSED:
        return problem, rough
    if rough.orientation == 0.0:
        return None
    along, z, before = rough.tangent / rough.weights**2, rough.z, np.inf
    held = abs(rough.share) > STEEP
    normal = parameter_held(rough.weights) if held else along
    for _ in range(MOST_CORRECTIONS):
        if not linearization.finite:
            return None
        try:
            right = np.append(linearization.residual, normal @ (z - rough.z))
            step = linearization.bordered(normal, rough.weights).solve(right)
        except np.linalg.LinAlgError:
            return None
        size = float(np.linalg.norm(step / rough.weights))
        if size > before:
            return None
        z, before = z - step, size
        if held:
            z[-1] = rough.z[-1]
        linearization = problem.linearize(z)
        if linearization.finite and linearization.excess <= 2.0:
            break
    if not (linearization.finite and linearization.excess <= CLOSED):
        return None
    tangent = linearization.tangent(along, rough.weights)
    again = problem.examine(z, tangent, rough.weights, linearization, rough.unstable)
    return problem, replace(again, iterations=rough.iterations)


def following(
    problem: DiscretizedOrbit, x: np.ndarray, v: np.ndarray, p: ParameterValues
) -> tuple[np.ndarray, np.ndarray]:
    """State and deviation one closure later: the inverse image, in unturned angles.

    All have the shape (n,).
    """
    itinerary, turns = problem.itinerary, problem.turns
    if not itinerary.image:
        return x + turns, v
    symmetry, inverse = problem.system.symmetry(itinerary.image), (itinerary.order - 1) * itinerary.power
    image = imaged(symmetry, x, p, inverse)
    # Symmetries of machines are affine, so that a difference is exact to rounding.
    step = max(float(np.linalg.norm(x)), 1.0) / (float(np.linalg.norm(v)) or 1.0)
    return image + turns, (imaged(symmetry, x + step * v, p, inverse) - image) / step

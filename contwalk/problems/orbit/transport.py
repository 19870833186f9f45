"""States and tangents of an orbit at any time, to cut it into other segments or to begin it elsewhere."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import TypeVar

import numpy as np

from contwalk import flow
from contwalk.numerics.distinct import distinct
from contwalk.problems.orbit.closure import imaged
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit, Kind
from contwalk.problems.orbit.lifts import PLAIN, TANGENT
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.orbit_section import section_through
from contwalk.problems.orbit.shooting import Mesh, arrived
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
    problem: DiscretizedOrbit, z: np.ndarray, tangent: np.ndarray, time: float
) -> tuple[np.ndarray, np.ndarray]:
    """State and tangent of the orbit at a time in 0..1 of the closure, each of shape (n,)."""
    n, cuts = problem.states, problem.mesh.cuts
    segment = int(np.searchsorted(cuts, time, side="right")) - 1
    begin = float(cuts[segment])
    x, v = problem.starts(z)[segment], tangent[segment * n : (segment + 1) * n]
    if time - begin < 1e-12:
        return x.copy(), v.copy()
    mesh = problem.mesh
    values = problem.given(z)
    if not np.any(tangent):
        field, y, weights = problem.passages[0].field(PLAIN), x, mesh.variation
    else:
        field, y = problem.passages[0].field(TANGENT), np.concatenate([x, v])
        values = np.concatenate([values, tangent[problem.layout.scalars]])
        size = max(float(np.linalg.norm(v / mesh.variation)), 1e-12)
        weights = np.concatenate([mesh.variation, size * mesh.variation])
    path = arrived(
        flow.adaptive(field, field.constants(values), begin, y, time, mesh.tolerance, weights, mesh.method)
    )
    end = path.states[-1]
    return end[:n].copy(), end[n:].copy() if len(end) > n else np.zeros(n)


def passed_at(
    problem: DiscretizedOrbit, z: np.ndarray, tangent: np.ndarray, times: np.ndarray
) -> list[tuple[np.ndarray, np.ndarray]]:
    """States and tangents of the orbit at times in 0..1 of the closure, each of shape (n,).

    Where cuts are chosen they are those of the orbit's own steps: where deviations grow, others lead
    elsewhere.
    """
    if not problem.uneven:
        return [carried_to(problem, z, tangent, float(time)) for time in times]
    mesh, n, scalars = problem.mesh, problem.states, problem.scalars(z)
    driven = tangent[problem.layout.scalars]
    field, c = problem.passages[0].field(PLAIN), problem.passages[0].field(PLAIN).constants(problem.given(z))
    sources = np.arange(-n, len(scalars))
    sources[:n] = -1
    found = []
    for time in times:
        i = int(np.searchsorted(mesh.cuts, time + AT_STEP, side="right")) - 1
        steps = mesh.steps[i]
        node = min(int(np.searchsorted(steps, time + AT_STEP, side="right")) - 1, len(steps) - 2)
        until = np.append(steps[: node + 1], time) if time > steps[node] + AT_STEP else steps[: node + 1]
        x, moved = problem.starts(z)[i], np.eye(n, n + len(scalars))
        if len(until) > 1:
            x, moved = flow.tangents(field, c, until, x, moved, sources, mesh.method)
        found.append((x.copy(), moved @ np.append(tangent[i * n : (i + 1) * n], driven)))
    return found


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
    """The same solution in segments that start at other times, its tangent and the sign of its Jacobian with
    it.

    Where cuts are chosen it stays on its own steps: where deviations grow, others lead elsewhere.

    `cuts` have the shape (m,).
    """
    own = problem.uneven and problem.reference_orbit is None
    mesh = problem.mesh.divided(cuts) if own else None
    cuts = cuts if mesh is None else mesh.cuts
    n, m, z, scalars = problem.states, problem.mesh.segments, sample.z, problem.layout.scalars
    starts, tangents = zip(*passed_at(problem, z, sample.tangent, cuts), strict=True)
    there = problem.layout.joined(np.array(starts), z[scalars], cuts)
    tangent = problem.layout.joined(np.array(tangents), sample.tangent[scalars])
    # Each state's share of the metric stays what it is: the squares of m segments add up.
    states = sample.weights[:n] * np.sqrt(len(cuts) / m)
    weights = problem.layout.joined(np.tile(states, len(cuts)), sample.weights[scalars], 1.0)
    finer = _remeshed(problem, there, weights, mesh)
    tangent = finer.into_section(there, tangent)
    return finer, _examined(finer, there, tangent, weights, sample)


def moved(problem: Kind, sample: Sample, time: float, cuts: np.ndarray) -> tuple[Kind, Sample]:
    """The same solution, beginning at another time in 0..1 of its closure; `cuts` count from there.

    `cuts` have the shape (m,).
    """
    mesh = None
    if problem.uneven and problem.mesh.segments > 1 and problem.reference_orbit is None:
        mesh, time = problem.mesh.begun(time)
        mesh = mesh.divided(cuts)
        cuts = mesh.cuts
    n, m, z, scalars = problem.states, problem.mesh.segments, sample.z, problem.layout.scalars
    p = ParameterValues(**problem.values_of(z))
    starts, tangents, instants = [], [], time + cuts
    passed = passed_at(problem, z, sample.tangent, instants - np.floor(instants))
    for when, (x, v) in zip(instants, passed, strict=True):
        if when >= 1.0:
            x, v = following(problem, x, v, p)
        starts.append(x)
        tangents.append(v)
    there = problem.layout.joined(np.array(starts), z[scalars], cuts)
    tangent = problem.layout.joined(np.array(tangents), sample.tangent[scalars])
    weights = sample.weights
    if len(cuts) != m:
        states = weights[:n] * np.sqrt(len(cuts) / m)
        weights = problem.layout.joined(np.tile(states, len(cuts)), weights[scalars], 1.0)
    begun = _remeshed(problem, there, weights, mesh)
    tangent = begun.into_section(there, tangent)
    return begun, _examined(begun, there, tangent, weights, sample)


def _examined(
    problem: DiscretizedOrbit, z: np.ndarray, tangent: np.ndarray, weights: np.ndarray, sample: Sample
) -> Sample:
    """What is watched at the same solution in other segments; a branch point that a walk begins at stays one.

    All have the shape (N + 1,).
    """
    again = problem.examine(z, tangent, weights, problem.linearize(z), sample.unstable)
    orientation = 0.0 if sample.orientation == 0.0 else again.orientation
    return replace(again, iterations=sample.iterations, orientation=orientation)


def _remeshed(problem: Kind, z: np.ndarray, weights: np.ndarray, mesh: Mesh | None) -> Kind:
    """The problem on a mesh, or else on one made for the orbit of z, with a section through its start."""
    if mesh is None:
        made: Kind = problem.adapted_to(z, weights)
        return made
    values = problem.fitting(z).given(z)
    return problem.on(mesh, section_through(problem, z[: problem.states], values, mesh.magnitudes))


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
    held = abs(rough.tangent[-1] / rough.weights[-1]) > STEEP
    normal = np.append(np.zeros(len(z) - 1), 1.0 / rough.weights[-1]) if held else along
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

"""The branches that leave a special point of a branch of hybrid orbits, but for changes of the itinerary."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from contwalk.problems.hybrid import cut_legs
from contwalk.problems.hybrid.limited_orbit import Kind, LimitedOrbit
from contwalk.problems.orbit import monodromy, variations
from contwalk.problems.orbit.branching import amplitude, filled_magnitudes
from contwalk.problems.orbit.closure import imaged
from contwalk.problems.orbit.fine_steps import discretized
from contwalk.problems.orbit.itinerary import imaged_leg
from contwalk.problems.orbit.null_vectors import null_vectors
from contwalk.problems.orbit.scales import cycle_scales
from contwalk.problems.problem import Seed
from contwalk.system import Symmetry
from contwalk.system.declarations import ParameterValues

# Images that differ by less than this part of the variation are one.
ALIKE = 1e-6
# Shifts along pinned directions that are tried, and how little they leave of the residual.
MOST_SHIFTS, SHIFTED = 5, 2.0


def doubled(problem: LimitedOrbit, z: np.ndarray) -> Sequence[Seed]:
    """The orbit of the itinerary run through twice that leaves along the critical vector.

    Where the second round is the image of the first, as where a symmetry keeps every state of the parent and
    reverses the critical vector, it is one round that closes up to that image.

    z has the shape (N + 1,).
    """
    matrix = variations.cycle_matrix(problem, problem.linearize(z).jacobian, -1.0)
    v = null_vectors(problem, matrix, *cycle_scales(problem))[0].real
    name = _reversing(problem, z, v)
    if name:
        there = discretized(problem.of_itinerary(replace(problem.itinerary, image=name), 2), z, problem)
        size = float(np.linalg.norm(v / cycle_scales(there)[1]))
        tangent = np.append(v, 0.0) / size
        walking = there.adapted_to(z, filled_magnitudes(there, z))
        return (Seed("PD", z, tangent, amplitude(tangent), walking, one_sided=True),)
    other = problem.of_itinerary(problem.itinerary.repeated(2), 2)
    return _alternating(problem, z, other, lambda i, x: x, "PD")


def _reversing(problem: LimitedOrbit, z: np.ndarray, v: np.ndarray) -> str:
    """The symmetry that keeps each leg of an orbit and reverses a deviation of it; empty if there is none."""
    layout, itinerary = problem.layout, problem.itinerary
    if itinerary.image or not itinerary.eventful or problem.pins or np.any(problem.turns):
        return ""
    size = float(np.linalg.norm(v / cycle_scales(problem)[1]))
    if np.any(np.abs(v[layout.durations]) > ALIKE * size * problem.mesh.total):
        return ""
    spatial = (s for s in problem.system.symmetries if s.role == "spatial")
    return next((s.name for s in spatial if _reverses(problem, z, v / size, s)), "")


def _reverses(problem: LimitedOrbit, z: np.ndarray, v: np.ndarray, symmetry: Symmetry) -> bool:
    p, scale = ParameterValues(**problem.values_of(z)), problem.mesh.variation
    for leg, passage, place in zip(
        problem.itinerary.legs, problem.passages, problem.layout.states, strict=True
    ):
        own, x, w = list(passage.states), passage.full(z[place]), passage.full(v[place])
        moved = imaged(symmetry, x, p) - x, imaged(symmetry, x + w, p) - x + w
        apart = max(float(np.linalg.norm((each / scale)[own])) for each in moved)
        if imaged_leg(problem.system, symmetry.name, leg) != leg or apart > ALIKE:
            return False
    return True


def unfolded(problem: LimitedOrbit, z: np.ndarray) -> Sequence[Seed]:
    """The orbit without the symmetry that its parent closes up to. z has the shape (N + 1,)."""
    other, symmetry = (
        problem.of_itinerary(problem.itinerary.unfolded(problem.system)),
        problem.system.symmetry(problem.itinerary.image),
    )
    p, passages = ParameterValues(**problem.values_of(z)), problem.passages

    def image(i: int, x: np.ndarray) -> np.ndarray:
        """Of a state (or, as the map is linear in it, of a deviation) at the start of leg i."""
        following = other.passages[len(passages) + i]
        return imaged(symmetry, passages[i].full(x), p)[list(following.states)]

    return _alternating(problem, z, other, image, "BP")


def _alternating(
    problem: LimitedOrbit,
    z: np.ndarray,
    other: LimitedOrbit,
    image: Callable[[int, np.ndarray], np.ndarray],
    label: str,
) -> Sequence[Seed]:
    """A closure followed twice, the second time as its image and with the deviation's sign changed."""
    layout = problem.layout
    matrix = variations.cycle_matrix(problem, problem.linearize(z).jacobian, -1.0)
    v, _ = null_vectors(problem, matrix, *cycle_scales(problem))
    v = v.real
    lasting, rest = layout.durations, layout.rest
    still = np.zeros(rest.stop - rest.start)
    if layout.start is not None:
        still[0] = v[layout.start]
    # A leg that no event ends is one with the first leg of the second round.
    places = list(enumerate(layout.states))[0 if problem.itinerary.eventful else 1 :]
    second = [image(i, z[place]) for i, place in places]
    turned = [-image(i, v[place]) for i, place in places]
    states = slice(0, lasting.start)
    twice, alternating = _joined(problem, z[lasting], 1.0), _joined(problem, v[lasting], -1.0)
    start = np.concatenate([z[states], *second, twice, z[rest], z[-1:]])
    tangent = np.concatenate([v[states], *turned, alternating, still, [0.0]])
    inner, moved = cut_legs.blocks(problem, z), cut_legs.blocks(problem, v)
    again = [np.array([image(i, x) for x in own]) for i, own in enumerate(inner)]
    back = [np.array([-image(i, x) for x in own]) for i, own in enumerate(moved)]
    if problem.cuts > 1 and not problem.itinerary.eventful:  # where both rounds meet another segment begins
        first = layout.states[0]
        inner = [np.vstack([inner[0], image(0, z[first])[None], again[0]])]
        moved = [np.vstack([moved[0], -image(0, v[first])[None], back[0]])]
        again, back = [], []
    start, tangent = cut_legs.completed(start, inner + again), cut_legs.completed(tangent, moved + back)
    there = discretized(other, start, problem)
    weights = np.concatenate([cycle_scales(there)[1], [1.0]])
    if problem.pins:
        start, tangent = _held(there, start, tangent, weights)
    tangent = tangent / float(np.linalg.norm(tangent / weights))
    walking = there.adapted_to(start, filled_magnitudes(there, start))
    return (Seed(label, start, tangent, amplitude(tangent), walking, one_sided=label == "PD"),)


def _joined(problem: LimitedOrbit, lasting: np.ndarray, sign: float) -> np.ndarray:
    """Durations of all legs over two rounds, or changes of them; those of the second have a sign."""
    second = sign * lasting
    if problem.itinerary.eventful:
        return np.concatenate([lasting, second])
    return np.concatenate([lasting[:-1], lasting[-1:] + second[:1], second[1:]])


def _held(
    problem: LimitedOrbit, start: np.ndarray, tangent: np.ndarray, weights: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """An orbit and a direction in which orbits leave it, as one sees them who drifts along all of the cycle.

    Each half was seen by one who drifts so that it alone closes. What lies across the pinned directions is
    right; the parts along them follow from the equations.
    """
    start, rows = shifted(problem, start), problem.equation_scales
    plane = (
        weights[:, None]
        * np.linalg.svd(problem.linearize(start).jacobian / rows[:, None] * weights)[2][-2:].T
    )
    along = _along_pins(problem, start) / weights[:, None]

    def across(vectors: np.ndarray) -> np.ndarray:
        scaled = vectors / weights[:, None]
        return scaled - along @ np.linalg.lstsq(along, scaled, rcond=None)[0]

    shares = np.linalg.lstsq(across(plane), across(tangent[:, None]), rcond=None)[0]
    return start, (plane @ shares)[:, 0]


def shifted(problem: LimitedOrbit, z: np.ndarray) -> np.ndarray:
    """An orbit that is right but for drifts and for its starts along pinned directions, with these.

    Both have the shape (N + 1,).
    """
    z, rows = z.copy(), problem.equation_scales
    if not problem.pins:
        return z
    for _ in range(MOST_SHIFTS):
        here, along = problem.linearize(z), _along_pins(problem, z)
        scaled = here.jacobian @ along / rows[:, None]
        z = z - along @ np.linalg.lstsq(scaled, here.residual / rows, rcond=None)[0]
        if problem.linearize(z).excess <= SHIFTED:
            break
    return z


def rotated(problem: Kind, z: np.ndarray, first: int) -> tuple[Kind, np.ndarray]:
    """The same orbit, beginning with another leg: of half a cycle, images of what came before follow.

    Both have the shape (N + 1,).
    """
    layout, image, system = problem.layout, problem.itinerary.image, problem.system
    symmetry, p = system.symmetry(image) if image else None, ParameterValues(**problem.values_of(z))
    states = [passage.full(z[place]) for passage, place in zip(problem.passages, layout.states, strict=True)]
    other = problem.of_itinerary(problem.itinerary.rotated(system, first))
    result = other.assembled(
        states[first:] + [imaged(symmetry, x, p) for x in states[:first]],
        np.roll(z[layout.durations], -first),
        z[layout.drifts],
        float(z[-1]),
        float(problem.starting_times(z)[first]),
    )
    result = _with_segments(problem, z, other, result, first, symmetry, p)
    other.reference = other.first_state(result)
    there = discretized(other, result)
    return there, shifted(there, result)


def _with_segments(
    problem: LimitedOrbit,
    z: np.ndarray,
    other: LimitedOrbit,
    bare: np.ndarray,
    first: int,
    symmetry: Symmetry | None,
    p: ParameterValues,
) -> np.ndarray:
    """Unknowns of a rotated orbit with the inner states of the legs, images of those that come first here."""
    inner, m = cut_legs.blocks(problem, z), problem.layout.legs
    found = inner[first:]
    for i in range(first):
        own, there = problem.passages[i], other.passages[m - first + i]
        moved = [imaged(symmetry, own.full(x), p)[list(there.states)] for x in inner[i]]
        found.append(np.array(moved))
    return cut_legs.completed(bare, found)


def _along_pins(problem: LimitedOrbit, z: np.ndarray) -> np.ndarray:
    """Directions in which the legs' starts move along pinned directions, and the drifts, as columns."""
    layout, columns = problem.layout, []
    for i, n in enumerate(layout.sizes):
        for j, segment in enumerate(layout.segments_of(i)):
            for direction in monodromy.pinned_directions(problem, z, i, j):
                column = np.zeros(layout.size + 1)
                column[segment.states] = direction[:n]
                columns.append(column)
    return np.column_stack([*columns, np.eye(layout.size + 1)[:, layout.drifts]])

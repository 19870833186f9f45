"""Orbits through events that begin with another leg."""

from __future__ import annotations

import numpy as np

from contwalk.problems.hybrid import cut_legs
from contwalk.problems.hybrid.limited_orbit import Kind, LimitedOrbit
from contwalk.problems.orbit.along_pins import shifted
from contwalk.problems.orbit.closure import imaged
from contwalk.problems.orbit.fine_steps import discretized
from contwalk.system import Symmetry
from contwalk.system.declarations import ParameterValues


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

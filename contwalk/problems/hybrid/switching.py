"""The branches that leave a special point of a branch of hybrid orbits, but for changes of the word."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import NotFinite
from contwalk.problems.hybrid.word import Word
from contwalk.problems.orbit.branching import amplitude, crossing, filled_magnitudes
from contwalk.problems.orbit.null_vectors import null_vectors
from contwalk.problems.problem import Seed

if TYPE_CHECKING:
    from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit

# Size of a state that starts show nothing of, against the largest; tolerance of steps for magnitudes only.
UNSEEN, ROUGH = 1e-2, 1e-7


def seeds(problem: HybridOrbit, point: SpecialPoint) -> Sequence[Seed]:
    """The branches that leave a special point."""
    z = np.array(point.unknowns)
    try:
        there = discretized(problem, z)
        if point.label == "PD":
            return _doubled(there, z)
        if point.label == "BP" and point.coefficients:
            return crossing(there, z, point)
    except (NotFinite, np.linalg.LinAlgError):
        return ()
    return ()


def discretized(problem: HybridOrbit, z: np.ndarray) -> HybridOrbit:
    """The problem on fine steps for a stored solution."""
    layout = problem.layout
    reached = np.zeros(problem.states)
    for place, passage in zip(layout.states, problem.passages, strict=True):
        own = list(passage.states)
        reached[own] = np.maximum(reached[own], np.abs(z[place]))
    largest = float(reached.max()) or 1.0
    # What is zero at the starts of legs is not zero on them.
    reached = np.maximum(reached, UNSEEN * largest)
    sizes = np.ones(len(z))
    for place, passage in zip(layout.states, problem.passages, strict=True):
        sizes[place] = reached[list(passage.states)] * np.sqrt(layout.legs)
    rough = problem.adapted_to(z, sizes, max(problem.discretization.walking, ROUGH))
    return rough.adapted_to(z, filled_magnitudes(rough, z), problem.discretization.locating)


def divided(problem: HybridOrbit, z: np.ndarray, times: int) -> tuple[HybridOrbit, np.ndarray]:
    """The problem of the first part of a word that repeats itself, and the same part of the orbit."""
    layout, part = problem.layout, problem.layout.legs // times
    states = slice(0, layout.states[part].start)
    lasting = slice(layout.durations.start, layout.durations.start + part)
    start = np.concatenate([z[states], z[lasting], z[layout.durations.stop :]])
    other = problem.of_word(Word(problem.word.legs[:part]), turns=problem.turns / times)
    other.subharmonic = max(problem.subharmonic // times, 1)
    return discretized(other, start), start


def _doubled(problem: HybridOrbit, z: np.ndarray) -> Sequence[Seed]:
    """The orbit of the word run through twice that leaves along the critical vector."""
    layout = problem.layout
    matrix = problem.cycle_matrix(problem.linearize(z).jacobian, -1.0)
    v, _ = null_vectors(problem, matrix, *problem.cycle_scales)
    v = v.real
    other = problem.of_word(problem.word.repeated(2), 2)
    states, lasting = slice(0, layout.durations.start), layout.durations
    rest = slice(lasting.stop, layout.size)
    still = np.zeros(layout.size - lasting.stop)
    if layout.start is not None:
        still[0] = v[layout.start]
    start = np.concatenate([z[states], z[states], z[lasting], z[lasting], z[rest], z[-1:]])
    tangent = np.concatenate([v[states], -v[states], v[lasting], -v[lasting], still, [0.0]])
    there = discretized(other, start)
    weights = np.concatenate([there.cycle_scales[1], [1.0]])
    tangent = tangent / float(np.linalg.norm(tangent / weights))
    walking = there.adapted_to(start, filled_magnitudes(there, start))
    return (Seed("PD", start, tangent, amplitude(tangent), walking, one_sided=True),)

"""Recognising a branch that is already known, by its points and by their images under declared symmetries."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from contwalk.branch import Branch
from contwalk.continuation.newton import correct
from contwalk.problems.equilibrium import Equilibrium

# Solutions nearer than this, in the metric, are the same one: far above the corrector's error, far below a
# step.
SAME = 1e-7
MOST_IMAGES = 24


def images(problem: Equilibrium, z: np.ndarray) -> Iterator[np.ndarray]:
    """z and its images under products of the declared symmetries."""
    found = [z]
    for current in found:
        yield current
        for symmetry in problem.system.symmetries:
            image = problem.image(symmetry.name, current)
            new = all(not np.allclose(image, other, rtol=1e-12, atol=1e-14) for other in found)
            if new and len(found) < MOST_IMAGES:
                found.append(image)


def known_branch(
    problem: Equilibrium, z: np.ndarray, weights: np.ndarray, branches: list[Branch]
) -> str | None:
    """Name of the branch that a solution lies on, or an image of it; None if it is new."""
    candidates = [b for b in branches if _comparable(problem, b)]
    for image, branch in itertools.product(images(problem, z), candidates):
        if _on(problem, image, weights, branch):
            return branch.name
    return None


def _comparable(problem: Equilibrium, branch: Branch) -> bool:
    """Whether a branch belongs to the same equations at the same fixed parameters."""
    if branch.info.free != (problem.free,) or len(branch.points) < 2:
        return False
    if branch.info.settings.get("pins") != [pin.name for pin in problem.pins]:
        return False
    fixed = {name: v for name, v in problem.parameters.items() if name != problem.free}
    return all(branch.info.parameters.get(name) == v for name, v in fixed.items())


def _on(problem: Equilibrium, z: np.ndarray, weights: np.ndarray, branch: Branch) -> bool:
    """Whether z lies on the curve through a branch's points, each piece recomputed where it passes z."""
    rows = np.column_stack([branch.points["unknowns"], branch.points["free"][:, 0]])
    z = problem.nearest_turn(z, rows[0])
    a, chord = rows[:-1], np.diff(rows, axis=0)
    normal = chord / weights**2
    length = np.einsum("ij,ij->i", normal, chord)
    usable = length > 0
    theta = np.full(len(a), np.nan)
    theta[usable] = np.einsum("ij,ij->i", normal[usable], z - a[usable]) / length[usable]
    foot = a + theta[:, None] * chord
    distance = np.linalg.norm((z - foot) / weights, axis=1)
    near = (theta > -0.01) & (theta < 1.01) & (distance < 0.5 * np.sqrt(length) + SAME)
    for i in np.flatnonzero(near):
        correction = correct(problem, foot[i], normal[i], weights)
        if correction.ok and np.linalg.norm((correction.z - z) / weights) < SAME:
            return True
    return False

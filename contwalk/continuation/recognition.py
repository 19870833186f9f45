"""Recognising a branch that is already known, by its points and by their images under declared symmetries."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, cast

import numpy as np

from contwalk.branch import Branch
from contwalk.continuation.newton import correct
from contwalk.errors import NotFinite
from contwalk.problems.equilibrium import Equilibrium
from contwalk.problems.problem import Problem, Sample
from contwalk.system.declarations import ParameterValues

if TYPE_CHECKING:  # compiled flows are imported only where orbits are computed
    from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
    from contwalk.problems.orbit.periodic_orbit import PeriodicOrbit

# Solutions nearer than this, in the metric, are the same one: far above the corrector's error, far below a
# step.
SAME = 1e-7
MOST_IMAGES = 24
# A branch is compared with another by its points and its way: cosine between the two, and how far to look
# for it.
ALONG = 0.8
BESIDE = 1e-4


Pair = tuple[np.ndarray, np.ndarray]


def images(problem: Equilibrium, z: np.ndarray, beyond: np.ndarray) -> Iterator[Pair]:
    """z and a point beside it on its branch, and their images under products of the declared symmetries."""
    found = [(z, beyond)]
    for current in found:
        yield current
        for symmetry in problem.system.symmetries:
            image = problem.image(symmetry.name, current[0])
            new = all(not np.allclose(image, other, rtol=1e-12, atol=1e-14) for other, _ in found)
            if new and len(found) < MOST_IMAGES:
                found.append((image, problem.image(symmetry.name, current[1])))


def known_branch(problem: Problem, sample: Sample, branches: list[Branch]) -> str | None:
    """Name of the branch that a solution and its tangent lie on, or their images; None if it is new."""
    if problem.discretized:
        return known_orbit(cast("PeriodicOrbit | HybridOrbit", problem), sample, branches)
    assert isinstance(problem, Equilibrium)
    candidates = [b for b in branches if _comparable(problem, b)]
    beyond = sample.z + BESIDE * sample.tangent
    for pair, branch in itertools.product(images(problem, sample.z, beyond), candidates):
        if _on(problem, pair, sample.weights, branch):
            return branch.name
    return None


def _comparable(problem: Equilibrium | PeriodicOrbit | HybridOrbit, branch: Branch) -> bool:
    """Whether a branch belongs to the same equations at the same fixed parameters."""
    if branch.info.problem != problem.kind or branch.info.free != (problem.free,) or len(branch.points) < 2:
        return False
    if branch.info.settings.get("pins") != [pin.name for pin in problem.pins]:
        return False
    # Along a path, a problem may have been made at any of its points.
    begin, end = problem.path or ({}, {})
    moving = {problem.free, *(name for name in begin if begin[name] != end[name])}
    fixed = {name: v for name, v in problem.parameters.items() if name not in moving}
    return all(branch.info.parameters.get(name) == v for name, v in fixed.items())


def _on(problem: Equilibrium, pair: Pair, weights: np.ndarray, branch: Branch) -> bool:
    """Whether z lies on the curve through a branch's points, each piece recomputed where it passes z."""
    z, along = pair[0], (pair[1] - pair[0]) / weights
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
        way = chord[i] / weights
        if abs(way @ along) < ALONG * np.linalg.norm(way) * np.linalg.norm(along):
            continue  # it crosses the branch
        correction = correct(problem, foot[i], normal[i], weights)
        if correction.ok and np.linalg.norm((correction.z - z) / weights) < SAME:
            return True
    return False


# -- orbits ------------------------------------------------------------------------------------------------

# Relative change of the period between neighbouring points within which a piece of branch is looked at.
NEAR_PERIOD = 0.05


def known_orbit(problem: PeriodicOrbit | HybridOrbit, sample: Sample, branches: list[Branch]) -> str | None:
    """Name of the branch that an orbit, or an image of it under a declared symmetry, lies on.

    An orbit begins anywhere on itself: candidates are recomputed at the same parameter, and compared as
    curves.
    """
    own = _kinds(problem, problem.branch_facts().get("signature"))
    for branch in branches:
        if not _comparable(problem, branch) or branch.info.subharmonic != problem.subharmonic:
            continue
        closures = 1
        if branch.info.closure != problem.whole[0]:
            # Of a whole orbit that is its own image, half may be what is stored.
            if problem.whole[0] != "full" or not branch.info.settings.get("image"):
                continue
            closures = 2
        if sorted(_kinds(problem, branch.info.signature) * closures) != own:
            continue
        if _orbit_on(problem, sample, branch, closures):
            return branch.name
    return None


def _kinds(problem: PeriodicOrbit | HybridOrbit, signature: Sequence[str] | None) -> list[str]:
    """The events of an orbit in no order, those that are images of each other under one name.

    What closes up to a mirror may begin in either half.
    """
    images = [s.events for s in problem.system.symmetries if s.role == "spatial"]

    def kind(name: str) -> str:
        alike = [name]
        for other in alike:
            alike += [image[other] for image in images if image.get(other, name) not in alike]
        return min(alike)

    return sorted(kind(name) for name in signature or ())


def _orbit_on(
    problem: PeriodicOrbit | HybridOrbit, sample: Sample, branch: Branch, closures: int = 1
) -> bool:
    value, period = sample.z[-1], sample.period / closures
    for k, (ta, tb) in enumerate(pairwise(branch.points["period"])):
        a, b = branch.unknowns(k), branch.unknowns(k + 1)
        if len(a) != len(b):
            continue
        low, high = sorted((a[-1], b[-1]))
        slack = 1e-9 * abs(value)
        if not low - slack <= value <= high + slack or a[-1] == b[-1]:
            continue
        if not (1 - NEAR_PERIOD) * min(ta, tb) <= period <= (1 + NEAR_PERIOD) * max(ta, tb):
            continue
        share = (value - a[-1]) / (b[-1] - a[-1])
        guess = a + share * (b - a)
        stored = branch.points["weights"][k]
        weights = stored[np.isfinite(stored)]
        normal = np.zeros(len(guess))
        normal[-1] = 1.0 / weights[-1]
        try:
            there = _stored_like(problem, branch, guess).at_stored(guess, weights)
            correction = correct(there, guess, normal, weights)
        except NotFinite:
            continue
        if not correction.ok or abs(there.duration(correction.z) - period) > SAME * period:
            continue
        from contwalk.problems.orbit.closure import imaged

        x, p = problem.first_state(sample.z), ParameterValues(**problem.values_of(sample.z))
        spatial = [s for s in problem.system.symmetries if s.role == "spatial"]
        if there.passes(correction.z, [x, *[imaged(symmetry, x, p) for symmetry in spatial]]):
            return True
    return False


def _stored_like(
    problem: PeriodicOrbit | HybridOrbit, branch: Branch, guess: np.ndarray
) -> PeriodicOrbit | HybridOrbit:
    """The problem whose unknowns a branch stores: of a hybrid orbit, they may begin with another leg."""
    if problem.kind != "hybrid_orbit":
        return problem
    from contwalk.continuation.reopening import problem_of

    first = branch.info.settings["legs"][0][0]
    state, own = np.zeros(problem.states), list(problem.system.states_of(first))
    state[own] = guess[: len(own)]
    return problem_of(problem.system, branch.info, state, problem.discretization)  # type: ignore[return-value]

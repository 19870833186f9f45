"""States and tangents of an orbit at any time, to cut it into other segments or to begin it elsewhere."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contwalk import flow
from contwalk.errors import NotFinite
from contwalk.problems.orbit.motion import PLAIN, TANGENT

if TYPE_CHECKING:
    from contwalk.problems.orbit.periodic_orbit import PeriodicOrbit

# Growth over one segment that shooting still takes easily: four digits of sixteen.
MOST_GROWTH = 1e4
PARTS = 16
MOST_SEGMENTS = 24


def carried_to(
    problem: PeriodicOrbit, z: np.ndarray, tangent: np.ndarray, time: float
) -> tuple[np.ndarray, np.ndarray]:
    """State and tangent of the orbit at a time in 0..1 of the closure, each of shape (n,)."""
    n, m = problem.states, problem.segments
    segment = min(int(time * m), m - 1)
    begin = segment / m
    x, v = problem.starts(z)[segment], tangent[segment * n : (segment + 1) * n]
    if time - begin < 1e-12:
        return x.copy(), v.copy()
    field = problem.motion.field(TANGENT)
    values = np.concatenate([problem.scalars(z), problem.fixed, tangent[m * n :]])
    size = max(float(np.linalg.norm(v / problem.mesh.variation)), 1e-12)
    weights = np.concatenate([problem.mesh.variation, size * problem.mesh.variation])
    c, y = field.constants(values), np.concatenate([x, v])
    mesh = problem.mesh
    path = flow.adaptive(field, c, begin, y, time, mesh.tolerance, weights, mesh.method)
    if path.status != "ok":
        raise NotFinite("The motion along the orbit is not finite.", "Start elsewhere.")
    return path.states[-1, :n], path.states[-1, n:]


def growth(problem: PeriodicOrbit, z: np.ndarray) -> float:
    """The largest factor by which a small deviation grows over any part of the closure, in the metric."""
    n, m = problem.states, problem.segments
    field = problem.motion.field(PLAIN)
    c = field.constants(np.concatenate([problem.scalars(z), problem.fixed]))
    sources, variation = np.full(n, -1), problem.mesh.variation
    factors = []
    for steps, start in zip(problem.mesh.steps, problem.starts(z), strict=True):
        x = start
        cuts = np.unique(np.linspace(0, len(steps) - 1, max(PARTS // m, 1) + 1).astype(int))
        for low, high in zip(cuts[:-1], cuts[1:], strict=True):
            part = steps[low : high + 1]
            x, moved = flow.tangents(field, c, part, x, np.eye(n), sources, problem.mesh.method)
            factors.append(moved / variation[:, None] * variation)
    largest = 1.0
    for i in range(len(factors)):
        product = np.eye(n)
        for factor in factors[i:]:
            product = factor @ product
            largest = max(largest, float(np.linalg.norm(product, 2)))
    return largest


def segments_for(problem: PeriodicOrbit, z: np.ndarray) -> int:
    """Number of segments over each of which deviations grow by `MOST_GROWTH` at most."""
    if problem.discretization.segments is not None:
        return problem.discretization.segments
    largest = growth(problem, z)
    if not np.isfinite(largest):
        return MOST_SEGMENTS
    return int(np.clip(np.ceil(np.log(largest) / np.log(MOST_GROWTH)), 1, MOST_SEGMENTS))

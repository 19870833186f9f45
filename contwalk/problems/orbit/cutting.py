"""When an orbit is cut into other segments, and where.

Segments of equal duration are halved. Where times of cuts are chosen, a segment ends where deviations have
grown by a given factor since any time in it: along a canard, or beside a saddle, segments crowd where the
flow grows, and where it contracts one is enough (multiple shooting: U. M. Ascher, R. M. M. Mattheij, R. D.
Russell, "Numerical Solution of Boundary Value Problems for Ordinary Differential Equations", SIAM 1995).
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from contwalk import flow
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.problems.orbit.segmented_orbit import SegmentedOrbit
from contwalk.problems.orbit.stretching import stretched
from contwalk.problems.orbit.transport import segments_for

# Growth over a segment that is cut by it.
GROWN = 1e3
# Segments that a branch has room for, and unknowns with them.
MOST_CUTS, MOST_UNKNOWNS = 64, 400
# More than that, and it is cut anew; so many times more segments than growth asks for are too many.
TOO_GROWN, TOO_MANY = 3e4, 2.0
# Parts of the closure by which cuts are apart at least.
APART = 1e-9


def most_segments(orbit: SegmentedOrbit, room: int) -> int:
    """Segments that an orbit may be cut into along its branch; `room` if they are of equal duration."""
    if not orbit.uneven:
        return max(room, 2 * orbit.mesh.segments)
    return max(room, orbit.mesh.segments, min(MOST_CUTS, MOST_UNKNOWNS // (orbit.states + 1)))


def recutting(orbit: SegmentedOrbit, z: np.ndarray, room: int) -> np.ndarray | None:
    """Times at which the segments of an orbit are to start instead, shape (m,); None where they are well."""
    m = orbit.mesh.segments
    if not orbit.uneven:
        return np.arange(2 * m) / (2 * m) if 2 * m <= max(room, m) and stretched(orbit, z) else None
    times, factors = _steps(orbit, z, 0.0)
    most = most_segments(orbit, room)
    grown = _most_grown(times, factors, orbit.mesh.cuts)
    found = _cuts(times, factors, orbit.parts, most)
    fewer = m > TOO_MANY * len(found)
    return found if fewer or (grown > TOO_GROWN and len(found) > m) else None


def begun_at(orbit: SegmentedOrbit, z: np.ndarray, room: int, begin: float) -> np.ndarray:
    """Times at which segments start, shape (m,), of the same orbit that begins later."""
    return cuts_for(orbit, z, most_segments(orbit, room), begin) if orbit.uneven else orbit.mesh.cuts


def first_cuts(orbit: SegmentedOrbit, z: np.ndarray) -> np.ndarray:
    """Times at which the segments of an orbit are to start that is one segment yet, shape (m,)."""
    if orbit.uneven and orbit.discretization.segments is None:
        return cuts_for(orbit, z, most_segments(orbit, 1))
    m = segments_for(orbit, z)
    return np.arange(m) / m


def cuts_for(orbit: SegmentedOrbit, z: np.ndarray, most: int, begin: float = 0.0) -> np.ndarray:
    """Times at which segments start over which deviations grow by no more than `GROWN`, shape (m,).

    They are alike in the parts of the closure in which steps are. Where that makes more segments than `most`,
    deviations may grow by more in each.

    Parameters
    ----------
    begin : float
        Where the closure begins; times count from there.
    """
    return _cuts(*_steps(orbit, z, begin), orbit.parts, most)


def _cuts(times: np.ndarray, factors: np.ndarray, parts: int, most: int) -> np.ndarray:
    """As `cuts_for`, of steps that end at some times, with their derivatives."""
    allowed = float(np.log(GROWN))
    while True:
        cuts = _alike(_greedy(times, factors, allowed), parts)
        if len(cuts) <= most or allowed > 600.0:
            return cuts
        allowed *= 1.3


def _most_grown(times: np.ndarray, factors: np.ndarray, cuts: np.ndarray) -> float:
    """By how much deviations grow at most within a segment, from any time in it on."""
    n, largest = factors.shape[1], 1.0
    begins = np.append(0.0, times[:-1])
    for first, last in pairwise(np.append(np.searchsorted(begins, cuts - APART), len(times))):
        since = np.zeros((0, n, n))
        for factor in factors[first:last]:
            since = factor @ np.concatenate([since, np.eye(n)[None]])
            largest = max(largest, float(np.linalg.norm(since, axis=(1, 2)).max()))
    return largest


def _steps(orbit: SegmentedOrbit, z: np.ndarray, begin: float) -> tuple[np.ndarray, np.ndarray]:
    """Times at which steps end, counted from `begin`, and the derivative of each in the metric, (s, n, n)."""
    mesh, n, variation = orbit.mesh, orbit.states, orbit.mesh.variation
    nodes = orbit.solution(z).nodes
    own = np.flatnonzero(np.diff(mesh.times) > 0.0)
    pairs = np.column_stack([mesh.times[own], mesh.times[own + 1]]).ravel()
    field = orbit.passage.field(PLAIN)
    c = field.constants(orbit.given(z))
    sources = np.full(n, -1)
    _, moved = flow.along_with_tangents(field, c, pairs, nodes[own], np.eye(n), sources, mesh.method)
    ends = mesh.times[own + 1]
    first = int(np.searchsorted(ends, begin + APART, side="right")) % len(ends)
    scaled = np.roll(moved / variation[:, None] * variation, -first, axis=0)
    counted = np.roll(ends, -first) - begin
    counted[counted <= APART] += 1.0
    return counted, scaled


def _greedy(times: np.ndarray, factors: np.ndarray, allowed: float) -> np.ndarray:
    """Starts of segments, from 0 on: each ends before a deviation from any time in it has grown too much."""
    starts, n = [0.0], factors.shape[1]
    since = np.zeros((0, n, n))
    for k, factor in enumerate(factors):
        since = factor @ np.concatenate([since, np.eye(n)[None]])
        if len(since) > 1 and np.log(np.linalg.norm(since, axis=(1, 2)).max()) > allowed:
            starts.append(float(times[k - 1]))
            since = factor[None]
    return np.array(starts)


def _alike(cuts: np.ndarray, parts: int) -> np.ndarray:
    """The cuts of all parts of the closure, in each of them."""
    if parts == 1 or len(cuts) == 1:
        return cuts
    inner = np.sort(np.concatenate([[0.0], cuts * parts % 1.0])) / parts
    inner = inner[np.append(True, np.diff(inner) > APART)]
    inner = inner[1.0 / parts - inner > APART]
    return np.concatenate([inner + p / parts for p in range(parts)])

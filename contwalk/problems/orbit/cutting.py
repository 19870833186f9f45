"""When an orbit is cut into other segments, and where.

Segments of equal duration are halved. Where times of cuts are chosen, a segment ends where deviations have
grown by a given factor since any time in it: along a canard, or beside a saddle, segments crowd where the
flow grows, and where it contracts one is enough (multiple shooting: U. M. Ascher, R. M. M. Mattheij, R. D.
Russell, "Numerical Solution of Boundary Value Problems for Ordinary Differential Equations", SIAM 1995).
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit, added_by_cuts
from contwalk.problems.orbit.layout import LEAST_CHOSEN
from contwalk.problems.orbit.step_blocks import Steps, blocks, first_of_blocks, steps_of
from contwalk.problems.orbit.stretching import carried, stretched
from contwalk.problems.orbit.transport import STRETCHED, TOO_MUCH, segments_for

# Growth over a segment that is cut by it.
GROWN = 1e2
# Growth over the whole closure below which segments of equal duration do again.
CALM = 1e3
# Steps over which deviations grow by no more than this together are not parted.
RESOLVED = 10.0
# Segments of equal duration that a branch has room for: of a closure in its own time; of legs, and unknowns
# with them, as rows of large machines would be nothing but room.
ROOM, ROOM_OF_LEGS, UNKNOWNS_OF_LEGS = 8, 16, 400
# Segments that a branch has room for, and unknowns with them: all its rows in the database are as long. A
# branch of which nobody expects that it needs them has less.
MOST_CUTS, MOST_UNKNOWNS = 160, 960
FEWER_CUTS, FEWER_UNKNOWNS = 80, 400
# More than that, and it is cut anew; so many times more segments than growth asks for are too many.
TOO_GROWN, TOO_MANY = 1e3, 2.0
# Other cuts are worth it where the growth over each is this part of what it was: the same number may have
# come to lie elsewhere than where the flow grows.
BETTER = 0.1
# Parts of the closure by which cuts are apart at least.
APART = 1e-9


def room(orbit: DiscretizedOrbit) -> int:
    """Into how many segments legs may be cut along a branch. All its rows have one length."""
    if not orbit.cuttable:
        return orbit.cuts
    if orbit.room is not None:
        return max(orbit.room, orbit.cuts)
    if orbit.uneven or (orbit.in_closure and orbit.discretization.evenly_first):
        expected = orbit.discretization.scheme == "collocation"
        cuts, unknowns = (MOST_CUTS, MOST_UNKNOWNS) if expected else (FEWER_CUTS, FEWER_UNKNOWNS)
        return max(ROOM, orbit.cuts, min(cuts, unknowns // (orbit.states + 1)))
    return even_room(orbit)


def even_room(orbit: DiscretizedOrbit) -> int:
    """Into how many segments of equal duration legs may be cut along a branch."""
    if not orbit.cuttable:
        return orbit.cuts
    most, allowed = orbit.cuts, ROOM if orbit.in_closure else ROOM_OF_LEGS
    bare, more = orbit.layout.rest.stop, added_by_cuts(orbit)
    while 2 * most <= allowed and (orbit.in_closure or bare + (2 * most - 1) * more <= UNKNOWNS_OF_LEGS):
        most *= 2
    return most


def halves(orbit: DiscretizedOrbit) -> np.ndarray | None:
    """Times of each leg at which segments start, shape (m,), if they are halved; None where that is too
    many.
    """
    m = 2 * orbit.cuts
    most = even_room(orbit) if orbit.room is None else room(orbit)
    return np.arange(m) / m if m <= most else None


def recutting(orbit: DiscretizedOrbit, z: np.ndarray, most: float = TOO_MUCH) -> np.ndarray | None:
    """Times of each leg at which segments are to start instead, shape (m,); None where they are well.

    `most` is how much deviations may grow over a segment of equal duration. z has the shape (N + 1,).
    """
    m = orbit.cuts
    if not orbit.uneven:
        found = halves(orbit)
        if found is None:
            return _chosen(orbit, z)
        return found if stretched(orbit, z, most) else None
    if m == 1 and not stretched(orbit, z):
        return None
    steps, evenly_first = steps_of(orbit, z), orbit.discretization.evenly_first
    if evenly_first and _calm(steps):
        # As by shooting, which keeps its segments: in one the next growth would not show.
        return np.arange(ROOM) / ROOM
    found = _cuts(steps, room(orbit), LEAST_CHOSEN if evenly_first else 1)
    if m > TOO_MANY * len(found):
        return found
    grown = _most_grown(steps, orbit.mesh.cuts)
    return found if grown > TOO_GROWN and _most_grown(steps, found) < BETTER * grown else None


def _chosen(orbit: DiscretizedOrbit, z: np.ndarray) -> np.ndarray | None:
    """Times of equal growth at which segments are to start that are of equal duration, shape (m,); None
    where they are well.

    What grows on the way and is forgotten before a segment ends, as in the jumps of a relaxation oscillation,
    does Newton's method no harm, and cuts there would have to move with the jumps.
    """
    return grown_cuts(orbit, z) if carried(orbit, z) > STRETCHED else None


def grown_cuts(orbit: DiscretizedOrbit, z: np.ndarray) -> np.ndarray | None:
    """Times of equal growth at which segments may start that are of equal duration, shape (m,); None where
    they may not, or are too few to be told from others in a row.
    """
    if orbit.uneven or not (orbit.in_closure and orbit.discretization.evenly_first):
        return None
    if room(orbit) < LEAST_CHOSEN:
        return None
    found = _cuts(steps_of(orbit, z), room(orbit), LEAST_CHOSEN)
    return found if len(found) >= LEAST_CHOSEN else None


def size_with_room(orbit: DiscretizedOrbit) -> int:
    """Unknowns of an orbit in as many segments as its branch has room for."""
    most = orbit.cut_into(even_room(orbit)).size if orbit.room is None else 0
    m = room(orbit)
    chosen = orbit.discretization.evenly_first and m >= LEAST_CHOSEN
    return max(most, (orbit.cut_at(0.5 * np.arange(m) / m) if chosen else orbit.cut_into(m)).size)


def begun_at(orbit: DiscretizedOrbit, z: np.ndarray, begin: float) -> np.ndarray:
    """Times at which segments start, shape (m,), of the same orbit that begins later."""
    if not orbit.uneven or orbit.mesh.segments == 1:
        return orbit.mesh.cuts
    return cuts_for(orbit, z, room(orbit), begin)


def first_cuts(orbit: DiscretizedOrbit, z: np.ndarray) -> np.ndarray:
    """Times at which the segments of an orbit are to start that is one segment yet, shape (m,)."""
    m = segments_for(orbit, z)
    if m == 1 or not orbit.discretization.uneven or orbit.discretization.segments is not None:
        return np.arange(m) / m
    return cuts_for(orbit, z, room(orbit))


def cuts_for(orbit: DiscretizedOrbit, z: np.ndarray, most: int, begin: float = 0.0) -> np.ndarray:
    """Times at which segments start over which deviations grow by no more than `GROWN`, shape (m,).

    Where that makes more segments than `most`, deviations may grow by more in each. Parts of the closure in
    which steps are alike are cut each by itself: but for rounding, what is solved does not depend on cuts.

    Parameters
    ----------
    begin : float
        Where the closure begins; times count from there.
    """
    steps = steps_of(orbit, z)
    first = int(np.argmin(np.abs(steps.begins - begin)))  # as `Mesh.begun` has it
    later, begin = steps.begun(first), float(steps.begins[first])
    least = LEAST_CHOSEN if orbit.discretization.evenly_first else 1
    return _cuts(replace(later, begins=later.begins - begin), most, least)


def _cuts(steps: Steps, most: int, least: int = 1) -> np.ndarray:
    """As `cuts_for`, of steps in their order, into so many segments at least."""
    begins, factors = _blocked(steps)
    allowed = float(np.log(GROWN))
    while True:
        cuts = _greedy(begins, factors, allowed)
        if len(cuts) <= most or allowed > 600.0:
            return _more(steps, cuts, least) if len(cuts) < least else cuts
        allowed *= 1.3


def _calm(steps: Steps) -> bool:
    """Whether deviations grow by no more than `CALM` over the whole closure, from any time in it on."""
    return len(_greedy(*_blocked(steps), float(np.log(CALM)))) == 1


def _blocked(steps: Steps) -> tuple[np.ndarray, np.ndarray]:
    """When blocks of steps that are not parted begin, (w,), and their factors, (w, n, n)."""
    firsts = first_of_blocks(steps.factors, RESOLVED, np.inf)
    return steps.begins[firsts], blocks(steps.factors, firsts)


def _more(steps: Steps, cuts: np.ndarray, least: int) -> np.ndarray:
    """So many cuts at least, (m,), if there are as many steps: the segment of most steps is cut in halves."""
    starts = np.searchsorted(steps.begins, cuts - APART).tolist()
    while len(starts) < min(least, len(steps.begins)):
        counts = np.diff([*starts, len(steps.begins)])
        longest = int(np.argmax(counts))
        starts.insert(longest + 1, starts[longest] + int(counts[longest]) // 2)
    return steps.begins[starts]


def _most_grown(steps: Steps, cuts: np.ndarray) -> float:
    """By how much deviations grow at most within a segment, from any time in it on."""
    n, largest, count = steps.factors.shape[1], 1.0, len(steps.begins)
    for first, last in pairwise(np.append(np.searchsorted(steps.begins, cuts - APART), count)):
        own = steps.factors[first:last]
        since = np.zeros((0, n, n))
        for factor in blocks(own, first_of_blocks(own, RESOLVED, np.inf)):
            since = factor @ np.concatenate([since, np.eye(n)[None]])
            largest = max(largest, _size(since))
    return largest


def _greedy(begins: np.ndarray, factors: np.ndarray, allowed: float) -> np.ndarray:
    """Starts of segments, from 0 on: each ends before a deviation from any time in it has grown too much."""
    starts, n = [0.0], factors.shape[1]
    since = np.zeros((0, n, n))
    for begin, factor in zip(begins, factors, strict=True):
        since = factor @ np.concatenate([since, np.eye(n)[None]])
        if len(since) > 1 and np.log(_size(since)) > allowed:
            starts.append(float(begin))
            since = factor[None]
    return np.array(starts)


def _size(products: np.ndarray) -> float:
    """The largest norm of some matrices (w, n, n)."""
    return float(np.sqrt(np.einsum("wij,wij->w", products, products).max()))

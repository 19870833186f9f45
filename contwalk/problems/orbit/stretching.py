"""Whether the segments of an orbit are too long for what is computed over them.

Where deviations grow by 1e12 over a leg, as along a canard or beside a saddle, no start tells its end, and
Newton's method has nothing to correct. Over a segment they grow by a root of that (multiple shooting: U. M.
Ascher, R. M. M. Mattheij, R. D. Russell, "Numerical Solution of Boundary Value Problems for Ordinary
Differential Equations", SIAM 1995, chapter 4).
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from contwalk import flow
from contwalk.numerics.distinct import distinct
from contwalk.problems.orbit import monodromy
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.problems.orbit.piece import Piece
from contwalk.problems.orbit.transport import STRETCHED, TOO_MUCH

# What the flow may miss its own velocity by before an orbit is cut into twice as many segments.
MISSED = 1e-3
# A segment over which a deviation that begins with it grows by less lets none grow; parts that are looked at.
GROWING, PARTS = 30.0, 16


def stretched(orbit: DiscretizedOrbit, z: np.ndarray, most: float = TOO_MUCH) -> bool:
    """Whether a segment is too long for Newton's method to be at ease, or to tell multipliers.

    `most` is how much deviations may grow over a segment of a closure. Where a state moves by far less on a
    leg than on the orbit, as on a stiff contact, its deviations may grow in units of the orbit at once:
    shorter segments do not change that, and units of the leg tell.

    z has the shape (N + 1,).
    """
    if orbit.in_closure:
        if orbit.mesh.growth > most or carried(orbit, z) > STRETCHED:
            return True
        return monodromy.trivial_error(orbit, z, orbit.linearize(z).jacobian) > MISSED
    if carried(orbit, z) <= STRETCHED and grown(orbit, z) <= TOO_MUCH:
        return False
    return _most_on_the_way(orbit, z, own=True) > STRETCHED


def grown(orbit: DiscretizedOrbit, z: np.ndarray) -> float:
    """By how much deviations grow at most over a segment, from any time on.

    A deviation that began with the segment has decayed onto the motion where this attracts, and does not show
    how others grow that begin there: where any grows, these are asked too.
    """
    found = orbit.mesh.growth
    if found < GROWING or found > TOO_MUCH:
        return found
    return max(found, _most_on_the_way(orbit, z))


def _most_on_the_way(orbit: DiscretizedOrbit, z: np.ndarray, own: bool = False) -> float:
    """By how much deviations grow at most from any time of a segment to its end.

    In units of the states' variation on the orbit, or, where asked for, on the segment's own leg.
    """
    found, views = 0.0, orbit.view(z) if own else ()
    for segment, piece in zip(orbit.layout.segments, orbit.segments, strict=True):
        scale = orbit.mesh.variation[list(piece.passage.states)]
        if own:
            moves = np.ptp(views[segment.leg].nodes, axis=0)
            scale = np.where(moves > 0.0, moves, scale)
        until = np.eye(len(scale))
        for factor in reversed(_factors(piece, orbit.layout.inputs_of(segment, z), scale)):
            until = until @ factor
            found = max(found, float(np.linalg.norm(until, 2)))
    return found


def _factors(piece: Piece, inputs: tuple[np.ndarray, np.ndarray], scale: np.ndarray) -> list[np.ndarray]:
    """Derivatives of the motion over parts of a segment, in units of the states."""
    x, scalars = inputs
    field, n = piece.passage.field(PLAIN), len(x)
    c = field.constants(piece.values(scalars))
    cuts = distinct(np.linspace(0, len(piece.steps) - 1, PARTS + 1).astype(int))
    found = []
    for low, high in pairwise(cuts.tolist()):
        x, moved = flow.tangents(
            field, c, piece.steps[low : high + 1], x, np.eye(n), np.full(n, -1), piece.method
        )
        found.append(moved / scale[:, None] * scale)
    return found


def carried(orbit: DiscretizedOrbit, z: np.ndarray) -> float:
    """By how much deviations grow at most from the start of a segment to its end, events included."""
    largest, jacobian, variation = 0.0, orbit.linearize(z).jacobian, orbit.mesh.variation
    for segment in orbit.layout.segments:
        passage = orbit.passages[segment.leg]
        to = passage.following if segment.last else passage.states
        matrix = jacobian[segment.ends, segment.states]
        if segment.states == segment.following:
            matrix = matrix + np.eye(len(matrix))
        scaled = matrix / variation[list(to)][:, None] * variation[list(passage.states)]
        largest = max(largest, float(np.linalg.norm(scaled)))
    return largest

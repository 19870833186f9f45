"""Legs cut into segments: when, how many there is room for, and the same orbit on more of them.

Where deviations grow by 1e12 over a leg, as along a canard or beside a saddle, no start tells its end, and
Newton's method has nothing to correct. Over a segment they grow by a root of that (multiple shooting: U. M.
Ascher, R. M. M. Mattheij, R. D. Russell, "Numerical Solution of Boundary Value Problems for Ordinary
Differential Equations", SIAM 1995, chapter 4). The rule is that of orbits without events.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from contwalk import flow
from contwalk.errors import NotFinite
from contwalk.numerics.distinct import distinct
from contwalk.problems.hybrid.limited_orbit import Kind, LimitedOrbit
from contwalk.problems.orbit.discretized_orbit import added_by_cuts
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.problems.orbit.piece import Piece
from contwalk.problems.orbit.transport import STRETCHED, TOO_MUCH, closed, segments_of_growth
from contwalk.problems.problem import Sample

# Segments of a leg that a branch has room for, if it does not begin with more, and how many unknowns with
# them: rows of a branch have one length, and those of large machines would be nothing but room.
ROOM, MOST_UNKNOWNS = 16, 400
# A segment over which a deviation that begins with it grows by less lets none grow; parts that are looked at.
GROWING, PARTS = 30.0, 16
# More growth than any number of segments takes.
MOST_GROWTH = 1e300


def room(problem: LimitedOrbit) -> int:
    """Into how many segments legs may be cut along a branch: so many times two what they are cut into."""
    if not problem.cuttable:
        return problem.cuts
    if problem.room is not None:
        return max(problem.room, problem.cuts)
    bare, more = problem.layout.rest.stop, added_by_cuts(problem)
    most = problem.cuts
    while 2 * most <= ROOM and bare + (2 * most - 1) * more <= MOST_UNKNOWNS:
        most *= 2
    return most


def stretched(problem: LimitedOrbit, z: np.ndarray) -> bool:
    """Whether a segment is too long for Newton's method to be at ease.

    Where a state moves by far less on a leg than on the orbit, as on a stiff contact, its deviations may grow
    in units of the orbit at once: shorter segments do not change that, and units of the leg tell.

    z has the shape (N + 1,).
    """
    if _carried(problem, z) <= STRETCHED and _grown(problem, z) <= TOO_MUCH:
        return False
    return _most_on_the_way(problem, z, own=True) > STRETCHED


def _grown(problem: LimitedOrbit, z: np.ndarray) -> float:
    """By how much deviations grow at most over a segment, from any time on.

    A deviation that began with the segment has decayed onto the motion where this attracts, and does not show
    how others grow that begin there: where any grows, these are asked too.
    """
    grown = max(problem.mesh.grown, default=0.0)
    if grown < GROWING or grown > TOO_MUCH:
        return grown
    return max(grown, _most_on_the_way(problem, z))


def _most_on_the_way(problem: LimitedOrbit, z: np.ndarray, own: bool = False) -> float:
    """By how much deviations grow at most from any time of a segment to its end.

    In units of the states' variation on the orbit, or, where asked for, on the segment's own leg.
    """
    grown, views = 0.0, problem.view(z) if own else ()
    for segment, piece in zip(problem.layout.segments, problem.segments, strict=True):
        scale = problem.mesh.variation[list(piece.passage.states)]
        if own:
            moves = np.ptp(views[segment.leg].nodes, axis=0)
            scale = np.where(moves > 0.0, moves, scale)
        until = np.eye(len(scale))
        for factor in reversed(_factors(piece, *problem.layout.inputs_of(segment, z), scale)):
            until = until @ factor
            grown = max(grown, float(np.linalg.norm(until, 2)))
    return grown


def _factors(piece: Piece, x: np.ndarray, scalars: np.ndarray, scale: np.ndarray) -> list[np.ndarray]:
    """Derivatives of the motion over parts of a segment, in units of the states."""
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


def _carried(problem: LimitedOrbit, z: np.ndarray) -> float:
    """By how much deviations grow at most from the start of a segment to its end, events included."""
    largest, jacobian, variation = 0.0, problem.linearize(z).jacobian, problem.mesh.variation
    for segment in problem.layout.segments:
        passage = problem.passages[segment.leg]
        to = passage.following if segment.last else passage.states
        matrix = jacobian[segment.ends, segment.states]
        if segment.states == segment.following:
            matrix = matrix + np.eye(len(matrix))
        grown = matrix / variation[list(to)][:, None] * variation[list(passage.states)]
        largest = max(largest, float(np.linalg.norm(grown)))
    return largest


def begun(problem: Kind, z: np.ndarray) -> tuple[Kind, np.ndarray]:
    """A first orbit cut into as many segments as the run file asks for, or the growth of deviations does.

    z has the shape (N + 1,) of its problem, before and after.
    """
    if not problem.cuttable:
        return problem, z
    cuts = problem.discretization.segments
    if cuts is None:
        if not stretched(problem, z):
            return problem, z
        most = max(_grown(problem, z), _carried(problem, z))
        cuts = min(segments_of_growth(float(np.log(min(most, MOST_GROWTH)))), room(problem))
    if cuts <= problem.cuts:
        return problem, z
    there = filled(problem, problem.bare(z), cuts, problem, z)
    finer = problem.cut_into(cuts)
    return finer.adapted_to(there, finer.weighted(problem.mesh.magnitudes)), there


def filled(
    problem: LimitedOrbit, bare: np.ndarray, cuts: int, source: LimitedOrbit, z: np.ndarray
) -> np.ndarray:
    """Unknowns with so many segments in each leg, their starts taken from the motion of the same legs.

    Parameters
    ----------
    problem : LimitedOrbit
    bare : ndarray
        Unknowns with one segment in each leg.
    cuts : int
    source, z : LimitedOrbit, ndarray
        Whose legs begin with those of `problem`, in their order.
    """
    layout = problem.cut_into(cuts).layout
    result = np.concatenate([bare[:-1], np.zeros(layout.size + 1 - len(bare)), bare[-1:]])
    for view, own in zip(source.view(z), range(layout.legs), strict=False):
        segments = layout.segments_of(own)[1:]
        if segments:
            states = view.at(np.array([segment.begin for segment in segments]))
            for segment, x in zip(segments, states, strict=True):
                result[segment.states] = x
    return result


def copied(
    problem: LimitedOrbit, bare: np.ndarray, start: float, source: LimitedOrbit, z: np.ndarray
) -> np.ndarray:
    """Unknowns of an orbit of other legs along the motion of `source`, from `start` on, in as many segments.

    Those with one segment in each leg where the motion goes on beyond the closure, as its image or with its
    angles turned.
    """
    finer = problem.cut_into(source.cuts if problem.cuttable else 1)
    times, layout = source.starting_times(z), finer.layout
    result = np.concatenate([bare[:-1], np.zeros(layout.size + 1 - len(bare)), bare[-1:]])
    begins = start + np.concatenate([[0.0], np.cumsum(bare[layout.durations])])
    goes_on = source.itinerary.image or np.any(source.turns)
    for segment in layout.segments:
        if segment.begin == 0.0:
            continue
        at = begins[segment.leg] + segment.begin * bare[layout.durations][segment.leg]
        if not times[0] <= at <= times[-1]:
            if goes_on:
                return bare
            at = times[0] + (at - times[0]) % (times[-1] - times[0])
        k = int(np.clip(np.searchsorted(times, at, "right") - 1, 0, source.layout.legs - 1))
        view = source.view(z)[k]
        share = (at - times[k]) / view.duration if view.duration > 0.0 else 0.0
        x = view.full(view.at(np.array([share]))[0])
        result[segment.states] = x[list(finer.passages[segment.leg].states)]
    return result


def blocks(problem: LimitedOrbit, vector: np.ndarray) -> list[np.ndarray]:
    """Of unknowns, or of a direction of them, each leg's states at the starts of its inner segments.

    The vector has the shape (N + 1,), each array (cuts - 1, n_i).
    """
    return [
        np.array([vector[place] for place in own]).reshape(len(own), n)
        for own, n in zip(problem.layout.inner, problem.layout.sizes, strict=True)
    ]


def completed(bare: np.ndarray, inner: Sequence[np.ndarray]) -> np.ndarray:
    """Unknowns from those of whole legs, the parameter last, and each leg's inner states.

    Each block of inner states has the shape (cuts - 1, n_i).
    """
    return np.concatenate([bare[:-1], *(block.ravel() for block in inner), bare[-1:]])


def recut(problem: Kind, sample: Sample) -> tuple[Kind, Sample] | None:
    """The same solution on twice as many segments, corrected there; None where that does not converge.

    Nor at a branch point, where the equations tell neither the place nor the way.
    """
    if sample.orientation == 0.0:
        return None
    cuts, z = 2 * problem.cuts, sample.z
    there = filled(problem, problem.bare(z), cuts, problem, z)
    finer = problem.cut_into(cuts)
    # Each state's share of the metric stays what it is: the squares of all segments add up.
    share = np.sqrt(len(finer.layout.segments) / len(problem.layout.segments))
    magnitudes = problem.magnitudes_of(sample.weights)
    weights = finer.weighted(magnitudes)
    own, rest = problem.layout.rest.stop, problem.layout.durations.start
    for i, place in enumerate(problem.layout.states):
        for segment in finer.layout.segments_of(i):
            weights[segment.states] = share * sample.weights[place]
    weights[rest:own], weights[-1] = sample.weights[rest:own], sample.weights[-1]
    along = np.zeros(len(there))
    along[:own], along[-1] = sample.tangent[:own], sample.tangent[-1]
    along = along / weights**2
    try:
        finer = finer.adapted_to(there, weights)
        found = finer.linearize(there)
        tangent = found.tangent(along, weights)
        rough = finer.examine(there, tangent, weights, found, sample.unstable)
        done = closed(finer, replace(rough, iterations=sample.iterations))
    except (NotFinite, np.linalg.LinAlgError):
        return None
    return done

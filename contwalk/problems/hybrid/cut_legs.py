"""Legs that are cut into segments: the starts of these, and orbits begun, copied and joined with them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contwalk.problems.hybrid.limited_orbit import Kind, LimitedOrbit
from contwalk.problems.orbit.cutting import room
from contwalk.problems.orbit.stretching import carried, grown, stretched
from contwalk.problems.orbit.transport import segments_of_growth

# More growth than any number of segments takes.
MOST_GROWTH = 1e300


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
        most = max(grown(problem, z), carried(problem, z))
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
    bare : ndarray, shape (M + 1,)
        Unknowns with one segment in each leg.
    cuts : int
    source, z : LimitedOrbit, ndarray of shape (N + 1,)
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

    z has the shape (N + 1,), `bare` (M + 1,).
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

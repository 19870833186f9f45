"""What limits ask of an orbit: values that are zero where one passes zero, with all their derivatives."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.limits import transition_of
from contwalk.problems.hybrid.margin_values import at_entry
from contwalk.problems.hybrid.margins import Limit
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.problems.orbit.piece import Piece
from contwalk.problems.orbit.watched_numbers import Watched

# An instant that lies beyond this part of a segment is looked at from its start.
AFTER = 0.1

# Values with derivatives of a segment cut to an instant: of it, its state there, the derivatives of that, and
# what its functions depend on.
Measured = Callable[[Piece, np.ndarray, np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


def rows_of(
    problem: LimitedOrbit, limit: Limit, y: np.ndarray, share: float
) -> tuple[np.ndarray, np.ndarray]:
    """Residuals of a limit's equations, shape (k,), and their derivatives by all unknowns, (k, len(y)).

    y are the unknowns of the orbit; of a guard that touches zero, followed by the instant, which lies near a
    `share` of the leg.
    """
    i, size, layout = limit.leg, problem.size, problem.layout
    if limit.test == "duration":
        row = np.zeros((1, len(y)))
        row[0, layout.durations.start + i] = 1.0
        return y[layout.durations.start + i, None], row
    z, piece = y[: size + 1], problem.pieces[i]
    x, scalars = layout.inputs(i, z)
    if limit.test == "condition":
        map_ = piece.passage.condition(next(c for c in problem.system.conditions if c.name == limit.name))
        piece, x, scalars = _ending(problem, i, z)
        end, moved = piece.before_differentiated(PLAIN, x, scalars)
        values, derivative = piece.through_map(map_, end, moved, piece.values(scalars))
        return values, layout.along(layout.segments_of(i)[-1], derivative)
    transition = transition_of(problem, limit)
    if limit.test == "leaving":
        map_ = piece.passage.guard_derivative(transition, 2)
        c = map_.constants(piece.values(scalars))
        value, derivative = map_.linearized(0.0, x, c)
        return value, layout.spread(i, derivative)
    watched = piece.passage.watched(transition.name, transition.guard)
    if limit.test in ("start", "past"):
        there, slopes = at_entry(piece, transition, x, scalars)
        return np.array([there]), layout.spread(i, slopes[None])
    if limit.test == "dip":
        return _touching(problem, i, y, share, partial(_value_and_rate, watched))
    piece, x, scalars = _ending(problem, i, z)
    end, moved = piece.before_differentiated(PLAIN, x, scalars)
    values, derivative = watched.differentiated(1.0, end, moved, piece.values(scalars))
    k = 1 if limit.test == "rate" else 0
    return values[k : k + 1], layout.along(layout.segments_of(i)[-1], derivative[k : k + 1])


def _ending(problem: LimitedOrbit, i: int, z: np.ndarray) -> tuple[Piece, np.ndarray, np.ndarray]:
    """The last segment of leg i, with its state and scalars."""
    layout = problem.layout
    last = sum(layout.cuts[: i + 1]) - 1
    return problem.segments[last], *layout.inputs_of(layout.segments[last], z)


def _touching(
    problem: LimitedOrbit, i: int, y: np.ndarray, share: float, measured: Measured
) -> tuple[np.ndarray, np.ndarray]:
    """What is measured at the last unknown, an instant of leg i near a share of it, with derivatives.

    The motion is that of the segment in which it lies, from its start up to there.
    """
    layout, size = problem.layout, problem.size
    first = sum(layout.cuts[:i])
    # One at the very start of a segment is looked at from the one before: motions of no time tell no rate.
    within = [
        k for k, own in enumerate(layout.segments_of(i)) if own.begin < share - AFTER * (own.end - own.begin)
    ]
    number = first + max(within, default=0)
    segment, piece = layout.segments[number], problem.segments[number]
    x, scalars = layout.inputs_of(segment, y[: size + 1])
    n, lasting = len(x), float(y[layout.durations.start + i])
    share = (share - segment.begin) / (segment.end - segment.begin)
    inside = piece.steps[1:][piece.steps[1:] < share - 1e-12] / max(share, 1e-12)
    piece = Piece(piece.passage, np.concatenate([[0.0], inside, [1.0]]), piece.method, piece.fixed)
    since = y[-1] - segment.begin * lasting if number > first else y[-1]
    scalars = np.concatenate([[since], scalars[1:]])
    end, moved = piece.before_differentiated(PLAIN, x, scalars)
    values, derivative = measured(piece, end, moved, piece.values(scalars))
    by_time = derivative[:, n].copy()
    derivative[:, n] = 0.0
    rows = layout.along(segment, derivative)
    if number > first:  # a longer leg lets its segment begin later
        rows[:, layout.durations.start + i] -= segment.begin * by_time
    return values, np.hstack([rows, by_time[:, None]])


def second_rate(
    problem: LimitedOrbit, limit: Limit, y: np.ndarray, share: float
) -> tuple[np.ndarray, np.ndarray]:
    """A guard's second derivative over the leg's own time where it touches zero, or arrives with no rate.

    Shape (1,), with its derivatives by all unknowns, (1, len(y)); see `rows_of`.

    Raises
    ------
    UnsupportedOperation
        If its graph is too large to be differentiated twice.
    """
    map_ = problem.pieces[limit.leg].passage.guard_derivative(transition_of(problem, limit), 2)
    if limit.test == "dip":
        return _touching(problem, limit.leg, y, share, lambda piece, *at: piece.through_map(map_, *at))
    piece, x, scalars = _ending(problem, limit.leg, y[: problem.size + 1])
    end, moved = piece.before_differentiated(PLAIN, x, scalars)
    values, derivative = piece.through_map(map_, end, moved, piece.values(scalars))
    return values, problem.layout.along(problem.layout.segments_of(limit.leg)[-1], derivative)


def _value_and_rate(
    watched: Watched, piece: Piece, x: np.ndarray, moved: np.ndarray, values: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    return watched.differentiated(1.0, x, moved, values)


def growth(problem: LimitedOrbit, z: np.ndarray, limit: Limit, direction: np.ndarray) -> float:
    """How fast along a direction a leg's duration grows, or its guard goes past zero where it begins."""
    row = float(rows_of(problem, limit, z, 0.0)[1][0] @ direction)
    if limit.test == "duration":
        return row
    return row if transition_of(problem, limit).direction == "rising" else -row

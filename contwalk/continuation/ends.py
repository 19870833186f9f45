"""Ends of a branch within reach of a step, and walks that get nowhere.

An end lies on the step, or beside it where it failed. Beside a special point at which a curve ends the
equations are singular and Newton's method contracts on ever shorter steps only; the point itself is known
well, and beyond it the curve is its own mirror image.

A walk gets nowhere over rounding: where the error of solutions is larger than what lies between them, as
along canards of large growth, tests change their signs for no reason.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable

import numpy as np

from contwalk.branch import Outcome
from contwalk.continuation import outcomes
from contwalk.continuation.locating import Found
from contwalk.continuation.marks import Observer, marked
from contwalk.continuation.segment import LostBranch, Segment
from contwalk.continuation.settings import Settings
from contwalk.errors import ContwalkError
from contwalk.numerics.bracketing import zero_of
from contwalk.numerics.linear import norm_in
from contwalk.problems.problem import Located, PointType, Problem, Sample, equations_at

# The point lies no farther ahead than so many times the step that failed, or that is to follow.
AHEAD = 4.0
# The cosine of the way there with the tangent, at least: curves that pass beside the point are others.
ALONG = 0.99
# What is left of a step before the end, in parts of it: less is the end itself.
LEAST = 1e-9
# An edge this near, in magnitudes of the parameter, is reached: along roots of the way to it solutions would
# pile up before it, a step each.
REACHED = 1e-12
# So many special points in a row tell that are not located.
IN_A_ROW = 10
# So many points in a row tell where the way along all of them is this part of the longest step, or less:
# twice as many as lead across a resonance of 1e6, whose errors are large beside its steps.
CREEPING, SHORT = 300, 1e-3


def end_ahead(
    problem: Problem, a: Sample, length: float, settings: Settings, observer: Observer
) -> tuple[Segment, Found] | None:
    """The piece of a curve from `a` to the point at which it ends, a few steps of a length away at most.

    None where there is no such point, or where something else lies before it: an eigenvalue that crosses, or
    a mark.
    """
    for kind in problem.point_types:
        try:
            ahead = kind.ends_ahead(problem, a)
            found = None if ahead is None else _leads_to(problem, kind, *ahead, a, length)
        except (*outcomes.BREAKDOWNS, LostBranch):
            continue
        if found is not None:
            return None if marked(found[0], settings.sought, observer, [1.0]) else found
    return None


def _leads_to(
    problem: Problem, kind: PointType, located: Located, end: Outcome, a: Sample, length: float
) -> tuple[Segment, Found] | None:
    """The piece of a curve up to a point of a kind at which it ends, if it leads there."""
    way = located.z - a.z
    far = norm_in(way, a.weights)
    if not 0.0 < far < AHEAD * length or a.tangent @ (way / a.weights**2) < ALONG * far:
        return None
    there = problem.examine(located.z, way / far, a.weights, problem.linearize(located.z), a.unstable)
    if there.unstable != a.unstable:
        return None
    known = float(located.error / a.weights[-1])
    there = there.varied(orientation=a.orientation, error=known if np.isfinite(known) else a.error)
    found = Found(1.0, kind, located, there, a.unstable, a.unstable, counted=True, end=end)
    return Segment(problem, a, there), found


def up_to_end(segment: Segment) -> Segment | None:
    """The part of a segment before the first place at which a branch ends on it.

    None where it ends right at the beginning, or nobody knows where.
    """
    first, last = (segment.problem.diagnosis.end_functions(there) for there in (segment.a, segment.b))
    passed = [which for which in range(len(first)) if first[which] < 0.0 < last[which]]
    found = [theta for which in passed if (theta := _zero(segment, which)) is not None]
    theta = min(found, default=0.0)
    return segment.between(0.0, theta) if theta > LEAST else None


def _zero(segment: Segment, which: int) -> float | None:
    """Where on a segment an end function passes zero."""
    return zero_of(lambda t: segment.problem.diagnosis.end_functions(segment.at(t))[which], 0.0, 1.0)


def edge_reached(problem: Problem, sample: Sample) -> bool:
    """Whether the equations have no value right ahead of a solution, where only the parameter changes."""
    z = sample.z.copy()
    z[-1] += np.copysign(REACHED * sample.weights[-1], sample.tangent[-1])
    try:
        with np.errstate(all="ignore"):
            return not equations_at(problem, z)[1].finite
    except ContwalkError:
        return True


class Crowd:
    """The last special points of a walk that were not located, none of another kind between them, and its
    last points.

    Parameters
    ----------
    known : iterable of (bool, float, float)
        What special points have told already, as `tell` is told.
    points : iterable of (float, float)
        What points have told already, as `pass_by` is told.
    """

    def __init__(
        self, known: Iterable[tuple[bool, float, float]] = (), points: Iterable[tuple[float, float]] = ()
    ) -> None:
        self._last: deque[tuple[float, float]] = deque(maxlen=IN_A_ROW)
        self._points: deque[tuple[float, float]] = deque(points, maxlen=CREEPING)
        for each in known:
            self.tell(*each)

    def pass_by(self, s: float, error: float) -> None:
        """A point that is not special, its arclength, and what it is known to, in the metric."""
        self._points.append((s, error))

    def tell(self, located: bool, s: float, error: float) -> None:
        """A special point, its arclength, and what the solution there is known to, in the metric."""
        if located:
            self._last.clear()
        else:
            self._last.append((s, error))

    def noise(self, longest: float) -> tuple[str, float] | None:
        """What lies nearer to each other than solutions are known to, and to what they are, in the metric.

        None where the walk gets on. `longest` is the longest step that is allowed.
        """
        if _way(self._last, IN_A_ROW) < IN_A_ROW * (error := max((e for _, e in self._last), default=0.0)):
            return f"the last {IN_A_ROW} special points were not located, and", error
        way = _way(self._points, CREEPING)
        if not way < SHORT * longest:
            return None
        error = float(np.nan_to_num([e for _, e in self._points]).min())
        return (f"the last {CREEPING} points", error) if way < error else None


def _way(points: deque[tuple[float, float]], count: int) -> float:
    """The way from the first of so many points to the last; infinite where there are fewer."""
    return abs(points[-1][0] - points[0][0]) if len(points) == count else np.inf

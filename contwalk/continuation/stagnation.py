"""Walks that do not get on: over rounding, or along a branch whose parameter stands still.

Where the error of solutions is larger than what lies between them, as along canards of large growth, tests
change their signs for no reason, and the walk may go to and fro for as long as there are points.

An explosion of cycles (a canard), or an orbit that comes near to one of infinite period, changes by as much
as the arclength says while its parameter moves by less than its digits. That the points are used up is true
then, and says nothing.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from contwalk.branch import Outcome

# So many special points in a row tell that are not located.
IN_A_ROW = 10
# So many points in a row tell where the way along all of them is this part of the longest step, or less:
# twice as many as lead across a resonance of 1e6, whose errors are large beside its steps.
CREEPING, SHORT = 300, 1e-3
# So many points tell; the parameter has moved by less than the first of these parts of itself, and the
# period, or a reported state, by more than the second.
POINTS, STILL, CHANGED = 50, 1e-6, 1e-2


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
        if _within(self._last, IN_A_ROW) < IN_A_ROW * (error := max((e for _, e in self._last), default=0.0)):
            return f"the last {IN_A_ROW} special points were not located, and", error
        way = _way(self._points, CREEPING)
        if not way < SHORT * longest:
            return None
        error = float(np.nan_to_num([e for _, e in self._points]).min())
        return (f"the last {CREEPING} points", error) if way < error else None


def _way(points: deque[tuple[float, float]], count: int) -> float:
    """The way from the first of so many points to the last; infinite where there are fewer."""
    return abs(points[-1][0] - points[0][0]) if len(points) == count else np.inf


def _within(points: deque[tuple[float, float]], count: int) -> float:
    """The way along so many points; infinite where there are fewer."""
    places = [s for s, _ in points]
    return max(places) - min(places) if len(places) == count else np.inf


def with_what_stands_still(outcome: Outcome, rows: Sequence[np.ndarray], sign: float, free: str) -> Outcome:
    """The outcome of a direction; where its points are used up and the parameter stands still it says so.

    Parameters
    ----------
    outcome : Outcome
    rows : sequence of ndarray, shape (1,)
        All rows of the branch in the order in which they were walked.
    sign : float
        The direction: towards growing or falling s.
    free : str
        Name of the free parameter.
    """
    own = [row[0] for row in rows if row["s"][0] * sign >= 0.0][-POINTS:]
    if outcome.reason not in ("max_points", "effort") or len(own) < POINTS:
        return outcome
    values, periods = (np.array([row[name] for row in own]) for name in ("free", "period"))
    value, moved = float(values[-1, 0]), float(np.ptp(values[:, 0]))
    if values.shape[1] > 1 or not moved <= STILL * abs(value):
        return outcome
    if _changes(periods):
        what = f"the period goes from {periods[0]:.6g} to {periods[-1]:.6g}"
    elif any(_changes(column) for column in np.array([row["state"] for row in own]).T):
        what = "the states go on changing"
    else:
        return outcome
    like = "an explosion of cycles (a canard) or a limit of infinite period looks"
    if not np.isfinite(periods).any():
        like = "equilibria at one value of a parameter, or one that grows without bound, look"
    return replace(
        outcome,
        message=(
            f"{outcome.message} Over the last {POINTS} points {free} stands still at {value:.10g}, to within "
            f"{moved:.1g}, while {what}: {like} like that, and more points lead along it only slowly. "
            f"End `range` before it, or fix {free} there and continue over another parameter."
        ),
    )


def _changes(values: np.ndarray) -> bool:
    """Whether numbers, of which some may be NaN, change by more than a small part of their size."""
    return bool(np.isfinite(values).all() and np.ptp(values) > CHANGED * np.abs(values).max())

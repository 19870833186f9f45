"""Branches along which the parameter stands still: what is said where their points are used up.

An explosion of cycles changes by as much as the arclength says while its parameter moves by less than its
digits. That the points are used up is true then, and says nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contwalk.branch import Outcome

# So many points tell; the parameter has moved by less than the first of these parts of itself, and the
# period, or a reported state, by more than the second.
POINTS, STILL, CHANGED = 50, 1e-6, 1e-2


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

"""Which part of a branch is stable and admissible: runs of segments that are drawn alike.

A segment joins two consecutive rows. A special row lies on the border of two regimes, where its own count
is decided by rounding, and so does the row at which a branch was born of another one; so each segment takes
its style from its regular end, and a change of style falls exactly on the special point.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contwalk.branch import Branch

# What is told of a row, or of a side of a point: the worse of two is the larger one.
STABLE, UNDECIDED, UNSTABLE = 0, 1, 2
_TOLD = {STABLE: True, UNDECIDED: None, UNSTABLE: False}
# At these labels no eigenvalue crosses: the row's own count holds.
_WITHOUT_CROSSING = ("EP", "UZ")


@dataclass(frozen=True)
class Run:
    """Rows `first` to `last`, both included, whose segments share one style."""

    first: int
    last: int
    stable: bool | None  # None: not known
    admissible: bool

    @property
    def rows(self) -> slice:
        """The rows as a slice."""
        return slice(self.first, self.last + 1)


def runs(branch: Branch) -> list[Run]:
    """The longest runs of segments of one style, in order; a branch of one point is one run."""
    if len(branch) == 0:
        return []
    unstable_row = np.select([branch["stable"] == 1, branch["stable"] == 0], [STABLE, UNSTABLE], UNDECIDED)
    inadmissible_row = ~branch.points["admissible"]
    if len(branch) == 1:
        return [Run(0, 0, _TOLD[int(unstable_row[0])], not inadmissible_row[0])]
    before, after = _sides(branch, unstable_row)
    rounded = branch.points["special"] | at_birth(branch)
    unstable = _of_segments(unstable_row, rounded, before, after)
    inadmissible = _of_segments(
        inadmissible_row, branch.points["special"], inadmissible_row, inadmissible_row
    )
    changes = np.flatnonzero((np.diff(unstable) != 0) | (np.diff(inadmissible) != 0)) + 1
    starts = [0, *changes.tolist()]
    ends = [*changes.tolist(), len(unstable)]
    return [
        Run(a, b, _TOLD[int(unstable[a])], not inadmissible[a]) for a, b in zip(starts, ends, strict=True)
    ]


def admissible_segments(branch: Branch) -> np.ndarray:
    """Whether each segment is admissible, of shape (k - 1,)."""
    flags = np.ones(max(len(branch) - 1, 0), dtype=bool)
    for run in runs(branch):
        flags[run.first : run.last] = run.admissible
    return flags


def at_birth(branch: Branch) -> np.ndarray:
    """Whether each row is the one at which the branch leaves another one, shape (k,)."""
    return np.asarray((branch.points["s"] == 0.0) & (branch.info.parent is not None))


def _sides(branch: Branch, unstable_row: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What the branch is just before and just after each row, in the order of growing `s`."""
    before, after = (np.where(at_birth(branch), STABLE, unstable_row) for _ in range(2))
    seen: set[int] = set()
    for point in sorted(branch.special_points, key=lambda q: q.s):
        row = point.index
        if not 0 <= row < len(branch) or point.label in _WITHOUT_CROSSING:
            continue
        if row not in seen:
            before[row] = _of_count(point.unstable_before)
        after[row] = _of_count(point.unstable_after)
        seen.add(row)
    return before, after


def _of_count(unstable: int | None) -> int:
    """What is told of a side of a special point with so many unstable directions."""
    return UNDECIDED if unstable is None else UNSTABLE if unstable else STABLE


def _of_segments(row: np.ndarray, special: np.ndarray, before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """What is told of each segment, of shape (k - 1,), from what is told of its ends."""
    left, right = row[:-1], row[1:]
    either = np.maximum(left, right)  # a change that was not located: the worse of the two
    between_specials = np.maximum(after[:-1], before[1:])
    return np.select(
        [~special[:-1] & ~special[1:], ~special[:-1], ~special[1:]],
        [either, left, right],
        between_specials,
    )


def position(branch: Branch, values: np.ndarray, index: int, s: float) -> float:
    """Value of a quantity at a special point: that of its row, or between two rows if it has none.

    `values` are those of the branch's rows, shape (k,), `s` is the point's arclength; NaN without rows.
    """
    if 0 <= index < len(branch) and branch.points["special"][index]:
        return float(values[index])
    return float(np.interp(s, branch.points["s"], values)) if len(branch) else float("nan")

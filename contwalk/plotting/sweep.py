"""Branches of a sweep as rows of one field over the plane of the free and the swept parameter.

Where several solutions exist at one point of the plane (a branch with folds, several branches with the same
swept value) the most stable one counts: the map answers whether a stable solution exists.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from contwalk.branch import Branch
from contwalk.errors import ContwalkError
from contwalk.plotting.quantities import values


@dataclass(frozen=True)
class Row:
    """The field at one swept value.

    Parameters
    ----------
    level : float
        The swept value.
    x, value : array of shape (k,)
        The free parameter, growing, and the field there.
    covered : array of shape (k - 1,), bool
        Whether a branch leads from each x to the next; if not, there is a hole in the data.
    """

    level: float
    x: np.ndarray
    value: np.ndarray
    covered: np.ndarray


def gather(branches: Sequence[Branch], x: str, y: str, quantity: str) -> list[Row]:
    """The rows of a quantity over free `x`, by growing swept `y`.

    Raises
    ------
    ContwalkError
        If `y` varies along a branch, or fewer than two of its values have data.
    """
    runs: dict[float, list[np.ndarray]] = {}
    for branch in branches:
        if len(branch):
            columns = [np.asarray(values(branch, name)) for name in (x, y, quantity)]
            level = _constant(branch, y, columns[1])
            runs.setdefault(level, []).extend(_monotone_runs(columns[0], columns[2]))
    rows = [_most_stable(level, runs[level]) for level in sorted(runs) if runs[level]]
    if len(rows) < 2:
        raise ContwalkError(
            f"A stability map over '{y}' needs branches at two of its values or more, not {len(rows)}.",
            f"Compute a sweep: one branch in '{x}' for each of several values of '{y}'.",
        )
    return rows


def _constant(branch: Branch, y: str, column: np.ndarray) -> float:
    # Twelve digits: a swept value may have been computed in more than one way.
    if not np.ptp(column) <= 1e-12 * np.abs(column).max():
        raise ContwalkError(
            f"'{y}' varies along branch {branch.name}.",
            "The vertical axis of a stability map is a parameter that is fixed on each branch.",
        )
    return float(f"{column[0]:.12g}")


def _monotone_runs(x: np.ndarray, value: np.ndarray) -> list[np.ndarray]:
    """Parts of a branch on which x grows or falls and the value is finite, as arrays (k, 2), x growing."""
    runs, start = [], 0
    finite = np.isfinite(x) & np.isfinite(value)
    direction = np.sign(np.diff(x))
    for i in range(1, len(direction)):  # rows of equal x, as at a fold, go on as before
        direction[i] = direction[i] or direction[i - 1]
    for i in range(len(x)):
        last = i + 1 == len(x)
        broken = last or not finite[i] or not finite[i + 1]
        turns = not broken and i > start and direction[i] * direction[i - 1] < 0
        if broken or turns:
            part = np.stack([x[start : i + 1], value[start : i + 1]], axis=1)
            part = part[np.isfinite(part).all(axis=1)]
            if len(part):
                runs.append(part if part[0, 0] <= part[-1, 0] else part[::-1])
            start = i if turns else i + 1
    return runs


def _most_stable(level: float, runs: Sequence[np.ndarray]) -> Row:
    """The least value over the runs at all their x."""
    x = np.unique(np.concatenate([run[:, 0] for run in runs]))
    value = np.full(len(x), np.inf)
    covered = np.zeros(len(x) - 1, dtype=bool)
    for run in runs:
        inside = (x >= run[0, 0]) & (x <= run[-1, 0])
        value[inside] = np.minimum(value[inside], np.interp(x[inside], run[:, 0], run[:, 1]))
        covered |= inside[1:] & inside[:-1]
    return Row(level, x, value, covered)

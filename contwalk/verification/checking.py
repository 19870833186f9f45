"""A database checked: ends, then special points, then rows, as far as a budget goes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from contwalk.branch import Branch, SpecialPoint
from contwalk.errors import ContwalkError
from contwalk.labels import END
from contwalk.numerics.threads import one_thread
from contwalk.system import System
from contwalk.verification import budget
from contwalk.verification.ends import Ranges, checked_end
from contwalk.verification.finding import Finding
from contwalk.verification.points import checked_point
from contwalk.verification.rows import checked_row

Record = tuple[Branch, SpecialPoint | int]


def records_of(branches: Sequence[Branch]) -> list[Record]:
    """What is checked: ends and special points of all branches, then every tenth row of each in turn."""
    specials: list[Record] = [
        (b, point) for b in branches for point in b.special_points if point.label != END
    ]
    ends: list[Record] = [(b, point) for b in branches for point in b.special_points if point.label == END]
    return [*ends, *specials, *_rows(branches)]


def _rows(branches: Sequence[Branch]) -> Iterator[Record]:
    """Rows from the middle of each ten on, that of the next branch after each: a short budget sees all."""
    left = [(branch, _ordinary(branch)) for branch in branches]
    for turn in range(max((len(rows) for _, rows in left), default=0)):
        yield from ((branch, rows[turn]) for branch, rows in left if turn < len(rows))


def _ordinary(branch: Branch, every: int = 10) -> list[int]:
    """Rows that are no special points and have an error, every tenth of them, spread ever more finely."""
    rows = np.flatnonzero(~branch.points["special"] & np.isfinite(branch.points["error"]))
    chosen = rows[every // 2 :: every] if len(rows) > every // 2 else rows[:1]
    order = sorted(range(len(chosen)), key=lambda k: int(f"{k:032b}"[::-1], 2))
    return [int(chosen[k]) for k in order]


@one_thread()
def checked(
    system: System,
    records: Sequence[Record],
    ranges: Ranges,
    seconds: float,
    progress: Callable[[Finding], None] | None = None,
) -> list[Finding]:
    """Recompute records of a run, each from its own words.

    Parameters
    ----------
    system : System
    records : sequence of (Branch, SpecialPoint or row)
    ranges : mapping
        From where to where the run went, by parameter.
    seconds : float
        CPU after which special points and ends that are left are not recomputed, and rows are left out.
    progress : callable, optional
        Told each finding when it is there.
    """
    result = list[Finding]()
    with budget.within(seconds):
        for branch, record in records:
            found = _found(system, branch, record, ranges)
            result += found
            if progress is not None and found:
                progress(found[0])
    return result


def _found(system: System, branch: Branch, record: SpecialPoint | int, ranges: Ranges) -> list[Finding]:
    """The findings of one record; a computation that breaks down has found nothing."""
    name = str(record) if isinstance(record, int) else record.name
    try:
        budget.ask()
        with np.errstate(all="ignore"):  # what is not finite shows in what comes out
            if isinstance(record, int):
                return checked_row(system, branch, record)
            if record.label == END:
                return [checked_end(system, branch, record, ranges)]
            return [checked_point(system, branch, record)]
    except budget.UsedUp as why:  # rows are a sample, of any size
        return [] if isinstance(record, int) else [Finding(branch.name, name, reason=why.sentence)]
    except (ArithmeticError, ValueError, ContwalkError) as error:
        reason = f"the second computation broke down: {error}"
        return [replace(Finding(branch.name, name), reason=reason)]

"""Where on a ray of growing disturbances survival ends: interval halving, and a scan for further borders."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

# A ray is given up where nothing survives that is larger than this part of where the search begins.
SMALLEST = 1e-12
GROWTH = 2.0


@dataclass(frozen=True)
class Borders:
    """What was found on a ray.

    Parameters
    ----------
    borders : tuple of float
        All that were met, each known to the accuracy asked for, the innermost first. Empty where everything
        survives as far as was looked, or nothing does.
    farthest : float
        The largest disturbance that was tried.
    simulations : int
    """

    borders: tuple[float, ...]
    farthest: float
    simulations: int

    @property
    def several(self) -> bool:
        """Whether survival ends, and begins again further out."""
        return len(self.borders) > 1


def borders_on(
    survives: Callable[[float], bool], begin: float, farthest: float, accuracy: float, scan: int
) -> Borders:
    """The borders of survival on a ray.

    From `begin` on disturbances are doubled until one does not survive, or halved until one does. The border
    between is halved to the accuracy. Then `scan` disturbances evenly spaced below it, and as many from there
    to twice its size, are tried; wherever two neighbours of all that were tried differ lies another border.

    Parameters
    ----------
    survives : callable
        Whether a motion survives a disturbance of this size; the undisturbed one does.
    begin, farthest : float
        Where the search begins, and the largest disturbance that is tried.
    accuracy : float
        Width of the interval in which a border lies, in parts of it.
    scan : int
        How many more are tried on each side of the border, 0 for none.
    """
    tried: dict[float, bool] = {0.0: True}

    def ask(size: float) -> bool:
        if size not in tried:
            tried[size] = bool(survives(size))
        return tried[size]

    def halved(inner: float, outer: float) -> float:
        """The border between two sizes whose answers differ."""
        inside = ask(inner)
        while outer - inner > accuracy * inner:
            middle = 0.5 * (inner + outer)
            if not inner < middle < outer or outer < SMALLEST * begin:
                break
            if ask(middle) == inside:
                inner = middle
            else:
                outer = middle
        return 0.5 * (inner + outer)

    size = min(begin, farthest)
    if ask(size):
        while ask(size) and size < farthest:
            size = min(GROWTH * size, farthest)
    else:
        while not ask(size / GROWTH) and size > SMALLEST * begin:
            size /= GROWTH
    if ask(size):
        return _all_of(tried, halved, farthest)
    first = halved(_below(tried, size), size)
    for number in range(1, scan + 1):
        ask(first * number / (scan + 1))
        ask(min(first * (1.0 + number / scan), farthest))
    return _all_of(tried, halved, farthest)


def _below(tried: dict[float, bool], size: float) -> float:
    """The largest disturbance below one that has survived."""
    return max(other for other, good in tried.items() if good and other < size)


def _all_of(tried: dict[float, bool], halved: Callable[[float, float], float], farthest: float) -> Borders:
    """Every border between neighbours of what has been tried."""
    changes = [(a, b) for a, b in pairwise(sorted(tried)) if tried[a] != tried[b]]
    found = tuple(halved(a, b) for a, b in changes)
    return Borders(found, min(max(tried), farthest), len(tried) - 1)

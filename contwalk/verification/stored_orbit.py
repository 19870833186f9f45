"""The parts of a stored orbit: where its legs and their pieces begin, how long they last, how it drifts.

A record tells states inside of legs as well: where deviations grow, the start alone does not tell the motion.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from contwalk.branch import BranchInfo


@dataclass(frozen=True)
class StoredOrbit:
    """What stands in the unknowns of an orbit.

    Parameters
    ----------
    starts : list of ndarray, shape (m_i, n_i)
        States at the starts of the pieces of each leg.
    begins : list of ndarray, shape (m_i,)
        When these are, as parts of the leg.
    durations : ndarray, shape (legs,)
    start : float
        The time at the start, of forced orbits through events.
    drifts : ndarray, shape (j,)
        Along directions that are held.
    lasting : slice
        Where durations stand in the unknowns: nowhere, where a force gives the only one.
    """

    starts: list[np.ndarray]
    begins: list[np.ndarray]
    durations: np.ndarray
    start: float
    drifts: np.ndarray
    lasting: slice


def stored_orbit(
    info: BranchInfo, unknowns: np.ndarray, sizes: Sequence[int], forced: bool, period: float
) -> StoredOrbit:
    """The parts of the unknowns (u,) of an orbit with legs of so many states."""
    pins = len(info.settings.get("pins", ()))
    if "legs" not in info.settings:
        return _smooth(info, unknowns, sizes[0], pins, int(not forced), period)
    ends = np.cumsum([0, *sizes])
    total, legs = int(ends[-1]), len(sizes)
    rest = total + legs + int(forced)
    inner = unknowns[rest + pins :]
    cuts = 1 + (len(inner) // total if len(inner) % total == 0 else 0)
    starts, place = [], 0
    for (a, b), n in zip(pairwise(ends), sizes, strict=True):
        own = inner[place : place + (cuts - 1) * n]
        starts.append(np.concatenate([unknowns[a:b], own]).reshape(cuts, n))
        place += len(own)
    begins = [np.arange(cuts) / cuts] * legs
    start = float(unknowns[rest - 1]) if forced else 0.0
    lasting = slice(total, total + legs)
    return StoredOrbit(starts, begins, unknowns[lasting], start, unknowns[rest : rest + pins], lasting)


def _smooth(
    info: BranchInfo, unknowns: np.ndarray, n: int, pins: int, timed: int, period: float
) -> StoredOrbit:
    """Those of one leg that no event ends, whose pieces begin at stored times or at equal ones."""
    left = len(unknowns) - timed - pins
    times, cuts = _times(info, unknowns, left, n), left // n if left % n == 0 else 1
    begins = np.arange(cuts) / cuts if times is None else times
    cuts = len(begins)
    drifts = unknowns[cuts * n + timed : cuts * n + timed + pins]
    starts = unknowns[: cuts * n].reshape(cuts, n)
    lasting = slice(cuts * n, cuts * n + timed)
    return StoredOrbit([starts], [begins], np.array([period]), 0.0, drifts, lasting)


def _times(info: BranchInfo, unknowns: np.ndarray, left: int, n: int, least: int = 9) -> np.ndarray | None:
    """Times of pieces, shape (m,), that stand behind all else; of those that begin evenly `least` are."""
    cuts, rest = divmod(left + 1, n + 1)
    always = info.settings.get("scheme") in ("collocation", "grown")
    if rest or not (always or info.settings.get("evenly_first")) or cuts < (2 if always else least):
        return None
    times = np.append(0.0, unknowns[len(unknowns) - cuts + 1 :])
    return times if np.all(np.diff(np.append(times, 1.0)) > 0.0) else None

"""Whether a motion through events, which comes back ever nearer, decays: it then comes back to a rest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contwalk.errors import StartError
from contwalk.problems.hybrid.mirrors import Span
from contwalk.system import System

# A motion of which less than this part is lost from one return to the next does not decay for certain, nor
# does one of which the parts that are lost in two of them differ by more: an orbit, if small, is left over.
LOST, ALIKE = 1e-3, 1e-3
# Of its magnitudes: what is left of a motion that has decayed.
NOTHING = 1e-9


def decaying(system: System, stretches: Sequence[Span], back: int, scale: np.ndarray) -> bool:
    """Whether the last `back` stretches of a motion are those before, and before these, but smaller alike.

    Parameters
    ----------
    scale : ndarray, shape (n,)
        Magnitudes of the states.

    Raises
    ------
    StartError
        If nothing is left of it.
    """
    if len(stretches) < 3 * back:
        return False
    first, second, last = (
        _size(stretches[len(stretches) - k * back : len(stretches) - (k - 1) * back], scale)
        for k in (3, 2, 1)
    )
    if not first > second > last > 0.0:
        return False
    kept = last / second
    if 1.0 - kept < LOST or abs(kept - second / first) > ALIKE * kept:
        return False
    if last > NOTHING:
        return True
    end = stretches[-1].start + stretches[-1].duration
    raise StartError(
        f"The motion decays to rest through events: each return moves {kept:.3g} as much as the one "
        f"before, and nothing is left of it at t = {system.lasting(end)}. Where it rests the guards of its "
        "events are zero, which is no orbit.",
        "Start at parameters at which a motion lasts, or from one that does.",
    )


def _size(stretches: Sequence[Span], scale: np.ndarray) -> float:
    """How far the states go at the events of some stretches."""
    states = np.array([x for each in stretches for x in (each.state, each.end)])
    return float(np.max(np.ptp(states, axis=0) / scale))

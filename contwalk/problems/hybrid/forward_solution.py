"""What lies between soft transitions, solved for piece by piece in the order of the motion.

No derivatives of the motion are needed: each piece begins where the one before ends, and lasts until its
guard is zero.
"""

from __future__ import annotations

import numpy as np

from contwalk.problems.hybrid.grouping import Grouping
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.orbit.discretization import STAGES
from contwalk.problems.orbit.lifts import PLAIN

# Corrections of a piece's duration, and the size of the last of them in parts of the closure's duration.
MOST_CORRECTIONS, ROUNDED = 6, 1e-12


def solved_forward(explicit: LimitedOrbit, grouping: Grouping, z: np.ndarray, near: np.ndarray) -> np.ndarray:
    """What is eliminated, solved for; as it is in `near` where a piece does not come to its guard.

    Parameters
    ----------
    explicit : LimitedOrbit
        Discretised; its legs are of one segment each.
    z : ndarray
        The unknowns that are left.
    near : ndarray
        Explicit unknowns: durations of pieces are looked for from those here.
    """
    layout, soft = explicit.layout, grouping.split(near)[1]
    found = grouping.joined(z, soft)
    total = float(np.abs(found[layout.durations]).sum())
    for group in grouping.groups:
        places = [layout.durations.start + i for i in group]
        lasting = float(found[places].sum())
        for i in group[:-1]:
            if not _passed(explicit, i, found, ROUNDED * total):
                return soft
        found[places[-1]] = lasting - float(found[places[:-1]].sum())
    return grouping.split(found)[1]


def _passed(explicit: LimitedOrbit, i: int, found: np.ndarray, small: float) -> bool:
    """Write duration and end of leg i, whose start is known, by Newton's method for its guard."""
    layout, (segment,) = explicit.layout, explicit.layout.segments_of(i)
    piece, n = explicit.segments[i], segment.ends.stop - segment.ends.start
    field, guarded = piece.passage.field(PLAIN), piece.passage.end(PLAIN)
    for _ in range(MOST_CORRECTIONS):
        x, scalars = layout.inputs_of(segment, found)
        explicit.effort.spend(STAGES[piece.method] * (len(piece.steps) - 1))
        before, values = piece.before(PLAIN, x, scalars), piece.values(scalars)
        end, slope = guarded.linearized(1.0, before, guarded.constants(values))
        if scalars[0] == 0.0 or not (np.isfinite(end).all() and np.isfinite(slope).all()):
            return False
        # The duration is a factor of the leg's own field.
        velocity = field(1.0, before, field.constants(values)) / scalars[0]
        rate = float(slope[n, : len(x)] @ velocity + slope[n, len(x)])
        if rate == 0.0 or not np.isfinite(rate):
            return False
        change = float(end[n]) / rate
        found[segment.following] = end[:n]
        if abs(change) <= small:
            return True
        found[layout.durations.start + i] -= change
    return False

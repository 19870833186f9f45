"""Events that are not resolved any more: the motion has come to rest in their guard before they happen.

A guard that falls exponentially until its event is below what it is known to for a part of the closure, and
any instant of that part solves the equations. What is found there is a solution of rounding.
"""

from __future__ import annotations

import numpy as np

from contwalk.branch import Outcome
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.orbit.multipliers import GLOBAL
from contwalk.problems.problem import Sample
from contwalk.system import Transition

# An event may happen anywhere in this part of the closure: it is not resolved.
PART = 0.05
# Orbits known to less than this, in the metric, have events that are resolved.
KNOWN = 1e-3


def unresolved(problem: LimitedOrbit, a: Sample, b: Sample) -> Outcome | None:
    """The end of a branch at an event whose instant is not known to a part of the closure."""
    if not problem.itinerary.eventful or b.error < KNOWN:
        return None
    for leg, transition in problem.events:
        level, part = _undecided(problem, b.z, leg, transition)
        if part <= PART:
            continue
        last = problem.line.described(float(a.z[-1]))
        return Outcome(
            "stopped",
            "event_lost",
            f"The event '{transition.name}' is not resolved beyond {last}: for {100.0 * part:.2g} % of the "
            f"closure before it, its guard is below {level:.1e}, to which it is known, and the event may "
            "happen at any instant of that time. A finer `accuracy` goes further.",
        )
    return None


def _undecided(problem: LimitedOrbit, z: np.ndarray, leg: int, transition: Transition) -> tuple[float, float]:
    """What the guard that ends a leg is known to, and for which part of the closure before it is smaller."""
    pieces, mesh = problem.pieces_of(z, leg), problem.mesh
    largest = max(piece.size_at_steps(transition) for piece in pieces)
    level = GLOBAL * mesh.amplified * mesh.tolerance * largest
    last, whole = pieces[-1], problem.duration(z)
    own = last.piece.passage.leg.transition or transition
    times, values, _ = last.guard(own)
    since = _below_since(times, np.abs(values), level)
    return level, float((times[-1] - since) * last.duration / whole) if whole > 0.0 else 0.0


def _below_since(times: np.ndarray, sizes: np.ndarray, level: float) -> float:
    """When some sizes fall below a level for good, both of shape (k,): between samples along a straight line.

    Of a motion of few steps, as a flight is one, samples are far apart.
    """
    larger = np.flatnonzero(sizes > level)
    if not len(larger):
        return float(times[0])
    k = min(int(larger[-1]), len(times) - 2)
    over, under = sizes[k], sizes[k + 1]
    share = min((over - level) / (over - under), 1.0) if over > under else 1.0
    return float(times[k] + share * (times[k + 1] - times[k]))

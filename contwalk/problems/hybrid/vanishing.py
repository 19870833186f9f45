"""Families of orbits through events that shrink to nothing, and the parameter at which they do.

| what passes zero between two orbits | where the family ends |
|---|---|
| a guard, all along the leg that it ends | at a point: beyond it the event would pass zero the other way |
| the duration | where events follow each other at once |

Both are smooth along the family. A cubic through both orbits tells where a guard, or the duration, passes
zero.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from contwalk.branch import Outcome
from contwalk.problems.hybrid import locating_limits
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.orbit.solving import error_holding
from contwalk.problems.orbit.vanishing import shrunk
from contwalk.problems.problem import Sample

# Between two orbits a guard has been zero all along its leg if it is this much smaller there, and the time
# that the leg lasts is not.
SMALLER = 0.1
# A guard that is smaller than this, in units of what typical changes of the states make of it, is zero if the
# parameter has no more than this part of its magnitude to go.
POINT, REST = 1e-8, 1e-3
# It falls like no higher power of the parameter's way than this; how far along the tangent its rate is told,
# in parts of the step.
MOST_POWER, ALONG, TINY = 4.0, 1e-2, 1e-300
# Where a size passes zero is known to this part of the way; steps of the search for it.
CLOSE, SEARCHES = 1e-13, 60
# A leg that takes less than this part of the closure vanishes, rather than lasts.
LASTS = 1e-2

Size = Callable[[np.ndarray], float]


def in_no_time(problem: LimitedOrbit, a: Sample, b: Sample) -> Outcome | None:
    """The closure shrinks to no time at all: its events follow each other at once, for ever."""
    if not problem.itinerary.eventful or not a.period > 0.0 >= b.period:
        return None
    return shrunk(
        f"The orbit lasts no time any more near {_where(problem, a, b, problem.duration)}: its events follow "
        "each other at once, and the family ends there. Nothing to do."
    )


def onto_an_event(problem: LimitedOrbit, a: Sample, b: Sample) -> Outcome | None:
    """An event's guard comes to be zero all along its leg, which lasts: the orbit has shrunk to a point."""
    if not problem.itinerary.eventful:
        return None
    magnitudes = problem.magnitudes_of(b.weights)
    for leg, transition in problem.events:
        where = _through_zero(problem, leg, a, b) or _to_zero(problem, leg, a, b, magnitudes)
        if where:
            return shrunk(
                f"The orbit shrinks to a point near {where}: up to '{transition.name}' its guard is zero all "
                "the time there, and the family ends. Nothing to do."
            )
    return None


def _through_zero(problem: LimitedOrbit, leg: int, a: Sample, b: Sample) -> str:
    """Where a guard vanishes all along its leg between two orbits; empty if it does not."""

    def rate(z: np.ndarray) -> float:
        return arrival(problem, z, leg)

    first, last = rate(a.z), rate(b.z)
    if not first * last < 0.0:
        return ""
    lasting = problem.layout.durations.start + leg
    between = _cubic(a, b)(first / (first - last))
    reaches = [reach(problem, z, leg) for z in (a.z, b.z, between)]
    if a.z[lasting] * b.z[lasting] <= 0.0:
        return ""  # the leg vanishes, and its guard with it
    durations = [abs(float(z[lasting])) for z in (a.z, b.z, between)]
    if reaches[2] > SMALLER * min(reaches[:2]) or durations[2] <= SMALLER * min(durations[:2]):
        return ""
    return _where(problem, a, b, lambda z: rate(z) / first)


def _to_zero(problem: LimitedOrbit, leg: int, a: Sample, b: Sample, magnitudes: np.ndarray) -> str:
    """Where a guard that is nearly zero all along its leg will be; empty if it is not.

    A family need not have solutions beyond its point, and is followed then until it is one to rounding. The
    guard falls like a power of what is left of the parameter's way, which its rate at the first orbit tells.
    """
    before, after = (reach(problem, s.z, leg) for s in (a, b))
    if not 0.0 < after < before:
        return ""
    # A power's secant tells less of the way than is left: where that is too much, nothing else is asked.
    ahead = abs(float(b.z[-1] - a.z[-1])) * after / (before - after)
    if ahead > REST * float(b.weights[-1]):
        return ""
    if not after < POINT * typical_guard(problem, b.z, magnitudes, leg):
        return ""
    step = ALONG * float(np.linalg.norm((b.z - a.z) / a.weights)) * a.tangent
    further = reach(problem, a.z + step, leg)
    if abs(float(b.z[problem.layout.durations][leg])) < LASTS * problem.duration(b.z):
        return ""  # the leg vanishes, and its guard with it
    left = float(step[-1]) * before / max(before - further, TINY)
    if not before > further or MOST_POWER * abs(left) > REST * float(b.weights[-1]):
        return ""
    return _told(problem, float(b.z[-1]), MOST_POWER * abs(left))


def _where(problem: LimitedOrbit, a: Sample, b: Sample, size: Size) -> str:
    """The parameter at which a size passes zero between two orbits, with its error, in words."""
    share = _root(a, b, size)
    value = float(_cubic(a, b)(share)[-1])
    straight = float(a.z[-1] + share * (b.z[-1] - a.z[-1]))
    return _told(problem, value, abs(value - straight) + _noise(problem, a, b))


def _told(problem: LimitedOrbit, value: float, error: float) -> str:
    value = 0.0 if abs(value) <= error else value
    return problem.line.described(value, error)


def _noise(problem: LimitedOrbit, a: Sample, b: Sample) -> float:
    """What errors of the equations do to the parameter of an orbit of a size."""
    held = (b.z - a.z) / a.weights**2
    held[-1] = 0.0
    return error_holding(problem, a.z, a.weights, held)


def _root(a: Sample, b: Sample, size: Size) -> float:
    """Where a size that is positive at the first orbit and not at the second passes zero, 0..1.

    By the secant through both sides, of which the value at one that stays is halved (Illinois).
    """
    there, low, high = _cubic(a, b), 0.0, 1.0
    first, last, kept = size(a.z), size(b.z), 0
    for _ in range(SEARCHES):
        share = low + (high - low) * first / (first - last)
        found = size(there(share))
        if found > 0.0:
            low, first, last, kept = share, found, last * (0.5 if kept == 1 else 1.0), 1
        else:
            high, last, first, kept = share, found, first * (0.5 if kept == -1 else 1.0), -1
        if found == 0.0 or high - low < CLOSE:
            break
    return share


def _cubic(a: Sample, b: Sample) -> Callable[[float], np.ndarray]:
    """Unknowns between two orbits, by their tangents."""
    chord = b.z - a.z
    normal = chord / a.weights**2
    length = float(chord @ normal)
    first, last = (s.tangent * length / float(s.tangent @ normal) for s in (a, b))

    def at(share: float) -> np.ndarray:
        rest = 1.0 - share
        straight = a.z + share * chord
        return straight + share * rest * (rest * (first - chord) - share * (last - chord))

    return at


def arrival(orbit: LimitedOrbit, z: np.ndarray, i: int) -> float:
    """How fast the guard that ends leg i arrives. z has the shape (N + 1,)."""
    transition, piece = orbit.itinerary.legs[i].transition, orbit.pieces_of(z, i)[-1]
    assert transition is not None
    # Where soft transitions come and go, the leg ends in another mode than the itinerary was read off in.
    own = piece.piece.passage.leg.transition or transition
    return float(piece.guard(own)[2][-1]) / (piece.duration or 1.0)


def reach(orbit: LimitedOrbit, z: np.ndarray, i: int) -> float:
    """Largest value, at the steps, of the guard that ends leg i. z has the shape (N + 1,)."""
    transition = orbit.itinerary.legs[i].transition
    assert transition is not None
    return max(piece.size_at_steps(transition) for piece in orbit.pieces_of(z, i))


def typical_guard(orbit: LimitedOrbit, z: np.ndarray, magnitudes: np.ndarray, i: int) -> float:
    """What typical changes of the states, `magnitudes_of` weights, make of the guard that ends leg i.

    z has the shape (N + 1,), magnitudes (n,).
    """
    transition = orbit.itinerary.legs[i].transition
    assert transition is not None
    return locating_limits.typical(orbit.pieces_of(z, i)[-1], transition, magnitudes)

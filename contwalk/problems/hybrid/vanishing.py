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
from contwalk.numerics.bracketing import zero_of
from contwalk.numerics.hermite_curve import HermiteCurve
from contwalk.numerics.laws import Pair
from contwalk.problems.hybrid import locating_limits
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.orbit.vanishing import shrunk
from contwalk.problems.problem import Sample
from contwalk.problems.solving import error_holding

# Between two orbits a guard has been zero all along its leg if it is this much smaller there, and the time
# that the leg lasts is not.
SMALLER = 0.1
# A guard that is smaller than this, in units of what typical changes of the states make of it, is zero if the
# parameter has no more than this part of its magnitude to go.
POINT, REST = 1e-8, 1e-3
# How far along the tangent its rate is told, in parts of the step.
ALONG = 1e-2
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
    between = _between(a, b).guess(first / (first - last))
    reaches = [reach(problem, z, leg) for z in (a.z, b.z, between)]
    if a.z[lasting] * b.z[lasting] <= 0.0:
        return ""  # the leg vanishes, and its guard with it
    durations = [abs(float(z[lasting])) for z in (a.z, b.z, between)]
    if reaches[2] > SMALLER * min(reaches[:2]) or durations[2] <= SMALLER * min(durations[:2]):
        return ""
    return _where(problem, a, b, lambda z: rate(z) / first)


def _to_zero(problem: LimitedOrbit, leg: int, a: Sample, b: Sample, magnitudes: np.ndarray) -> str:
    """Where a guard that is nearly zero all along its leg will be; empty if it is not.

    A family need not have solutions beyond its point, and is followed then until it is one to rounding: the
    parameter converges like a power of the guard's inverse.
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
    if abs(float(b.z[problem.layout.durations][leg])) < LASTS * problem.duration(b.z):
        return ""  # the leg vanishes, and its guard with it
    step = ALONG * float(np.linalg.norm((b.z - a.z) / a.weights))
    rates = [
        (reach(problem, s.z + step * s.tangent, leg) - size) / step for s, size in ((a, before), (b, after))
    ]
    sizes, shares = np.array([before, after]), np.array([a.tangent[-1], b.tangent[-1]])
    pair = Pair(1.0 / sizes, np.array([a.z[-1], b.z[-1]]), -shares / np.array(rates) * sizes**2)
    if not pair.falls or abs(pair.left) > REST * float(b.weights[-1]):
        return ""
    return _told(problem, float(b.z[-1]) + pair.left, abs(pair.left))


def _where(problem: LimitedOrbit, a: Sample, b: Sample, size: Size) -> str:
    """The parameter at which a size passes zero between two orbits, with its error, in words."""
    curve = _between(a, b)
    share = zero_of(lambda theta: size(curve.guess(theta)), 0.0, 1.0)
    theta = 1.0 if share is None else share  # where it is zero at the second one
    value, straight = float(curve.guess(theta)[-1]), float(a.z[-1] + theta * (b.z[-1] - a.z[-1]))
    held = (b.z - a.z) / a.weights**2
    held[-1] = 0.0  # what errors of the equations do to the parameter of an orbit of a size
    noise = error_holding(problem, a.z, a.weights, held)
    return _told(problem, value, abs(value - straight) + noise)


def _told(problem: LimitedOrbit, value: float, error: float) -> str:
    value = 0.0 if abs(value) <= error else value
    return problem.line.described(value, error)


def _between(a: Sample, b: Sample) -> HermiteCurve:
    """The curve of orbits between two, by their tangents."""
    return HermiteCurve((a.z, b.z), (a.tangent, b.tangent), a.weights)


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

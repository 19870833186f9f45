"""A guard is touched whose event leads into another mode: the orbit as one that visits it, for no time yet.

A mode that is left by a guard that is zero there, too, back into the one that the orbit is in, is visited
from the limit on: a stop with a field of its own, a mode in which a mass sticks. Where both guards are the
same, the equation of the second one says nothing new while the visit lasts no time, and all orbits that would
pass the guard solve them. Along the branch the guard's mean rate over the visit is zero in its place.
"""

from __future__ import annotations

import numpy as np

from contwalk.flow.hybrid.machine import hybrid_machine
from contwalk.numerics.linear import kernel_direction
from contwalk.problems.hybrid import locating_limits
from contwalk.problems.hybrid.adjacent.orbit import (
    AdjacentOrbit,
    assembled,
    opened,
    own_limit,
    refuse_change,
    starting_after,
)
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.margins import Limit
from contwalk.problems.orbit.branching import filled_magnitudes
from contwalk.problems.orbit.itinerary import Leg
from contwalk.system import Transition

# A guard is zero within this part of what typical changes of the states make of it.
AT_ZERO = 1e-6
# Equations of which one says nothing new have a singular value below this, each being a unit row.
REDUNDANT = 1e-7


def visited(
    problem: LimitedOrbit, z: np.ndarray, limit: Limit, place: float, leg: Leg
) -> AdjacentOrbit | None:
    """The mode that a touched event leads into is visited; None if nothing leads back at once.

    `leg` is the part of the limit's leg up to that event. z has shape (N + 1,).
    """
    i, transition, at = limit.leg, leg.transition, opened(problem, z, limit.leg, place)
    assert transition is not None
    there, states, lasting, start, entered = at.orbit, at.states, at.lasting, at.start, at.after(leg)
    back = _way_back(there, z, transition, leg, at.t, entered)
    if back is None:
        return None
    left = at.after(back, entered)
    refuse_change(there, transition, at.x, left)
    itinerary = there.itinerary.inserted(i, back).inserted(i, leg)
    states = [*states[: i + 1], entered, left, *states[i + 1 :]]
    lasting = [*lasting[:i], place * lasting[i], 0.0, (1.0 - place) * lasting[i], *lasting[i + 1 :]]
    visit = i + 1
    if not there.itinerary.eventful:
        itinerary, states, lasting = starting_after(there, z, itinerary, i, states, lasting)
        start, visit = at.t, 0
    other, unknowns = assembled(there, itinerary, states, lasting, start, z)
    if _flat(other, unknowns, visit):
        return None
    tangent = _tangent(other, unknowns, visit)
    return AdjacentOrbit(other, unknowns, own_limit(other, visit, "duration"), tangent)


def _way_back(
    problem: LimitedOrbit, z: np.ndarray, touched: Transition, leg: Leg, t: float, x: np.ndarray
) -> Leg | None:
    """The visit in the mode that an event leads into, right after which its state is x, shape (n,)."""
    flow = hybrid_machine(problem.system, problem.values_of(z)).mode(touched.target)
    own = x[flow.states]
    scales = flow.scales(t, own, problem.mesh.variation[flow.states], problem.mesh.total)
    for number, (transition, guard) in enumerate(zip(flow.transitions, flow.guards, strict=True)):
        if transition.target != leg.mode or not flow.acting(number):
            continue
        if abs(float(guard(t, own, flow.p)[0])) <= AT_ZERO * scales[number]:
            falls = not leg.falls if transition.direction == "both" else transition.direction == "falling"
            return Leg(touched.target, transition, falls)
    return None


def _flat(problem: LimitedOrbit, z: np.ndarray, visit: int) -> bool:
    """Whether what ends a visit that lasts no time, z (N + 1,), has no second rate there either.

    As the distance of a block from the table that throws it: its acceleration is zero, too, where it is
    touched. Of how long it flies such equations tell nothing to the first order.
    """
    transition = problem.itinerary.legs[visit].transition
    assert transition is not None
    period = float(problem.duration(z))
    rates = [locating_limits.starting(problem, visit, transition, z, order)[0] for order in (1, 2)]
    sizes = [abs(rate) * period**order for order, rate in enumerate(rates, start=1)]
    return bool(max(sizes) <= AT_ZERO * problem.guard_scales[visit])


def _tangent(problem: LimitedOrbit, z: np.ndarray, visit: int) -> np.ndarray | None:
    """Of the orbits with a visit that lasts; None where their equations determine it. Shape (N + 1,).

    Over a visit that lasts T a guard g changes by T (g' + T g'' / 2): the bracket is zero along the branch.
    """
    weights = filled_magnitudes(problem, z)
    jacobian = problem.linearize(z).jacobian
    if _least_singular(jacobian, weights) > REDUNDANT:
        return None
    transition = problem.itinerary.legs[visit].transition
    assert transition is not None
    value_and_slopes = locating_limits.starting(problem, visit, transition, z, 1)
    row = problem.layout.spread(visit, value_and_slopes[1][None])
    bend, _ = locating_limits.starting(problem, visit, transition, z, 2)
    row[0, problem.layout.durations.start + visit] = 0.5 * bend
    return kernel_direction(np.vstack([jacobian, row]), weights)


def _least_singular(matrix: np.ndarray, weights: np.ndarray) -> float:
    """The smallest singular value of a matrix, of equations and unknowns in units of their own."""
    scaled = matrix * weights
    sizes = np.linalg.norm(scaled, axis=1)
    return float(np.linalg.svd(scaled / np.where(sizes > 0.0, sizes, 1.0)[:, None], compute_uv=False)[-1])

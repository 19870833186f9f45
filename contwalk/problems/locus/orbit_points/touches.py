"""The instant at which a guard is touched, along a curve of grazings: it stays within its leg.

The equations of a touch go on where its instant comes before the event that the leg begins with, or after
the one that ends it: what is touched there is the motion gone on with, which the machine does not have. Both
events at once are a point of the curve, at which it ends.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from contwalk.branch import Outcome
from contwalk.problems.hybrid import limit_equations
from contwalk.problems.hybrid.limits import transition_of
from contwalk.problems.hybrid.locating_limits import starting
from contwalk.problems.hybrid.margin_values import at_entry
from contwalk.problems.hybrid.margins import TOUCH_ENDS, TOUCH_STARTS, Limit
from contwalk.problems.hybrid.soft_equations import SoftEquations
from contwalk.problems.locus.orbit_curve import OrbitCurve
from contwalk.problems.locus.orbit_curves import Limits
from contwalk.problems.locus.orbit_places import Held
from contwalk.problems.locus.orbit_points.point import together
from contwalk.problems.orbit.augmented import Augmented
from contwalk.problems.problem import Located, Sample

# A guard is zero where its leg begins, whatever the orbit, below this part of what typical changes make of
# it.
ZERO = 1e-9


def edges(orbit: Any, curve: OrbitCurve) -> tuple[Limit, ...]:
    """The limits of a touch: the events at both ends of its leg, through which no motion goes smoothly.

    Of the event whose guard touches it is the grazing.
    """
    if not isinstance(curve, Limits) or curve.limit.test != "dip":
        return ()
    touched, legs = curve.limit, orbit.itinerary.legs
    around = {TOUCH_STARTS: legs[touched.leg - 1], TOUCH_ENDS: legs[touched.leg]}
    names = {
        TOUCH_STARTS: orbit.itinerary.leading_in(orbit.system, touched.leg),
        TOUCH_ENDS: legs[touched.leg].name,
    }
    return tuple(
        Limit(
            *(("GR", "terminal") if names[test] == touched.name else ("OC", "crossing")),
            touched.name,
            touched.leg,
            test,
        )
        for test, leg in around.items()
        if leg.transition is not None and not leg.soft
    )


def inside(orbit: Any, curve: OrbitCurve, z: np.ndarray) -> np.ndarray:
    """How far the instant is inside of its leg from each of its edges, in parts of the leg, shape (e,).

    z has the shape (N + k + 2,).
    """
    found = edges(orbit, curve)
    if not found:
        return np.zeros(0)
    lasting = float(z[orbit.layout.durations][found[0].leg])
    share = float(z[orbit.size]) / lasting if lasting > 0.0 else np.nan
    return np.array([share if edge.test == TOUCH_STARTS else 1.0 - share for edge in found])


def edge_system(problem: Any, sample: Sample, edge: Limit, which: int) -> Augmented:
    """The equations of a touch at the instant of an event; `which` is the number of the edge among limits.

    Where the event leaves the guard at zero, or has it pass zero, it is touched then wherever it does so
    without rate: the second derivative is the other equation. Curves cross there, for these orbits need not
    touch it.
    """
    n, leg = problem.plane.size, edge.leg
    further = np.array([n])

    def at_edge(orbit: Any, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        own, lasting = orbit.linearize(y[: n + 1]), orbit.layout.durations.start + leg
        row, ends = np.zeros((1, len(y))), edge.test == TOUCH_ENDS
        row[0, n + 1], row[0, lasting] = 1.0, -float(ends)
        value = y[n + 1] - ends * y[lasting]
        return np.append(own.residual, value), np.vstack([_widened(own.jacobian, len(y)), row])

    held = [problem.condition, _held(at_edge, sample, further)]
    own = problem.orbit.itinerary.legs[leg].name == edge.name
    zero = own if edge.test == TOUCH_ENDS else _begins_at_zero(problem, sample)
    if zero:

        def without_rate(orbit: Any, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            residual, jacobian = at_edge(orbit, y)
            values, rows = _rates(orbit, edge, y[: n + 1])
            return np.append(residual, values), np.vstack([jacobian, _widened(rows, len(y))])

        held = [_held(without_rate, sample, further)]
    system = together(problem, sample, held, np.zeros(0))

    def described(found: Located, y: np.ndarray) -> Located:
        return replace(found, limit=which, data=float(y[n]), crossing=())

    return Augmented(system.evaluate, system.start, system.scale, described, in_units=True)


def _rates(orbit: Any, edge: Limit, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First and second derivative of the guard by time at an edge, shape (2,), and theirs by z.

    z has the shape (N + 1,), the derivatives by it (2, N + 1).
    """
    if edge.test == TOUCH_ENDS:
        arriving = replace(edge, label="GR", kind="terminal", test="rate")
        (rate, row), (second, other) = (
            limit_equations.rows_of(orbit, arriving, z, 1.0),
            limit_equations.second_rate(orbit, arriving, z, 1.0),
        )
        return np.append(rate, second), np.vstack([row, other])
    transition = transition_of(orbit, edge)
    found = [starting(orbit, edge.leg, transition, z, order) for order in (1, 2)]
    rows = [orbit.layout.spread(edge.leg, slopes[None]) for _, slopes in found]
    return np.array([value for value, _ in found]), np.vstack(rows)


def _held(
    evaluate: Callable[[Any, np.ndarray], tuple[np.ndarray, np.ndarray]], sample: Sample, further: np.ndarray
) -> Held:
    """Equations of the orbit and the instant; `further` is its place, shape (1,)."""
    return Held(Augmented(evaluate, sample.z, sample.weights, in_units=True), further)


def _widened(matrix: np.ndarray, width: int) -> np.ndarray:
    """A matrix of the orbit's unknowns, shape (k, N + 1), with columns of nothing for others."""
    wide = np.zeros((len(matrix), width))
    wide[:, : matrix.shape[1]] = matrix
    return wide


def _begins_at_zero(problem: Any, sample: Sample) -> bool:
    """Whether the event before the leg leaves the guard at zero."""
    there, own = problem.plane.first(sample.z)
    limit, layout = problem.curve.limit, there.layout
    x, scalars = layout.inputs(limit.leg, own)
    sizes = layout.inputs(limit.leg, problem.of_orbit(sample.weights))[0]
    value, slopes = at_entry(there.pieces[limit.leg], transition_of(there, limit), x, scalars)
    return abs(value) <= ZERO * float(np.abs(slopes[: len(x)]) @ sizes)


def left_its_leg(problem: Any, z: np.ndarray, place: str) -> Outcome | None:
    """The end of a curve of orbits through soft transitions whose touch has left its leg at z.

    Where that happens is not located. z has the shape (N + k + 2,); `place` is where, in words.
    """
    if not isinstance(problem.orbit, SoftEquations) or not np.any(
        inside(problem.orbit, problem.curve, z) < 0.0
    ):
        return None
    limit = problem.curve.limit
    return Outcome(
        "stopped",
        "order_change",
        f"'{limit.name}' is touched at the instant of another event near {place}: beyond it these orbits do "
        "not touch it on that leg. To go on, start at a limit of the orbits that are there beyond it.",
    )

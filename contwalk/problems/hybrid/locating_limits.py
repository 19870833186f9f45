"""Points at which a limit passes zero: which one a point is of, and the equations that locate it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import StartError, UnsupportedOperation
from contwalk.flow import Field
from contwalk.flow.events.guard_derivatives import MOST_ORDER
from contwalk.problems.hybrid import limit_equations
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.margin_values import BELOW, LITTLE, at_entry, largest
from contwalk.problems.hybrid.margins import Limit
from contwalk.problems.hybrid.view import GuardedView
from contwalk.problems.orbit import augmented
from contwalk.problems.orbit.augmented import Near
from contwalk.problems.orbit.branching import filled_magnitudes
from contwalk.problems.orbit.discretization import SOLVED
from contwalk.problems.orbit.itinerary import imaged_leg
from contwalk.problems.problem import Located, Sample
from contwalk.problems.solving import newton_on
from contwalk.system import Transition

AT_START = ("start", "leaving", "past")
# Margins larger than this are not those that a special point is a zero of.
HIDDEN = 1e-6
# Limits that do not show at a point are looked for so far beside it, in the metric, and are those nearer
# than this.
BESIDE, NEAR = 1e-4, 1e-2
# Of what typical changes of the states make of a guard: its rounding, a rate that is no more than that, and
# what one that turns within a little time changes by at most in the closure's.
ROUNDED, STILL, SLOWLY = 1e-13, 1e-8, 0.1


def nearest(problem: LimitedOrbit, point: SpecialPoint) -> int:
    """The limit that a special point is one of: the smallest margin under its label, and kind where
    it has one.

    `problem` has the point's steps.
    """
    z = np.array(point.unknowns)
    found = problem.margins(z)

    def fits(limit: Limit) -> bool:
        return limit.label == point.label and (limit.label == "OC" or limit.kind == point.kind)

    fitting = [k for k, limit in enumerate(found.limits) if fits(limit)]
    off = {k: abs(float(found.relative[k])) for k in fitting if np.isfinite(found.values[k])}
    best = min(off, key=lambda k: (off[k], found.limits[k].rank), default=None)
    if best is not None and off[best] <= HIDDEN:  # an event that arrives with no rate dips there as well
        own = found.limits[best]
        alike = [k for k in off if (found.limits[k].name, found.limits[k].leg) == (own.name, own.leg)]
        best = min((k for k in alike if off[k] <= HIDDEN), key=lambda k: (found.limits[k].rank, off[k]))
    if best is None or off[best] > HIDDEN:
        # A guard that is zero at a leg's start or end is left out of the margins just there.
        left_out = [k for k in fitting if k not in off and found.limits[k].test in ("start", "end")]
        shown = _beside(problem, z, np.array(point.tangent), left_out)
        near = best if best is not None and off[best] < NEAR else None
        best = min(shown, key=lambda k: (shown[k], found.limits[k].rank), default=near)
    if best is None:
        # The rate at the end of a leg that lasts no time at all is that of no motion.
        lasting = z[problem.layout.durations]
        short = np.abs(lasting) <= HIDDEN * float(np.abs(lasting).sum())
        ceased = (k for k in fitting if found.limits[k].test == "rate" and short[found.limits[k].leg])
        best = next(ceased, None)
    if best is None:
        raise StartError(f"{point.label} at {dict(point.parameters)} is no limit of these orbits.", "")
    return best


def _beside(problem: LimitedOrbit, z: np.ndarray, tangent: np.ndarray, which: list[int]) -> dict[int, float]:
    """How far from zero some limits are a little beside a point, on both sides; those that are nowhere near
    it are left out, and those that are zero there as well.
    """
    weights = filled_magnitudes(problem, z)
    off: dict[int, float] = {}
    step = BESIDE * tangent / float(np.linalg.norm(tangent / weights))
    for there in (z + step, z - step) if which else ():
        values = problem.margins(there)
        for k in which:
            share = abs(float(values.relative[k]))
            if np.isfinite(values.values[k]) and share < NEAR:
                off[k] = min(share, off.get(k, np.inf))
    return off


def located(problem: LimitedOrbit, which: int, sample: Sample) -> Located | None:
    """The point near a sample at which limit number `which` passes zero."""
    try:
        system = system_of(problem, which, sample)
        found = None if system is None else augmented.solved(problem, system, sample)
    except (np.linalg.LinAlgError, UnsupportedOperation):
        return None
    return found if found is None else _told_by_what_vanishes(problem, which, sample, found)


def _told_by_what_vanishes(problem: LimitedOrbit, which: int, sample: Sample, found: Located) -> Located:
    """A limit by the equations of the leg that turns out to vanish there: its own are singular at it."""
    if found.vanishing:
        return found
    near = replace(sample, z=found.z)
    try:
        for leg in _doubtful(problem, problem.limits[which]):
            if _vanishes(problem, leg, near):
                again = augmented.solved(problem, _vanishing(problem, which, leg, near), sample)
                return again or found
    except (np.linalg.LinAlgError, UnsupportedOperation):
        pass
    return found


def system_of(
    problem: LimitedOrbit, which: int, near: Near, further: np.ndarray | None = None
) -> augmented.Augmented | None:
    """The orbit's equations with those of limit number `which`, near a place; None where it is nowhere met.

    `further` are values of the unknowns that the limit has beside those of the orbit, shape (k,), where they
    are known: of a guard that touches zero, the instant.
    """
    limit = problem.limits[which]
    for leg in _doubtful(problem, limit):
        if _vanishes(problem, leg, near):
            return _vanishing(problem, which, leg, near)
    i, size = limit.leg, problem.size
    start, scale = near.z, near.weights
    share = 1.0
    if limit.test == "dip":
        duration = float(near.z[problem.layout.durations][i])
        known = further is not None and len(further) == 1
        share = float(further[0]) / duration if known else float(problem.margins(near.z).places[which])  # type: ignore[index]
        if not np.isfinite(share):
            return None
        start, scale = np.append(start, share * duration), np.append(scale, abs(duration))

    def evaluate(there: Any, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        z = y[: size + 1]
        own = there.linearize(z)
        values, rows = limit_equations.rows_of(there, limit, y, share)
        jacobian = np.zeros((size + len(values), len(y)))
        jacobian[:size, : size + 1] = own.jacobian
        jacobian[size:] = rows
        return np.concatenate([own.residual, values]), jacobian

    def described(found: Located, y: np.ndarray) -> Located:
        seconds = float(y[-1]) if limit.test == "dip" else float(y[found.problem.layout.durations][i])
        return replace(found, limit=which, data=0.0 if limit.test in AT_START else seconds)

    return augmented.Augmented(evaluate, start, scale, described, in_units=True)


def _doubtful(problem: LimitedOrbit, limit: Limit) -> tuple[int, ...]:
    """The legs that may have vanished where a limit is met: its own, or the one that its event leads to."""
    own = problem.itinerary.legs[limit.leg].name == limit.name
    if limit.test == "rate" or (limit.test == "dip" and own):
        return limit.leg, (limit.leg + 1) % problem.layout.legs
    return (limit.leg,) if limit.test == "duration" else ()


def _vanishes(problem: LimitedOrbit, i: int, sample: Near) -> bool:
    """Whether leg i, at whose start its own guard is zero, too, is nearly none.

    Then guard and rate at its end are zero wherever it lasts no time: its equation says nothing there.
    """
    transition, duration = problem.itinerary.legs[i].transition, float(sample.z[problem.layout.durations][i])
    if transition is None or abs(duration) > LITTLE * problem.mesh.total or collapses(problem, i):
        return False
    z = _solution(problem, sample)  # of a guess no guard is zero
    view = problem.view(z)[i]
    _, values, rates = view.guard(transition)
    most = largest(values, rates, view.duration, problem.mesh.total)
    typical = _typical(problem, i, transition, sample)
    # One that passes zero with a rate is near it all along a short leg. Rates are over the leg's own time: of
    # a leg that lasts none at all they tell nothing.
    lasting = view.duration
    rate = float(rates[0]) / lasting if lasting else _begins_with(problem, i, transition, z, 1)
    turns = abs(rate) * problem.mesh.total <= SLOWLY * typical
    # What an equation makes zero, such as the guard of the event before, is so to what they are solved to.
    rounded = max(ROUNDED, SOLVED * problem.mesh.tolerance) * typical
    return turns and abs(float(values[0])) <= max(BELOW * most, rounded)


def _solution(problem: LimitedOrbit, sample: Near) -> np.ndarray:
    """The solution nearest to a sample, which may be a guess."""
    try:
        return newton_on(problem, sample.z, sample.weights)
    except StartError:
        return sample.z


def _typical(problem: LimitedOrbit, i: int, transition: Transition, sample: Near) -> float:
    """What typical changes of the states make of a guard where leg i begins."""
    piece, (x, scalars) = problem.pieces[i], problem.layout.inputs(i, sample.z)
    own = problem.layout.inputs(i, sample.weights)[0]
    return float(np.abs(at_entry(piece, transition, x, scalars)[1][: len(x)]) @ own)


def typical(view: GuardedView, transition: Transition, magnitudes: np.ndarray) -> float:
    """What changes of the states by their magnitudes make of a guard where a leg begins.

    Magnitudes have the shape (n,).
    """
    slopes = at_entry(view.piece, transition, view.x, view.scalars)[1][: len(view.x)]
    return float(np.abs(slopes) @ magnitudes[list(view.piece.passage.states)])


def collapses(problem: LimitedOrbit, i: int) -> bool:
    """Whether leg i is passed in no time where it does not last: its guard acts at entry, and moves there.

    One that has led into the leg as well is zero there, whatever the orbit; and one that acts in the leg
    before, too, happens earlier than what ends that one.
    """
    leg, itinerary, system = problem.itinerary.legs[i], problem.itinerary, problem.system
    own = leg.transition
    if own is None or not own.level:
        return False
    before = itinerary.legs[i - 1]
    if i == 0 and itinerary.image:
        before = imaged_leg(system, itinerary.image, before)
    armed = any(t.guard is own.guard or t.name == own.name for t in system.leaving(before.mode))
    return not armed and leg.name not in system.left_at_zero(before.name, leg.mode)


def _vanishing(problem: LimitedOrbit, which: int, i: int, sample: Near) -> augmented.Augmented:
    """The equations of an orbit whose leg i lasts no time, between zeros of a guard that turns there.

    Its duration is zero, and so is the first of the guard's derivatives along the motion at its start that is
    not zero however long the leg lasts: the rate, the second one of a guard that begins without rate, the
    third one of a contact that is left where its force is zero. Legs that vanish with it have no duration
    either: those of its image, where nobody has declared the symmetry. Of the orbit's own equations as many
    say nothing new there, mostly those of the guards at the ends of these legs: they are unfolded by unknowns
    that are zero.
    """
    size, gone = problem.size, [i, *_vanishing_with(problem, i, sample)]
    transition = problem.itinerary.legs[i].transition
    assert transition is not None
    order = _first_derivative(problem, i, transition, sample)

    def conditions(there: Any, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The orbit's equations with those of the legs that have gone."""
        own, lasting = there.linearize(z), np.array(gone) + there.layout.durations.start
        value, slopes = starting(there, i, transition, z, order)
        rows = np.vstack([np.eye(size + 1)[lasting], there.layout.spread(i, slopes[None])])
        return np.concatenate([own.residual, z[lasting], [value]]), np.vstack([own.jacobian, rows])

    unfolding = _redundant(
        conditions(problem, sample.z)[1], problem.equation_scales, sample.weights, len(gone)
    )

    def evaluate(there: Any, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        residual, jacobian = conditions(there, y[: size + 1])
        columns = np.zeros((len(residual), len(gone)))
        columns[:size] = there.equation_scales[:, None] * unfolding
        return residual + columns @ y[size + 1 :], np.hstack([jacobian, columns])

    around, told = _around(problem, gone), _grazing_of(problem, which, i)

    def described(found: Located, y: np.ndarray) -> Located:
        seconds = float(y[found.problem.layout.durations][found.problem.limits[told].leg])
        return replace(found, limit=told, data=seconds, vanishing=around)

    start, scale = (np.append(v, np.full(len(gone), w)) for v, w in ((sample.z, 0.0), (sample.weights, 1.0)))
    return augmented.Augmented(evaluate, start, scale, described, in_units=True)


def _around(problem: LimitedOrbit, gone: Sequence[int]) -> tuple[int, ...]:
    """The limits that pass zero where legs vanish: of the events at both ends of each, on it and beside it.

    Solutions beside that point are hardly known: of all equations only one tells whether the leg lasts.
    """
    legs, m = problem.itinerary.legs, problem.layout.legs
    beside = {(i + k) % m: {legs[i].name, legs[(i - 1) % m].name} for i in gone for k in (-1, 0, 1)}
    return tuple(k for k, limit in enumerate(problem.limits) if limit.name in beside.get(limit.leg, ()))


def _grazing_of(problem: LimitedOrbit, which: int, i: int) -> int:
    """The limit that a leg i which lasts no time is told as, where number `which` has found it.

    A leg between two zeros of one guard vanishes where that guard is touched: a grazing, of which rounding
    decides whether the duration or the rate is seen to pass zero first.
    """
    own, before = (problem.itinerary.legs[k].transition for k in (i, i - 1))
    same = own is not None and before is not None and own.guard is before.guard
    if problem.limits[which].test != "duration" or not same:
        return which
    rates = (k for k, limit in enumerate(problem.limits) if limit.leg == i and limit.test == "rate")
    return next(rates, which)


def _redundant(jacobian: np.ndarray, rows: np.ndarray, columns: np.ndarray, count: int) -> np.ndarray:
    """Combinations of an orbit's equations that say nothing new beside further ones, shape (N, count)."""
    scaled = jacobian * columns
    scaled[: len(rows)] /= rows[:, None]
    sizes = np.linalg.norm(scaled, axis=1)
    scaled /= np.where(sizes > 0.0, sizes, 1.0)[:, None]
    left = np.linalg.svd(scaled)[0][: len(rows), -count:]
    lengths = np.linalg.norm(left, axis=0)
    if not np.all(lengths > 0.0):
        raise np.linalg.LinAlgError("None of the orbit's equations says nothing new.")
    return left / lengths


def _vanishing_with(problem: LimitedOrbit, i: int, sample: Near) -> list[int]:
    """The other legs that vanish, and last as long as leg i."""
    lasting = sample.z[problem.layout.durations]
    return [
        k
        for k in range(problem.layout.legs)
        if k != i
        and abs(lasting[k] - lasting[i]) < LITTLE * abs(lasting[i])
        and _vanishes(problem, k, sample)
    ]


def _first_derivative(problem: LimitedOrbit, i: int, transition: Transition, sample: Near) -> int:
    """The order of the first derivative of a guard by time that is not zero where a short leg begins, however
    long it lasts: after a release from rest it is not the rate.

    A guard that is zero again after T has begun with the derivative -b T / (k + 1) of order k, b the next
    one. Where the leg lasts no time, as at a located point, it is the last that is zero.

    Raises
    ------
    UnsupportedOperation
        If derivatives become too large before one is not zero.
    LinAlgError
        If all of them are zero.
    """
    z = _solution(problem, sample)
    lasting, typical = abs(float(z[problem.layout.durations][i])), _typical(problem, i, transition, sample)
    value = _begins_with(problem, i, transition, z, 1)
    for order in range(1, MOST_ORDER):
        following = _begins_with(problem, i, transition, z, order + 1)
        rounding = STILL * typical / problem.mesh.total**order
        if abs(value) >= max(LITTLE * abs(following) * lasting, rounding):
            return order
        if lasting <= STILL * problem.mesh.total and abs(following) >= rounding / problem.mesh.total:
            return order
        value = following
    raise np.linalg.LinAlgError(f"All derivatives of '{transition.name}' are zero where its segment begins.")


def starting(
    problem: LimitedOrbit, i: int, transition: Transition, z: np.ndarray, order: int
) -> tuple[float, np.ndarray]:
    """A guard's derivative by time of an order where leg i begins, with derivatives by the leg's inputs."""
    map_, x, constants = _at_start(problem, i, transition, z, order)
    values, derivative = map_.linearized(0.0, x, constants)
    value, slopes = float(values[0]), derivative[0].copy()
    slopes[len(x)] = 0.0
    return value, slopes


def _begins_with(problem: LimitedOrbit, i: int, transition: Transition, z: np.ndarray, order: int) -> float:
    """The value of `starting` alone: derivatives of a high order need not be compiled for it."""
    map_, x, constants = _at_start(problem, i, transition, z, order)
    return float(map_(0.0, x, constants)[0])


def _at_start(
    problem: LimitedOrbit, i: int, transition: Transition, z: np.ndarray, order: int
) -> tuple[Field, np.ndarray, np.ndarray]:
    """A guard's derivative by time as a compiled map, with the state and constants where leg i begins."""
    piece, (x, scalars) = problem.pieces[i], problem.layout.inputs(i, z)
    # Over the leg's own time they would be zero with it.
    scalars = np.append(1.0, scalars[1:])
    map_ = piece.passage.guard_derivative(transition, order)
    return map_, x, map_.constants(piece.values(scalars))

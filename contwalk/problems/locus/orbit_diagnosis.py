"""Where a curve of orbits ends, or cannot go on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from contwalk.branch import Outcome
from contwalk.errors import ContwalkError, NotFinite
from contwalk.numerics.hermite_curve import HermiteCurve
from contwalk.numerics.linear import kernel_direction
from contwalk.problems.capabilities import Diagnosis
from contwalk.problems.kink import Met
from contwalk.problems.locus.orbit_points.point import known_to
from contwalk.problems.locus.orbit_points.touches import left_its_leg
from contwalk.problems.locus.persistence import not_persistent, place_of, unfolds
from contwalk.problems.orbit.homoclinic import saddle_ahead
from contwalk.problems.orbit.vanishing import shrunk
from contwalk.problems.problem import Located
from contwalk.problems.sample import Sample
from contwalk.problems.solving import newton_on

# Cycles this small, against the largest of the curve, have shrunk to nothing.
NEARLY_SHRUNK = 2e-2
# An orbit this far from repeating itself, or from being its own image, in units of its range, is not that by
# errors; what is left of it where that passes zero between two orbits is this part of what it is at either.
APPARENT, PASSED = 1e-5, 0.05
# Orbits are not known any more from an error of their own size on, in the metric, which has grown to it from
# a part of that: right beside a place where curves cross an error is large as well, and only there. Nor are
# they where steps do not get longer than a part of what the finest ones leave.
UNKNOWN, GROWING, BLIND = 1.0, 0.01, 0.1
# Errors that the finest steps leave of orbits that creep past a saddle: those of longer periods have more.
CREEPING = 1e-3
# Equations are singular where a singular value is no more than so many times what the steps leave.
MANY = 10.0


class OrbitLocusDiagnosis(Diagnosis):
    """What is known of such places: what is known of the orbits themselves, and of the curve's condition.

    `problem` is an `OrbitLocus`.
    """

    def __init__(self, problem: Any) -> None:
        self._problem, self._plane = problem, problem.plane

    def ended(self, a: Sample, b: Sample) -> Outcome | None:
        """Branch points that do not persist, touches that leave their leg, and where the orbits end."""
        if self.unfolded(b.z):
            return Outcome("failed", "no_convergence", not_persistent(self._problem, b.z))
        reasons = [self._leaves_its_leg, self._comes_to_a_limit, self._orbits_end, self._shrinks]
        reasons += [self._rejoins]
        if self._plane.orbit.in_closure:  # of which alone steps are as fine as curves ask for
            reasons += [self._comes_to_a_loop, self._lost]
        return next((found for reason in reasons if (found := reason(a, b))), None)

    def _leaves_its_leg(self, a: Sample, b: Sample) -> Outcome | None:
        """The end of a curve of grazings where the touch comes to the instant of another event."""
        return left_its_leg(self._problem, b.z, place_of(self._problem, b.z))

    def _comes_to_a_limit(self, a: Sample, b: Sample) -> Outcome | None:
        """The end of a curve at a limit that is no farther ahead than its solutions are known to.

        Where a leg comes to last no time as its guard loses its rate, what the curve holds is 0/0: errors
        grow as the way that is left shrinks, and the walk would go to and fro on them.
        """
        length = float(np.linalg.norm((b.z - a.z) / a.weights))
        limited = self._problem.limited
        if limited is None or np.any(a.margins * b.margins < 0.0) or not length < b.error / BLIND:
            return None  # one that is passed on the way is located
        least = int(np.argmin(left := _left_until_zero(a.margins, b.margins) * length))
        if not left[least] < b.error:
            return None
        own, places = limited.limits[least].own, self._problem.margins(b.z).places
        share = float(np.nan_to_num(places[least], nan=1.0)) if least < len(places) else 1.0
        lasts = float(b.z[self._plane.orbit.layout.durations][own.leg])
        found = Located(b.z, b.error, limit=least, data=share * lasts)
        return Outcome(
            "stopped",
            limited.limits[least].type.reason,
            f"{limited.stopped(found, b)} So it is to what the orbits are known to there ({b.error:.1e} of "
            "their size), and what the curve holds is not known nearer. To go on, start at a limit of the "
            "orbits beyond it.",
        )

    def _comes_to_a_loop(self, a: Sample, b: Sample) -> Outcome | None:
        """The end of a curve that comes to homoclinic or heteroclinic orbits.

        Its orbits have longer and longer periods, along hardly any way of the parameters, until what it holds
        is rounding, however fine the steps are.
        """
        if not (min(a.error, b.error) > CREEPING and b.period > a.period):
            return None
        orbit, own = self._plane.first(b.z)
        saddle = saddle_ahead(orbit, self._plane.first(a.z)[1], own)
        if saddle is None:
            return None
        return Outcome(
            "stopped",
            "homoclinic",
            f"The period runs off ({orbit.system.lasting(b.period, '.4g')} here) while the orbits creep past "
            f"the saddle {saddle}: the curve comes to homoclinic or heteroclinic orbits near "
            f"{place_of(self._problem, b.z)}, where double precision does not tell what it holds. Nothing to "
            "do.",
        )

    def _lost(self, a: Sample, b: Sample) -> Outcome | None:
        """The end of a curve where its orbits are not known to their own size any more.

        Further steps would go to and fro on errors, for hundreds of points.
        """
        length = float(np.linalg.norm((b.z - a.z) / a.weights))
        if not (a.error > GROWING and (b.error > UNKNOWN or length < BLIND * b.error)):
            return None
        return Outcome(
            "failed",
            "no_convergence",
            f"The curve cannot be followed beyond {place_of(self._problem, b.z)}: its orbits are known to "
            f"{b.error:.1e} of their size only, however fine the steps are. End the range before it.",
        )

    def _rejoins(self, a: Sample, b: Sample) -> Outcome | None:
        """The end of a curve whose orbits become their parent: one gone through twice, or its own image.

        Beyond it the same orbits follow, half a closure later or as images: so it is of tori of doubled
        orbits at a resonance 1:2, and of their folds at a generalized doubling.
        """
        before = {name: apart for name, apart in self._asymmetries(a.z).items() if apart > APPARENT}
        after = self._asymmetries(b.z) if before else {}
        for name, first in before.items():
            last = after.get(name, 0.0)
            share = first / (first + last)
            between = HermiteCurve((a.z, b.z), (a.tangent, b.tangent), a.weights).guess(share)
            left = self._asymmetries(between).get(name, np.inf)
            if last > APPARENT and left > PASSED * min(first, last):
                continue
            place = place_of(self._problem, between if last > APPARENT else b.z, 6)
            return Outcome(
                "complete",
                "rejoined",
                f"The orbits become the one that they were born from near {place}: its own curve has a point "
                "there at which this curve is born. Nothing to do.",
            )
        return None

    def _asymmetries(self, z: np.ndarray) -> Mapping[str, float]:
        """How far the orbit of z, shape (N + k + 2,), is from what a parent of it may be; {} if unknown."""
        there, own = self._plane.first(z)
        try:
            found: Mapping[str, float] = there.asymmetries(own)
        except NotFinite:
            return {}
        return found

    def _shrinks(self, a: Sample, b: Sample) -> Outcome | None:
        """The end of a curve whose cycles shrink to nothing, as folds do at a generalized Hopf point.

        Equilibria solve the equations there too, whatever the period: beyond such sizes Newton's method finds
        no way between both.
        """
        n, orbit = len(self._plane.orbit.system.states), self._plane.orbit
        if orbit.kind != "periodic_orbit" or orbit.forced or a.magnitudes is None or b.magnitudes is None:
            return None
        before, after = a.magnitudes[:n], b.magnitudes[:n]
        if not (np.all(after < NEARLY_SHRUNK * b.weights[:n]) and np.all(after < before)):
            return None
        return shrunk(
            f"The orbit shrinks onto an equilibrium near {place_of(self._problem, b.z, 6)}: a curve of Hopf "
            "points has a point there at which this curve is born. Nothing to do."
        )

    def unfolded(self, z: np.ndarray) -> bool:
        """Whether a branch point at z, shape (N + k + 2,), would need the equations to be others.

        What errors of the steps do to them is not that: it is asked again on the finest steps, and is none
        while it is no more than these leave.
        """
        problem = self._problem
        if not (problem.curve.unfolds and self._added(problem, z)):
            return False
        try:
            fine, weights = problem.finest(z, problem.weights), problem.weights
            normal = kernel_direction(fine.jacobian(z), weights) / weights**2
            z = newton_on(fine, z, weights, normal)
            known = fine.linearize(z).error_of(self._plane.size, normal, weights, fine.errors_at(z))
        except (ContwalkError, np.linalg.LinAlgError):
            return True
        return bool(abs(float(problem.further(z)[0])) > known and self._added(fine, z))

    def _added(self, problem: Any, z: np.ndarray) -> bool:
        """Whether what is added to the equations is more than their rounding; z as of `unfolded`."""
        change = float(problem.further(z)[0]) * problem.condition.system.unfolding[:, 0]
        return unfolds(problem.plane, z, change)

    def _orbits_end(self, a: Sample, b: Sample) -> Outcome | None:
        """Why the curve ends between two neighbouring orbits, if these do: they lie on one line."""
        n, change = self._plane.size, b.z - a.z
        share = float(np.linalg.norm(change[-2:] / a.weights[-2:]))
        weight = 1.0 / share if share > 0.0 else 1.0
        line, *places = self._between(a.z, b.z)
        seen = (
            replace(
                sample,
                z=place,
                tangent=np.append(sample.tangent[:n], 1.0),
                weights=np.append(sample.weights[:n], weight),
            )
            for sample, place in zip((a, b), places, strict=True)
        )
        found: Outcome | None = line.diagnosis.ended(*seen)
        return found

    def passed(self, a: np.ndarray, b: np.ndarray) -> Sequence[Met]:
        """What changes its piece on the way from an orbit to another solution, shape (N + k + 2,) each."""
        line, *places = self._between(a, b)
        found: Sequence[Met] = line.diagnosis.passed(*places)
        return found

    def _between(self, a: np.ndarray, b: np.ndarray) -> tuple[Any, np.ndarray, np.ndarray]:
        """The orbit on the line through two places, and its unknowns at both: at zero and at one."""
        n = self._plane.size
        return self._plane.on_tangent(a, b - a), np.append(a[:n], 0.0), np.append(b[:n], 1.0)

    def explain(self, z: np.ndarray) -> str:
        """Where in the plugin a residual at z is not finite.

        z has the shape (N + k + 2,).
        """
        there, own = self._plane.first(z)
        return str(there.diagnosis.explain(own))

    def obstacle(self, z: np.ndarray) -> str:
        """What makes orbits beside z hard to find, and what helps; empty if nothing is known of that.

        z has the shape (N + k + 2,).
        """
        there, own = self._plane.first(z)
        return str(there.diagnosis.obstacle(own))

    def many_branches(self, z: np.ndarray) -> bool:
        """Whether the curve's equations have two directions of solutions at z, to what they are known to.

        So they have where a force of no amplitude leaves an orbit's phase free. What the curve holds vanishes
        with all its derivatives there: its units are those of where its condition was made. z has the shape
        (N + k + 2,).
        """
        problem, n = self._problem, self._plane.size
        near = problem.near
        if near is None:
            return False
        jacobian, before = (problem.linearize(place).jacobian * near[1] for place in (z, near[0]))
        rows = np.append(problem.orbit.equation_scales, np.abs(before[n:]).max(axis=1))
        if not (np.all(np.isfinite(jacobian)) and np.all(rows > 0.0)):
            return False
        sizes = np.linalg.svd(jacobian / rows[:, None], compute_uv=False)
        return bool(sizes[-1] <= MANY * known_to(problem))


def _left_until_zero(first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """How far margins are from zero on a straight line through two values, in units of the way between.

    Infinite where they do not come nearer. All have the shape (k,).
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        left = last / (first - last)
    return np.where((last > 0.0) & (last < first), left, np.inf)

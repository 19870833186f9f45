"""Curves of special points of orbits as two parameters vary."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.errors import NotFinite, PluginError
from contwalk.numerics.linear import EPSILON, Factorization, unit_in
from contwalk.numerics.spectrum import taken_out
from contwalk.problems.capabilities import OwnMeasures, OwnMesh
from contwalk.problems.linearization import Linearization
from contwalk.problems.locus import adapting
from contwalk.problems.locus import orbit_marks as marks
from contwalk.problems.locus.curve_of_orbits import CurveOfOrbits
from contwalk.problems.locus.orbit_conditions import At
from contwalk.problems.locus.orbit_curve import OrbitCurve
from contwalk.problems.locus.orbit_diagnosis import OrbitLocusDiagnosis
from contwalk.problems.locus.orbit_limits import LimitsOnCurve, told
from contwalk.problems.locus.orbit_places import Held, OrbitPlane, evaluated
from contwalk.problems.locus.orbit_points.catalogue import POINT_TYPES
from contwalk.problems.locus.orbit_points.touches import inside
from contwalk.problems.locus.partners import partners
from contwalk.problems.orbit import augmented
from contwalk.problems.orbit.discretization import FINEST, SOLVED
from contwalk.problems.orbit.evaluations import Evaluations
from contwalk.problems.orbit.extents import sizes_since
from contwalk.problems.orbit.multipliers import GLOBAL
from contwalk.problems.parameter_line import ParameterLine
from contwalk.problems.problem import Located, PointType
from contwalk.problems.sample import Rates, Sample

# Linearizations that are kept.
MOST_KEPT = 12
TINY = float(np.finfo(float).tiny)


class OrbitLocus(CurveOfOrbits, OwnMeasures, OwnMesh):
    """A curve of special points of orbits in two parameters.

    Its unknowns are z = (u, v, second, first): those of the orbit, what the curve's condition has beside
    them, and both parameters. Its equations are the orbit's and the condition's. An instance is one
    discretisation, with the borders of its condition.

    Parameters
    ----------
    plane : OrbitPlane
    curve : OrbitCurve
    near : tuple of ndarray, optional
        A place on the curve and its weights, shape (N + k + 2,) each, that the condition is made near; None
        of a curve that is not discretised yet.
    """

    kind = "locus"
    location_tolerance = 1e-3

    def __init__(
        self, plane: OrbitPlane, curve: OrbitCurve, near: tuple[np.ndarray, np.ndarray] | None = None
    ) -> None:
        super().__init__(plane, curve)
        orbit = plane.orbit
        self.system, self.pins, self.states = orbit.system, orbit.pins, orbit.states
        self.discretization, self.subharmonic = orbit.discretization, orbit.subharmonic
        self.parameters, self.free = orbit.parameters, plane.free[0]
        self.line = ParameterLine(self.free, dict(self.parameters), None, plane.free[1])
        self.point_types: Sequence[PointType] = POINT_TYPES[curve.of]
        self.branching_offset = orbit.branching_offset
        self.known = Evaluations()
        self.near = near
        if near is not None:
            self.condition = self.held_near(*near, curve)

    def held_near(self, z: np.ndarray, weights: np.ndarray, curve: OrbitCurve) -> Held:
        """The curve's own condition, made near a place.

        z and weights have the shape (N + k + 2,).
        """
        there, own = self.plane.first(z)
        place = At(own, self.of_orbit(weights), float(weights[-2]), self.plane, float(z[-2]))
        return Held(
            curve.condition(there, place, self.further(z)),
            np.arange(self.plane.size, self.plane.size + curve.further),
        )

    @cached_property
    def limited(self) -> LimitsOnCurve | None:
        """The limits of orbits through events; None of others."""
        return None if self.orbit.limited is None else LimitsOnCurve(self)

    @property
    def weights(self) -> np.ndarray:
        """Typical magnitudes of the unknowns at the place that it was made near, shape (N + k + 2,)."""
        assert self.near is not None
        return self.near[1]

    @property
    def diagnosis(self) -> OrbitLocusDiagnosis:
        """What is known of places where a curve ends, or cannot go on."""
        return OrbitLocusDiagnosis(self)

    # -- equations -------------------------------------------------------------------------------------------

    def linearize(self, z: np.ndarray) -> Linearization:
        """The equations at z, shape (N + k + 2,); not finite where the borders do not fit."""
        return self.known.at("linearization", z, MOST_KEPT, lambda: self._linearized(z))

    def _linearized(self, z: np.ndarray) -> Linearization:
        try:
            residual, jacobian = evaluated(self.plane, len(z), z, [self.condition])
        except (np.linalg.LinAlgError, NotFinite):
            residual, jacobian = np.full(self.size, np.nan), np.full((self.size, self.size + 1), np.nan)
        return Linearization(
            residual,
            jacobian,
            lambda: (self._levels(z, jacobian), None),
            lambda: self.magnitudes_near(z),
            self.factored,
        )

    def jacobian(self, z: np.ndarray) -> np.ndarray:
        """DF(z), shape (N + k + 1, N + k + 2)."""
        return self.linearize(z).jacobian

    def factored(self, matrix: np.ndarray, weights: np.ndarray) -> Factorization:
        """A matrix of these equations and unknowns, and of borders that come last, factored.

        The matrix has the shape (m, m), the weights (m,).
        """
        found: Factorization = self.orbit.factored(matrix, weights)
        return found

    def _levels(self, z: np.ndarray, jacobian: np.ndarray) -> np.ndarray:
        """Rounding levels of the equations, or errors of the steps, shape (N + k + 1,)."""
        there, own = self.plane.first(z)
        rows, sizes = np.abs(jacobian[self.plane.size :]), np.abs(z)
        typical = np.nan_to_num(self.magnitudes_near(z))
        level = SOLVED * self.mesh.tolerance * (rows @ np.maximum(typical, TINY))
        system = self.condition.system
        bordered = isinstance(system, augmented.Augmented) and not system.in_units  # then terms are of one
        terms = rows @ sizes + float(bordered)
        return np.concatenate([there.linearize(own).levels[0], level + 8.0 * EPSILON * terms + TINY])

    def errors_at(self, z: np.ndarray) -> np.ndarray:
        """Estimated error of each equation at a solution, that of the steps among them.

        z has the shape (N + k + 2,).
        """
        there, own = self.plane.first(z)
        levels = self.linearize(z).levels[0][self.plane.size :]
        steps = GLOBAL * self.mesh.amplified / SOLVED
        return np.concatenate([there.errors_at(own), (1.0 + steps) * levels])

    def magnitudes_near(self, z: np.ndarray) -> np.ndarray:
        """Typical magnitudes of z, NaN where nothing tells, shape (N + k + 2,)."""
        there, own = self.plane.first(z)
        there.linearize(own)  # what it has passed is what tells them
        return self._with_parameters(there.magnitudes_near(own), z)

    def beginnings(self, z: np.ndarray) -> np.ndarray:
        """Typical magnitudes for the first corrections of a start, shape (N + k + 2,).

        Those of the parameters are no less than where the curve was made: one that happens to be zero would
        be held, and where the curve turns in it the start would go back to the turn.
        """
        there, own = self.plane.first(z)
        found = self._with_parameters(there.beginnings(own), z)
        if self.near is not None:
            found[-2:] = np.maximum(found[-2:], self.weights[-2:])
        return found

    def sizes_since(self, sample: Sample, begun: Sample) -> np.ndarray:
        """What weights of the metric grow with, shape (N + k + 2,), on a curve that began elsewhere."""
        there, _ = self.plane.first(sample.z)
        return sizes_since(there, sample, begun)

    def _with_parameters(self, own: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Magnitudes of the orbit's unknowns and the first parameter, with those of all others."""
        further = self.condition.system.scale[self.plane.size + 1 :]
        return np.concatenate([own[:-1], further, [max(abs(z[-2]), 1e-300)], own[-1:]])

    # -- what is watched -------------------------------------------------------------------------------------

    @property
    def observable_names(self) -> tuple[str, ...]:
        """Those of the orbits; along curves of tori the cosine of their angle as well."""
        return (*self.orbit.observable_names, *self.curve.observables)

    def examine(
        self,
        z: np.ndarray,
        tangent: np.ndarray,
        weights: np.ndarray,
        linearization: Linearization,
        before: int | None,
        known: Sample | None = None,
    ) -> Sample:
        """Everything that is watched at a solution; z, tangent and weights have the shape (N + k + 2,).

        `before` is how many multipliers were unstable at the solution before, None at the first; of `known`,
        its sample on other steps, the observables, the kinks and the reported state are taken over.
        """
        unit = unit_in(tangent, weights)
        there, own = self.on_tangent(z, unit, weights)
        given = (
            None if known is None else replace(known, observables=known.observables[: self.own_observables])
        )
        seen = there.examine(own.z, own.tangent, own.weights, there.linearize(own.z), None, given)
        critical = self.curve.critical(self.further(z))
        kept, staying = _beside(seen.eigenvalues, critical, partners(there, own.z, critical))
        measures = np.where(staying, -1.0, seen.measures[kept])
        errors = np.where(staying, 0.0, seen.errors[kept])
        orientation, error = linearization.orientation_and_error(unit, weights, self.errors_at(z))
        rates, factor = seen.rates, own.factor

        def of_values(which: np.ndarray) -> np.ndarray:
            return factor * rates.of_values(kept[which])

        return replace(
            seen,
            z=z,
            tangent=unit,
            weights=weights,
            orientation=orientation,
            error=error,
            eigenvalues=seen.eigenvalues[kept],
            errors=errors,
            measures=measures,
            rates=Rates(len(kept), lambda k: factor * rates[int(kept[k])], of_values=of_values),
            unstable=_unstable(measures, errors, before),
            resting=critical,
            observables=np.array([*seen.observables, *self.further(z)[: len(self.curve.observables)]]),
            margins=np.append(told(self.orbit, self.curve, seen.margins), inside(self.orbit, self.curve, z)),
            magnitudes=linearization.magnitudes,
            sizes=np.nan_to_num(linearization.magnitudes),
            excess=linearization.excess_in(weights),
        )

    @property
    def own_observables(self) -> int:
        """How many observables its orbits have; what the curve itself tells comes after them."""
        return len(self.orbit.observable_names)

    def on_tangent(self, z: np.ndarray, unit: np.ndarray, weights: np.ndarray) -> tuple[Any, _OnTangent]:
        """The orbit on the line along a unit tangent, and place, tangent and weights there.

        z, unit and weights have the shape (N + k + 2,).
        """
        there, n = self.plane.on_tangent(z, unit), self.plane.size
        share = float(np.linalg.norm(unit[-2:] / weights[-2:]))
        weight = 1.0 / share if share > 0.0 else 1.0
        tangent = np.append(unit[:n], 1.0 if share > 0.0 else 0.0)
        scale = np.append(weights[:n], weight)
        return there, _OnTangent(np.append(z[:n], 0.0), tangent, scale)

    def rate(self, name: str, sample: Sample) -> float:
        """Derivative of an observable, or of a free parameter, along the curve."""
        return marks.rate(self, name, sample)

    def locate_mark(self, name: str, level: float, sample: Sample) -> Located | None:
        """The point near a sample at which an observable, or a free parameter, has the value `level`."""
        return marks.located(self, name, level, sample)

    # -- special points --------------------------------------------------------------------------------------

    def located(self, system: augmented.Augmented | None, sample: Sample) -> Located | None:
        """The solution of a point's equations near a sample, refined when it is settled."""
        if system is None:
            return None
        try:
            return augmented.solved(self, system, sample)  # type: ignore[arg-type]
        except (np.linalg.LinAlgError, NotFinite, PluginError):
            return None

    # -- the branch ------------------------------------------------------------------------------------------

    def branch_facts(self) -> dict[str, Any]:
        """What is true of a whole curve, as fields of `BranchInfo`."""
        facts = self.orbit.branch_facts()
        settings = {key: value for key, value in facts["settings"].items() if key != "path"}
        return {
            **facts,
            "problem": self.kind,
            "free": self.plane.free,
            "observables": self.observable_names,
            "unknowns": facts["unknowns"] + self.curve.further + 1,
            "settings": {**settings, **self.curve.facts(), "of_problem": self.orbit.kind},
        }

    def on(
        self, orbit: Any, z: np.ndarray, weights: np.ndarray, curve: OrbitCurve | None = None
    ) -> OrbitLocus:
        """The same curve, or another one, of an orbit on other steps, with its condition made near a place.

        z and weights have the shape (N + k + 2,).
        """
        return OrbitLocus(OrbitPlane(orbit, self.plane.free), curve or self.curve, (z, weights))

    def at_stored(self, z: np.ndarray, weights: np.ndarray) -> OrbitLocus:
        """The curve discretised for a solution that is taken up again; both of shape (N + k + 2,)."""
        return self._made(z, weights, "at_stored")

    def adapted_to(self, z: np.ndarray, weights: np.ndarray, tolerance: float | None = None) -> OrbitLocus:
        """The curve on steps for the orbit of z.

        z and weights have the shape (N + k + 2,).
        """
        return self._made(z, weights, "adapted_to", tolerance)

    def refined(self, z: np.ndarray, weights: np.ndarray, tolerance: float | None = None) -> OrbitLocus:
        """The same curve on steps for located points.

        z and weights have the shape (N + k + 2,).
        """
        return self._made(z, weights, "refined", tolerance)

    def finest(self, z: np.ndarray, weights: np.ndarray) -> OrbitLocus:
        """The same curve on the finest steps that rounding allows.

        z and weights have the shape (N + k + 2,).
        """
        return self.refined(z, weights, FINEST)

    def _made(self, z: np.ndarray, weights: np.ndarray, how: str, *tolerance: float | None) -> OrbitLocus:
        there = self.plane.on_lines(z)[0]
        made = getattr(there, how)(self.of_orbit(z), self.of_orbit(weights), *tolerance)
        return self.on(made, z, weights)

    def adapted(self, sample: Sample) -> tuple[OrbitLocus, Sample]:
        """The curve with steps and borders made for what follows a solution, and its sample on it."""
        return adapting.adapted(self, sample)


class _OnTangent:
    """Place, tangent and weights of an orbit on the line along a curve's tangent, shape (N + 1,) each.

    `factor` is the length of that tangent: rates by its arclength times it are rates along the curve.
    """

    def __init__(self, z: np.ndarray, tangent: np.ndarray, weights: np.ndarray) -> None:
        self.z, self.tangent, self.weights = z, tangent, weights
        self.factor = float(np.linalg.norm(tangent / weights))


def _beside(values: np.ndarray, critical: np.ndarray, held: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of the multipliers that are left when the critical ones are taken out, in their order, those
    last that are held as their partners; and which these are.
    """
    others = np.array(taken_out(values, critical)[0], dtype=int)
    kept, last = taken_out(values[others], held)
    return others[kept + last], np.arange(len(others)) >= len(kept)


def _unstable(measures: np.ndarray, errors: np.ndarray, before: int | None) -> int:
    """How many multipliers are outside the unit circle; as many doubtful ones as there were before."""
    certain = int(np.count_nonzero(measures > errors))
    doubtful = int(np.count_nonzero(~(np.abs(measures) > errors)))
    return certain if before is None else int(np.clip(before, certain, certain + doubtful))

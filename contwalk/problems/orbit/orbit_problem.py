"""What orbits of both kinds offer to the engine in the same words."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, Self

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import NotFinite
from contwalk.numerics.linear import unit_in
from contwalk.problems.capabilities import OwnMeasures, OwnMesh
from contwalk.problems.kink import Kink, refuse
from contwalk.problems.orbit import (
    asymmetry,
    augmented,
    branching,
    equations,
    equivalence,
    facts,
    metric,
    mirror,
    monodromy,
    motion,
    observing,
    point_records,
    rates,
    remesh,
    reporting,
    switching,
    termination,
)
from contwalk.problems.orbit.diagnosis import OrbitDiagnosis
from contwalk.problems.orbit.discretization import FINEST
from contwalk.problems.orbit.extents import extent_along, sizes_since
from contwalk.problems.orbit.fine_steps import discretized
from contwalk.problems.orbit.kept_directions import kept_directions
from contwalk.problems.orbit.kinks_met import kinks_along
from contwalk.problems.orbit.multipliers import Multipliers
from contwalk.problems.orbit.orbit_equations import OrbitEquations
from contwalk.problems.orbit.orbit_section import into_section
from contwalk.problems.orbit.points.catalogue import POINT_TYPES
from contwalk.problems.orbit.points.point import OrbitPoint
from contwalk.problems.orbit.protocol import OrbitKind
from contwalk.problems.orbit.stretch import Stretch
from contwalk.problems.problem import Linearization, Sample, Seed
from contwalk.problems.unbounded import KNOWN


class OrbitProblem(OwnMeasures, OwnMesh, OrbitEquations):
    """The part of a problem of orbits that does not depend on how they are discretised."""

    first_passed, same = equivalence.first_passed, equivalence.same
    beginnings = metric.beginnings
    mirror = mirror.mirror_of
    reported = reporting.reported
    adapted, adapted_to = remesh.adapted, remesh.adapted_to
    sizes_since, into_section = sizes_since, into_section
    motion_of, slow_places = motion.motion, motion.slow_places
    locate, locate_mark, special_point = augmented.located, augmented.observed, point_records.described
    finely = discretized
    observable, rate, tangent_at = observing.value, rates.of_observable, branching.tangent_through
    kept_directions = kept_directions
    doubled_from, unfolded_from = switching.doubled, switching.unfolded
    asymmetries, returned_to_parent = asymmetry.of_moving, termination.returned_to_parent
    every_type: tuple[OrbitPoint, ...] = POINT_TYPES
    location_tolerance = 1e-3  # solutions are solved for to a part of the tolerance only

    @cached_property
    def point_types(self) -> tuple[OrbitPoint, ...]:
        """The kinds of special points of its branches, the system's own ones last."""
        return (*self.every_type, *self.system.point_types_of(OrbitPoint))

    def kinks_at_events(self, z: np.ndarray) -> tuple[Kink, ...]:
        """Kinks of guards, resets and conditions, where there are any. z has the shape (N + 1,)."""
        return ()

    # -- along a branch ----------------------------------------------------------------------------------

    def branch_facts(self) -> dict[str, Any]:
        """What is true of a whole branch of these orbits, as fields of `BranchInfo`."""
        return facts.branch_facts(self, self.observable_names)

    def admissible_at(self, z: np.ndarray) -> bool:
        """Whether a solution is one that the machine can move on: without limits, all are.

        z has the shape (N + 1,).
        """
        return True

    def examine(
        self,
        z: np.ndarray,
        tangent: np.ndarray,
        weights: np.ndarray,
        linearization: Linearization,
        before: int | None,
        known: Sample | None = None,
    ) -> Sample:
        """Everything that is watched at a solution; of `known`, its sample on other steps, the observables,
        the kinks and the reported state are taken over.

        z, tangent and weights have the shape (N + 1,).

        Raises
        ------
        NotFinite
            If the equations have no value there, as where a step of renewed ones has no solution.
        """
        if not linearization.finite:
            raise NotFinite(self.diagnosis.without_value(z) or "The equations have no finite value.", "")
        unit = unit_in(tangent, weights)
        jacobian = linearization.jacobian
        sharp = self.at_kinks(z)
        sharply = jacobian if sharp is self else sharp.jacobian(z)
        trivial = monodromy.trivial_error(sharp, z, sharply)
        found = monodromy.doubted(sharp, self.multipliers(z, jacobian), trivial, sharply)
        errors = equations.errors(self, linearization)
        orientation, error = linearization.orientation_and_error(unit, weights, errors)
        if self._stands_still(unit / weights**2, weights, linearization, errors, error):
            found = found.standing(trivial)
        met = kinks_along(self, z) if known is None else known.kinks
        refuse(met)
        # The flow's own multiplier is one exactly: what it misses by, the others may.
        accurate = replace(found, accuracy=max(found.accuracy, 2.0 * float(np.nan_to_num(trivial))))
        told: dict[str, Any] = {"spectrum_error": accurate.accuracy}
        told |= self._watched(z, accurate, error, known)
        return Sample(
            z=z,
            tangent=unit,
            weights=weights,
            orientation=orientation,
            eigenvalues=found.values,
            errors=found.errors,
            rates=rates.of_multipliers(self, z, unit, found),
            measures=found.measures,
            unstable=found.unstable(before),
            magnitudes=linearization.magnitudes,
            excess=linearization.excess_in(weights),
            error=error,
            critical=1.0,
            sizes=np.nan_to_num(linearization.magnitudes),
            extent=extent_along(self, z),
            period=self.duration(z),
            trivial_error=trivial,
            kinks=met,
            along=found.along,
            observables=self.observables(z, accurate) if known is None else known.observables,
            reported=self.reported(z) if known is None else known.reported,
            **told,
        )

    def _stands_still(
        self, row: np.ndarray, weights: np.ndarray, equations: Linearization, errors: np.ndarray, error: float
    ) -> bool:
        """Whether the parameter's share of the unit tangent is nothing but errors of the equations.

        These, of shape (N,), turn a branch by about as much as they move it: they change over the size of its
        solutions. `error` is what they do to this one, which is known to its size at least. The tangent's row
        of the bordered system and the weights have the shape (N + 1,).
        """
        share = abs(float(row[-1] * weights[-1])) / KNOWN
        known = share <= error < 1.0
        return known and share * weights[-1] <= equations.parameter_error(row, weights, errors)

    @abstractmethod
    def _watched(
        self, z: np.ndarray, found: Multipliers, error: float, known: Sample | None
    ) -> dict[str, Any]:
        """What a sample tells of one kind of orbits only."""

    # -- what is told of it ------------------------------------------------------------------------------

    @property
    def diagnosis(self) -> OrbitDiagnosis:
        """What is known of places where a branch ends, or cannot go on."""
        return OrbitDiagnosis(self)

    @property
    def observable_names(self) -> tuple[str, ...]:
        """Names of what is told of each solution."""
        return observing.names(self)

    def stretches(self, z: np.ndarray) -> list[Stretch[Any]]:
        """The legs of the whole motion, images included. z has the shape (N + 1,)."""
        there, own = self.explicit(z)
        return there.known.at("stretches", own, self.most_views, lambda: motion.stretches(there, own))

    def observables(self, z: np.ndarray, found: Multipliers) -> np.ndarray:
        """Values of `observable_names`, shape (o,)."""
        return np.array(observing.values(self, z, found))

    # -- discretisations ---------------------------------------------------------------------------------

    def at_stored(self, z: np.ndarray, weights: np.ndarray) -> Self:
        """The problem discretised for a solution that is taken up again.

        z and weights have the shape (N + 1,).
        """
        return self.adapted_to(z, weights)

    def refined(self, z: np.ndarray, weights: np.ndarray, tolerance: float | None = None) -> Self:
        """The same problem, section included, on steps for located points.

        z and weights have the shape (N + 1,).
        """
        there = self.adapted_to(z, weights, tolerance or self.discretization.marking)
        return there.varied(section=self.section)

    def finest(self, z: np.ndarray, weights: np.ndarray) -> Self:
        """The same problem on the finest steps that rounding allows.

        z and weights have the shape (N + 1,).
        """
        return self.refined(z, weights, FINEST)

    def leaving(self, kind: OrbitKind, point: SpecialPoint) -> Sequence[Seed]:
        """The branches that leave a special point of a kind."""
        z = np.array(point.unknowns)
        return kind.branches(self.finely(z), z, point)

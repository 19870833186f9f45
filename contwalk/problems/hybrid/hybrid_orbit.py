"""Periodic orbits through events as one free parameter varies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.memory import of_unowned
from contwalk.problems.hybrid import (
    coming_apart,
    end_maps,
    jumping_limits,
    leg_durations,
    limits,
    limits_in_words,
    locating_limits,
    margin_values,
    undefined,
)
from contwalk.problems.hybrid.adjacent import corner
from contwalk.problems.hybrid.diagnosis import HybridDiagnosis
from contwalk.problems.hybrid.hybrid_limits import HybridLimits
from contwalk.problems.hybrid.limited_orbit import MOST_VIEWS, LimitedOrbit
from contwalk.problems.hybrid.margins import Limit, Margins
from contwalk.problems.kink import Kink
from contwalk.problems.linearization import Fitted
from contwalk.problems.orbit.multipliers import Multipliers
from contwalk.problems.orbit.observing import split
from contwalk.problems.orbit.orbit_problem import OrbitProblem
from contwalk.problems.orbit.points.catalogue import LIMIT_TYPES, POINT_TYPES
from contwalk.problems.orbit.protocol import OrbitKind
from contwalk.problems.problem import Located, Sample, Seed, Test

# Multipliers whose difference has a smaller square meet, to rounding.
MEET = 1e-12


class HybridOrbit(LimitedOrbit, OrbitProblem):
    """Orbits of one itinerary: the legs' ends are the next ones' starts, and each ends where its guard is
    zero.

    Newton's method never looks for an event: durations are unknowns, and a guard is an equation. So the
    equations are smooth, and stay regular where an event grazes. An orbit without events is one leg that ends
    where it began; what is watched on it is watched as on any other. Where the last leg ends without an event
    the phase is fixed by an equation of its own: forced orbits begin where the force begins its period, the
    others in a section.

    Parameters
    ----------
    system : System
    itinerary : Itinerary
        Which mode follows which, through which transitions.
    parameters : mapping
        Values of all parameters.
    free : str
        Name of the free parameter, or `path`.
    path : tuple of two mappings, optional
        All parameters at its beginning and end, when `free` is `path`.
    pins : sequence of Neutral
        Neutral directions that are pinned along the branch.
    reference : ndarray, shape (n,), optional
        State at which pins without a parameter hold their direction.
    subharmonic : int
        The whole orbit of a forced system lasts so many of its periods.
    discretization : Discretization, optional
        Steps, segments and how exactly orbits are computed; by default chosen as the accuracy asks.
    """

    kind = "hybrid_orbit"
    every_type = (*POINT_TYPES, *LIMIT_TYPES)
    branching_offset = 0.05

    # -- what is told of it ------------------------------------------------------------------------------

    @property
    def limited(self) -> HybridLimits:
        """Its limits, and what lies beyond them."""
        return HybridLimits(self)

    @property
    def diagnosis(self) -> HybridDiagnosis:
        """What is known of places where a branch ends, or cannot go on."""
        return HybridDiagnosis(self)

    @cached_property
    def limits(self) -> tuple[Limit, ...]:
        """All that must stay positive for an orbit to be the machine's."""
        return limits.limits_of(self)

    def margins(self, z: np.ndarray) -> Margins:
        """Values of all limits at a solution. z has the shape (N + 1,)."""
        return self.known.at("margins", z, MOST_VIEWS, lambda: margin_values.margins(self, z))

    @property
    def fitted(self) -> Fitted:
        """What solves for durations of legs that are hard to guess."""
        return of_unowned(leg_durations.fitted, self)

    def admissible_at(self, z: np.ndarray) -> bool:
        """Whether a solution is one that the machine can move on. z has the shape (N + 1,)."""
        return self.margins(z).admissible

    # -- along a branch ----------------------------------------------------------------------------------

    def multipliers(self, z: np.ndarray, jacobian: np.ndarray) -> Multipliers:
        """Those of the closure map; none is known where it has one on each side. z has the shape (N + 1,)."""
        found = super().multipliers(z, jacobian)
        return found.doubted(np.inf) if self.itinerary.ordered else found

    def _watched(
        self, z: np.ndarray, found: Multipliers, error: float, known: Sample | None
    ) -> dict[str, Any]:
        """What a sample tells of such orbits only."""
        margins = self.margins(z)
        undefined.refuse_guards(self, z, margins)
        return {
            "margins": margins.relative,
            # What the orbit itself is not known to, its multipliers are not either.
            "spectrum_error": max(found.accuracy, error),
            "spectrum_accuracy": found.accuracy,
        }

    def kinks_at_events(self, z: np.ndarray) -> tuple[Kink, ...]:
        """Jumps of guards and resets that events lie on, and of guards through zero on the way; conditions
        at soft transitions that are not a number.

        z has the shape (N + 1,).
        """
        return *end_maps.lying(self, z), *jumping_limits.along(self, z), *undefined.conditions(self, z)

    # -- special points ----------------------------------------------------------------------------------

    def leaving(self, kind: OrbitKind, point: SpecialPoint) -> Sequence[Seed]:
        """The branches that leave a special point of a kind, but for those on which events come apart."""
        return [seed for seed in super().leaving(kind, point) if not coming_apart.along(seed)]

    def locate(self, kind: OrbitKind, sample: Sample, which: int) -> Located | None:
        """The special point of a kind near a sample, by its augmented system."""
        if kind.test is Test.MARGIN:
            return locating_limits.located(self, which, sample)
        return super().locate(kind, sample, which)

    def special_point(self, kind: OrbitKind, located: Located, sample: Sample, s: float) -> SpecialPoint:
        """The record of a located point of a kind, with its normal form, or what it is a limit of."""
        there = located.problem if located.problem is not None else self
        record = super().special_point(kind, located, sample, s)
        if kind.test is Test.MARGIN:
            limit = located.among(self.limits)
            name = limit.kind
            changes = limit.test in ("duration", "past")
            if changes and corner.has_corner(there, located.z, limit, sample.tangent):
                name = "corner"
            record = replace(record, kind=name, note=limits_in_words.place_of(there, limit, located))
        if kind.test is Test.MARK and abs(split(sample.eigenvalues)) < MEET:
            met = "two multipliers meet: each is known to the root of rounding only, their mean far better"
            record = replace(record, note=met if record.note is None else f"{record.note}; {met}")
        if coming_apart.critical(there, located.z, kind.multiplier, record.coefficients):
            note = "; ".join(filter(None, (record.note, coming_apart.told(there))))
            kept = {key: value for key, value in record.coefficients.items() if key == "theta"}
            record = replace(record, kind=None, criticality=None, coefficients=kept, note=note)
        values = there.margins(located.z)
        return replace(record, admissible=values.admissible, margin=values.by_name)

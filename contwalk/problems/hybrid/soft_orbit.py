"""Special points, limits and daughters of orbits of machines with soft transitions.

All of them need more than one derivative, and are asked of the explicit orbit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import NotFinite
from contwalk.numerics.linear import kernel_direction
from contwalk.problems.hybrid import locating_limits, softness
from contwalk.problems.hybrid.grouping import Grouping
from contwalk.problems.hybrid.hybrid_limits import HybridLimits
from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.hybrid.soft_equations import SoftEquations
from contwalk.problems.orbit.branching import amplitude, filled_magnitudes
from contwalk.problems.orbit.fine_steps import discretized
from contwalk.problems.orbit.itinerary import Itinerary
from contwalk.problems.orbit.protocol import OrbitKind
from contwalk.problems.problem import Linearization, Located, Sample, Seed, Test
from contwalk.system import System

# Special points lie beside other soft transitions than a step's ends: so often they are looked for anew.
MOST_WORDS = 4


class SoftOrbit(SoftEquations):
    """Orbits of one itinerary of hard transitions; parameters as of `HybridOrbit`."""

    @property
    def limited(self) -> SoftLimits:
        """Its limits, and what lies beyond them."""
        return SoftLimits(self)

    def examine(
        self,
        z: np.ndarray,
        tangent: np.ndarray,
        weights: np.ndarray,
        linearization: Linearization,
        before: int | None,
        known: Sample | None = None,
    ) -> Sample:
        """Everything that is watched at a solution; see `HybridOrbit.examine`.

        z, tangent and weights have the shape (N + 1,).
        """
        unit = tangent / float(np.linalg.norm(tangent / weights))
        there = self._at(z)
        explicit, unknowns = there.explicit, there.unknowns
        along, own = there.direction(unit), self._explicit_weights(explicit, weights)
        # Solved where it is, the explicit orbit is a solution as far as this one is.
        found = explicit.examine(unknowns, along, own, explicit.linearize(unknowns), before, known)
        orientation, error = linearization.orientation_and_error(unit, weights, self.errors_at(z))
        return replace(
            found,
            z=z,
            tangent=unit,
            weights=weights,
            orientation=orientation,
            rates=found.rates.scaled(float(np.linalg.norm(along / own))),
            magnitudes=linearization.magnitudes,
            excess=linearization.excess_in(weights),
            error=error,
            sizes=np.nan_to_num(linearization.magnitudes),
            margins=self.margins(z).relative,
        )

    def _explicit_sample(self, sample: Sample) -> tuple[HybridOrbit, Sample, float]:
        """A sample as one of the explicit orbit, and how much faster arclength grows there."""
        there = self._at(sample.z)
        along = there.direction(sample.tangent)
        weights = self._explicit_weights(there.explicit, sample.weights)
        length = float(np.linalg.norm(along / weights))
        own = replace(
            sample,
            z=there.unknowns,
            tangent=along / length,
            weights=weights,
            rates=sample.rates.scaled(1.0 / length),
            margins=there.explicit.margins(there.unknowns).relative,
        )
        return there.explicit, own, length

    def locate(self, kind: OrbitKind, sample: Sample, which: int) -> Located | None:
        """The special point of a kind near a sample, by its augmented system."""
        if kind.test is not Test.MARGIN:
            return self._located(sample, lambda explicit, own: explicit.locate(kind, own, which))

        def locate(explicit: HybridOrbit, own: Sample) -> Located | None:
            grouping = Grouping(explicit.itinerary, explicit.layout)
            chosen = self._least(grouping, explicit.margins(own.z), self.limits[which])
            return None if chosen is None else explicit.locate(kind, own, chosen)

        return self._located(sample, locate)

    def locate_mark(self, name: str, level: float, sample: Sample) -> Located | None:
        """The point near a sample at which an observable has the value `level`."""
        return self._located(sample, lambda explicit, own: explicit.locate_mark(name, level, own))

    def _located(
        self, sample: Sample, locate: Callable[[HybridOrbit, Sample], Located | None]
    ) -> Located | None:
        """A point located on the explicit orbit; anew where other soft transitions are met there."""
        problem = self
        for _ in range(MOST_WORDS):
            explicit, own, _ = problem._explicit_sample(sample)
            found = locate(explicit, own)
            if found is None or softness.holds(found.problem or explicit, found.z, unfolded=True):
                return self._wrapped(found)
            there = self._wrapped(found)
            assert there is not None
            sample = replace(sample, z=there.z)
            problem = self.adapted_to(there.z, sample.weights, self.mesh.tolerance)
        return None

    def _wrapped(self, found: Located | None) -> Located[Located] | None:
        """A point of explicit orbits as one of these, which has it as its data."""
        if found is None:
            return None
        other = self.around(found.problem, found.z)
        limit, critical, refine = found.limit, found.critical, found.refine
        if critical is not None:
            critical = other.inner.grouping.split(np.append(critical, 0.0))[0][:-1]
        return replace(
            found,
            z=other.inner.z,
            data=found,
            refine=None if refine is None else lambda: self._wrapped(refine()),
            problem=other,
            critical=critical,
            limit=None if limit is None else self._own_limit(found.problem, limit),
        )

    def rate(self, name: str, sample: Sample) -> float:
        """Derivative of an observable along the branch."""
        explicit, own, length = self._explicit_sample(sample)
        return explicit.rate(name, own) * length

    def tangent_at(self, located: Located[Located], near: Sample) -> np.ndarray | None:
        """At a branch point, the tangent of the branch that `near` is on. Shape (N + 1,)."""
        explicit, own, _ = self._explicit_sample(near)
        under = located.data
        if under.problem.itinerary != explicit.itinerary:
            there = self.adapted_to(located.z, near.weights)
            explicit, own, _ = there._explicit_sample(replace(near, z=located.z))
        tangent = explicit.tangent_at(under, own)
        if tangent is None:
            return None
        found = Grouping(under.problem.itinerary, under.problem.layout).split(tangent)[0]
        return found / float(np.linalg.norm(found / near.weights))

    def special_point(self, kind: OrbitKind, located: Located, sample: Sample, s: float) -> SpecialPoint:
        """The record of a located point of a kind, with its normal form, or what it is a limit of."""
        under, own = self._under(located, sample)
        record = under.problem.special_point(kind, under, own, s)
        if kind.test is Test.MARGIN and record.kind != "corner":
            record = replace(record, kind=located.among(self.limits).kind)
        return replace(record, unknowns=tuple(located.z.tolist()), tangent=tuple(sample.tangent.tolist()))

    def _under(self, located: Located[Located], sample: Sample) -> tuple[Located, Sample]:
        """A located point and the sample there, of the explicit orbit."""
        there = located.problem if located.problem is not None else self
        explicit, own, _ = there._explicit_sample(replace(sample, z=located.z))
        return located.data or replace(located, z=own.z, refined=False, problem=explicit), own

    def _stored(self, point: SpecialPoint) -> tuple[SoftOrbit, HybridOrbit, SpecialPoint]:
        """The problem discretised for a stored point, and the point as one of the explicit orbit's."""
        z = np.array(point.unknowns)
        there = discretized(self, z)
        assert isinstance(there, SoftOrbit)
        found = there._at(z)
        along = found.direction(np.array(point.tangent))
        own = replace(point, unknowns=tuple(found.unknowns.tolist()), tangent=tuple(along.tolist()))
        return there, found.explicit, own

    def leaving(self, kind: OrbitKind, point: SpecialPoint) -> Sequence[Seed]:
        """The branches that leave a special point of a kind."""
        try:
            _, explicit, own = self._stored(point)
        except NotFinite:
            return ()
        return [softened_seed(seed) for seed in explicit.leaving(kind, own)]


class SoftLimits(HybridLimits):
    """The limits of an orbit with soft transitions: those of the explicit one."""

    def __init__(self, orbit: SoftOrbit) -> None:
        super().__init__(orbit)
        self._soft = orbit

    def limit_of(self, point: SpecialPoint) -> int:
        """Which of the limits a special point is one of."""
        there, _, _ = self._soft._stored(point)
        return locating_limits.nearest(there, point)

    def stopped(self, located: Located, sample: Sample) -> str:
        """Why an orbit beyond a limit is not the machine's, and what lies next to it."""
        under, own = self._soft._under(located, sample)
        return under.problem.limited.stopped(under, own)

    def _beyond(self, point: SpecialPoint) -> tuple[Sequence[Seed], str]:
        try:
            _, explicit, own = self._soft._stored(point)
        except NotFinite as error:
            return (), f"No neighbour to switch to: the motion there cannot be taken up again ({error})."
        found, told = HybridLimits(explicit)._beyond(own)
        return [softened_seed(seed) for seed in found], told


# -- from explicit orbits ----------------------------------------------------------------------------------


def softened(explicit: HybridOrbit, unknowns: np.ndarray) -> tuple[HybridOrbit, np.ndarray]:
    """A discretised orbit as one whose itinerary leaves out soft transitions, if its machine has any."""
    if not _has_soft(explicit.system):
        return explicit, unknowns
    explicit, unknowns = softness.begun(explicit, unknowns)
    problem = explicit.like(SoftOrbit, softness.hard_itinerary(explicit.itinerary))
    there = problem.around(explicit, unknowns)
    return there, there.inner.z


def softened_seed(seed: Seed) -> Seed:
    """A seed of explicit orbits as one of `SoftOrbit`."""
    assert isinstance(seed.problem, HybridOrbit)
    if not _has_soft(seed.problem.system):
        return seed
    turned, unknowns = softness.begun(seed.problem, seed.z)
    problem, z = softened(turned, unknowns)
    assert isinstance(problem, SoftOrbit)
    grouping, reach = problem.inner.grouping, seed.reach
    assert seed.tangent is not None
    assert reach is not None
    if turned.itinerary == seed.problem.itinerary:
        tangent = grouping.split(seed.tangent)[0]
        return replace(
            seed,
            z=z,
            tangent=tangent,
            problem=problem,
            reach=lambda change: np.abs(grouping.split(reach(change))[0]),
        )
    tangent = kernel_direction(problem.jacobian(z), filled_magnitudes(problem, z))
    tangent = tangent * (np.sign(tangent[-1]) * np.sign(seed.tangent[-1]) or 1.0)
    return replace(seed, z=z, tangent=tangent, problem=problem, reach=amplitude(tangent))


def applies(system: System, itinerary: Itinerary) -> bool:
    """Whether an itinerary leaves out its machine's soft transitions."""
    return _has_soft(system) and not any(leg.soft for leg in itinerary.legs)


def _has_soft(system: System) -> bool:
    return any(transition.role == "soft" for transition in system.transitions)

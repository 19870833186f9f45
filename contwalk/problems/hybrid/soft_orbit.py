"""Orbits of machines with soft transitions: branches go through where these come and go.

At a soft transition the field switches continuously: the motion through it is once continuously
differentiable in its start, even where the switch and its reverse meet and vanish. So words leave these
transitions out, and the unknowns are those of the legs between hard ones; where there are none, of the whole
closure. Under them lies an orbit with a leg for every smooth piece (`explicit`): the further unknowns, states
and instants at the soft transitions, are solved for and eliminated, exactly. Which of them there are is found
by simulating each leg, and anew for every solution: it is a part of the discretisation, as steps are.

Everything that needs more than one derivative is asked of the explicit orbit: special points, normal forms,
limits.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import NotFinite
from contwalk.memory import remembered, unowned
from contwalk.numerics.linear import Factored, Factorization, kernel_direction
from contwalk.problems.hybrid import limit_points, softness
from contwalk.problems.hybrid.eliminated import Chord, Eliminated, corrected, reached
from contwalk.problems.hybrid.forward_solution import solved_forward
from contwalk.problems.hybrid.grouping import Grouping
from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.hybrid.margins import Limit, Margins
from contwalk.problems.hybrid.shooting import most_steps
from contwalk.problems.hybrid.stretch import Stretch
from contwalk.problems.hybrid.switching import discretized
from contwalk.problems.hybrid.view import LegView
from contwalk.problems.orbit.branching import amplitude, filled_magnitudes
from contwalk.problems.orbit.multipliers import Multipliers
from contwalk.problems.orbit.protocol import OrbitKind
from contwalk.problems.orbit.section import Section
from contwalk.problems.orbit.slow_place import SlowPlace
from contwalk.problems.orbit.word import Word
from contwalk.problems.problem import Linearization, Located, Sample, Seed, Test
from contwalk.system import System

# Special points lie beside other soft transitions than a step's ends: so often they are looked for anew.
MOST_WORDS = 4
# Sets of soft transitions that a discretisation has beside the one that it was made with.
MOST_FURTHER = 8


class SoftOrbit(HybridOrbit):
    """Orbits of one word of hard transitions; parameters as of `HybridOrbit`."""

    _inner: Eliminated | None = None
    _further: tuple[Eliminated, ...] = ()

    def _varied(self, **changes: Any) -> SoftOrbit:
        other = super()._varied(**changes)
        assert isinstance(other, SoftOrbit)
        for name in ("_expanded", "_approximate"):
            other.__dict__.pop(name, None)
        return other

    @property
    def inner(self) -> Eliminated:
        """The explicit orbit of this discretisation."""
        if self._inner is None:
            raise ValueError("the problem has no mesh yet: see `adapted_to`")
        return self._inner

    @property
    def cuttable(self) -> bool:
        """Whether legs may be cut into segments: legs that soft transitions divide anew are not."""
        return False

    # -- what lies under it ------------------------------------------------------------------------------

    def explicit_of(self, word: Word) -> HybridOrbit:
        """The orbits of a word with soft transitions in it, not discretised."""
        return self.like(HybridOrbit, word)

    def around(self, explicit: HybridOrbit, unknowns: np.ndarray) -> SoftOrbit:
        """This problem on the steps of an explicit orbit, which is discretised."""
        grouping = Grouping(explicit.word, explicit.layout)
        other = self._varied(_mesh=explicit.mesh, section=explicit.section, _further=())
        other._inner = Eliminated(explicit, grouping, *grouping.split(unknowns))
        return other

    def explicit(self, z: np.ndarray) -> tuple[HybridOrbit, np.ndarray]:
        """The explicit orbit and its unknowns at z, those between soft transitions solved for.

        Raises
        ------
        NotFinite
            If there is no motion over the legs.
        """
        found = self._at(z)
        return found.explicit, found.unknowns

    @property
    def most_kept(self) -> int:
        """How many of them are kept."""
        return self.inner.explicit.most_kept

    def remeshed(self, z: np.ndarray) -> SoftOrbit:
        """This problem with the soft transitions that are met over z beside those that it knows.

        Raises
        ------
        NotFinite
            If the motion over z ends early, or is none with its soft transitions solved for.
        """
        magnitudes = self.weighted(self.mesh.magnitudes)
        there = self.adapted_to(z, magnitudes, self.mesh.tolerance, self.section).inner
        if not (there.solved and np.array_equal(there.z, z)):
            raise NotFinite("The instants of the soft transitions have no solution there.", "")
        return self._varied(_further=(*self._further, there)[-MOST_FURTHER:])

    def _at(self, z: np.ndarray) -> Eliminated:
        """What is eliminated, solved for; where this problem knows no soft transitions for it, by others.

        Raises
        ------
        NotFinite
            If there are none.
        """

        def made() -> Eliminated:
            found = self._solved(z, self._near(z))
            return self.remeshed(z)._at(z) if found is None else found

        return remembered(self._expanded, z.tobytes(), self.most_kept, made)

    def _near(self, z: np.ndarray) -> Eliminated | None:
        """As `_at`, solved for as far as Newton's method for the rest needs it; None where others are needed.

        Both converge together: what is left of the one enters the other's equations, to first order.
        """
        return remembered(self._approximate, z.tobytes(), self.most_kept, lambda: self._reached(z))

    @cached_property
    def _expanded(self) -> dict[bytes, Eliminated]:
        return {}

    @cached_property
    def _approximate(self) -> dict[bytes, Eliminated | None]:
        return {}

    def _reached(self, z: np.ndarray) -> Eliminated | None:
        """What is eliminated at z, roughly, from the nearest of the orbits that are known to begin with.

        A solution of what is left must be one with the soft transitions that the machine meets.
        """
        weights = self.weighted(self.mesh.magnitudes)
        known = (self.inner, *self._further)
        for near in sorted(known, key=lambda each: float(np.linalg.norm((z - each.z) / weights))):
            found = reached(near, z, roughly=True)
            if found is not None and (found is near or _holds(found)):
                return found
        return None

    def _solved(self, z: np.ndarray, rough: Eliminated | None) -> Eliminated | None:
        """What is eliminated at z, from where it is known roughly."""
        if rough is None or rough.solved:
            return rough
        found = corrected(rough.explicit, rough.grouping, z, rough.soft - rough.correction)
        return found if found is not None and _holds(found) else None

    def mirror(self, sample: Sample) -> None:
        """Both halves are walked: that soft transitions are images of each other is not looked for."""

    def adapted_to(
        self,
        z: np.ndarray,
        weights: np.ndarray,
        tolerance: float | None = None,
        section: Section | None = None,
    ) -> SoftOrbit:
        """The problem with the soft transitions, and on steps, for the orbit of z; `section` as of any orbit.

        Raises
        ------
        NotFinite
            If the motion from z ends before the closure does.
        """
        word, states, lasting = softness.passed(self, z, self.magnitudes_of(weights))
        rough, begins = self.explicit_of(word), float(self.starting_times(z)[0])
        asked = tolerance or self.discretization.walking
        rough.section, rough._most_steps = self.section, most_steps(self._mesh, asked)
        unknowns = rough.assembled(states, lasting, z[self.layout.drifts], float(z[-1]), begins)
        explicit = rough.adapted_to(unknowns, self._explicit_weights(rough, weights), asked, section)
        grouping = Grouping(word, rough.layout)
        found = corrected(explicit, grouping, z, solved_forward(explicit, grouping, z, unknowns))
        there = self.around(explicit, unknowns)
        if found is not None:
            there._inner = there._expanded[z.tobytes()] = found
        return there

    def refined(self, z: np.ndarray, weights: np.ndarray, tolerance: float | None = None) -> SoftOrbit:
        """The same problem, section included, on steps for located points."""
        there = self.adapted_to(z, weights, tolerance or self.discretization.marking)
        if self.section is None:
            return there
        explicit, unknowns = there.explicit(z)
        assert isinstance(explicit, HybridOrbit)
        return there.around(explicit._varied(section=self.section), unknowns)

    # -- metric ------------------------------------------------------------------------------------------

    def _explicit_weights(self, explicit: HybridOrbit, weights: np.ndarray) -> np.ndarray:
        """Weights of explicit unknowns that stand for the same magnitudes."""
        layout, own = explicit.layout, self.layout
        share = np.sqrt(layout.legs / own.legs)
        result = explicit.weighted(self.magnitudes_of(weights))
        result[layout.durations] = weights[own.durations].mean() * share
        if layout.start is not None and own.start is not None:
            result[layout.start] = weights[own.start]
        result[layout.drifts], result[-1] = weights[own.drifts] * share, weights[-1]
        return result

    def magnitudes_near(self, z: np.ndarray) -> np.ndarray:
        """Half the range of each state over the orbit; declared scales where there are any."""
        explicit, unknowns = self.explicit(z)
        found, layout, own = explicit.magnitudes_near(unknowns), explicit.layout, self.layout
        share, result = np.sqrt(own.legs / layout.legs), np.full(self.size + 1, np.nan)
        for i, group in enumerate(self._at(z).grouping.groups):
            result[own.states[i]] = found[layout.states[group[0]]] * share
        result[own.durations] = found[layout.durations.start] * share
        if own.start is not None:
            result[own.start] = found[layout.start]
        result[own.drifts], result[-1] = found[layout.drifts] * share, found[-1]
        return result

    @property
    def equation_scales(self) -> np.ndarray:
        """Units of the equations, shape (N,)."""
        return self.inner.explicit.equation_scales[self.inner.grouping.hard_rows]

    @property
    def cost(self) -> int:
        """Right-hand sides of one pass with derivatives."""
        return self.inner.explicit.cost

    # -- equations ---------------------------------------------------------------------------------------

    def _linearized(self, z: np.ndarray) -> Linearization:
        found, magnitudes = self._near(z), unowned(self.magnitudes_near)
        if found is None:
            lost, remeshed = np.full((self.size, self.size + 1), np.nan), unowned(self.remeshed)
            levels = np.ones(self.size)
            return Linearization(lost[:, 0], lost, lambda: (levels, None), remeshed=lambda: remeshed(z))
        return Linearization(
            found.residual,
            found.jacobian,
            lambda: (found.levels(found.explicit.linearize(found.unknowns).levels[0]), None),
            lambda: magnitudes(z),
            nearby=lambda: Chord(found).residual,
        )

    def factored(self, matrix: np.ndarray, weights: np.ndarray) -> Factorization:
        """A bordered Jacobian, factored."""
        return Factored(matrix, weights)

    def examine(
        self,
        z: np.ndarray,
        tangent: np.ndarray,
        weights: np.ndarray,
        linearization: Linearization,
        before: int | None,
        known: Sample | None = None,
    ) -> Sample:
        """Everything that is watched at a solution; see `HybridOrbit.examine`."""
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

    def errors_at(self, z: np.ndarray) -> np.ndarray:
        """Estimated error of each equation at a solution."""
        there = self._at(z)
        return there.levels(there.explicit.errors_at(there.unknowns))

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

    # -- what is told of an orbit ------------------------------------------------------------------------

    def view(self, z: np.ndarray) -> tuple[LegView, ...]:
        """A solution looked at piece by piece."""
        explicit, unknowns = self.explicit(z)
        return explicit.view(unknowns)

    def pieces_of(self, z: np.ndarray, i: int) -> list[LegView]:
        """Leg i looked at, piece by piece."""
        views = self.view(z)
        return [views[k] for k in self._at(z).grouping.groups[i]]

    def stretches(self, z: np.ndarray) -> list[Stretch]:
        """The pieces of the whole motion, soft transitions included."""
        explicit, unknowns = self.explicit(z)
        return explicit.stretches(unknowns)

    def multipliers(self, z: np.ndarray, jacobian: np.ndarray) -> Multipliers:
        """Multipliers of the closure."""
        explicit, unknowns = self.explicit(z)
        return explicit.multipliers(unknowns, explicit.jacobian(unknowns))

    def observables(self, z: np.ndarray, found: Multipliers) -> np.ndarray:
        """Values of `observable_names`, shape (o,)."""
        explicit, unknowns = self.explicit(z)
        return explicit.observables(unknowns, found)

    def motion_of(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The whole motion: times in seconds, (k,), and states, (k, n)."""
        explicit, unknowns = self.explicit(z)
        return explicit.motion_of(unknowns)

    def reported(self, z: np.ndarray) -> np.ndarray:
        """The state that stands for a solution, shape (n,)."""
        explicit, unknowns = self.explicit(z)
        return explicit.reported(unknowns)

    def flow_direction(self, z: np.ndarray, i: int, j: int = 0) -> np.ndarray:
        """What a later start of leg i on the same orbit differs by."""
        there = self._at(z)
        return there.explicit.flow_direction(there.unknowns, there.grouping.groups[i][0], j)

    def slow_places(self, z: np.ndarray) -> list[SlowPlace]:
        """Where the orbit is slower than beside, and the field there; the slowest place first."""
        explicit, unknowns = self.explicit(z)
        return explicit.slow_places(unknowns)

    # -- limits ------------------------------------------------------------------------------------------

    @cached_property
    def limits(self) -> tuple[Limit, ...]:
        """All that must stay positive, whichever soft transitions there are."""
        return softness.limits_of(self.system, self.word)

    def margins(self, z: np.ndarray) -> Margins:
        """Values of all limits at a solution."""
        there = self._at(z)
        found = there.explicit.margins(there.unknowns)
        chosen = [self._least(there.grouping, found, limit) for limit in self.limits]
        rows = [
            (np.inf, 1.0, np.nan) if k is None else (found.values[k], found.scales[k], found.places[k])
            for k in chosen
        ]
        for k, limit in enumerate(self.limits):
            if limit.test == "duration":
                rows[k] = float(z[self.layout.durations][limit.leg]), self.mesh.total, 1.0
        values, scales, places = np.array(rows, dtype=float).reshape(len(rows), 3).T
        return Margins(self.limits, values, scales, places)

    def _least(self, grouping: Grouping, found: Margins, limit: Limit) -> int | None:
        """Which of the explicit orbit's limits is the least of those that one stands for."""
        group = grouping.groups[limit.leg]
        legs = {"start": group[:1], "leaving": group[:1], "end": group[-1:]}.get(limit.test, group)
        fitting = [
            k
            for k, other in enumerate(found.limits)
            if other.leg in legs
            and (other.name, other.test) == (limit.name, limit.test)
            and not np.isinf(found.values[k])
        ]
        # What has no value is less than all that have one: it must not be hidden by them.
        return min(fitting, key=lambda k: float(np.nan_to_num(found.relative[k], nan=-np.inf)), default=None)

    def _own_limit(self, explicit: HybridOrbit, which: int) -> int:
        """The limit that one of the explicit orbit's is a case of."""
        other = explicit.limits[which]
        groups = Grouping(explicit.word, explicit.layout).groups
        leg = next(i for i, group in enumerate(groups) if other.leg in group)
        return next(
            k
            for k, limit in enumerate(self.limits)
            if (limit.leg, limit.name, limit.test) == (leg, other.name, other.test)
        )

    def limit_of(self, point: SpecialPoint) -> int:
        """Which of the limits a special point is one of."""
        there, _, _ = self._stored(point)
        return limit_points.nearest(there, point)

    # -- special points ----------------------------------------------------------------------------------

    def locate(self, kind: OrbitKind, sample: Sample, which: int) -> Located | None:
        """The special point of a kind near a sample, by its augmented system."""
        if kind.test is not Test.MARGIN:
            return self._located(sample, lambda explicit, own: explicit.locate(kind, own, which))

        def locate(explicit: HybridOrbit, own: Sample) -> Located | None:
            grouping = Grouping(explicit.word, explicit.layout)
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
            if found is None or softness.holds(found.problem or explicit, found.z):
                return self._wrapped(found)
            there = self._wrapped(found)
            assert there is not None
            sample = replace(sample, z=there.z)
            problem = self.adapted_to(there.z, sample.weights, self.mesh.tolerance)
        return None

    def _wrapped(self, found: Located | None) -> Located | None:
        """A point of explicit orbits as one of these."""
        if found is None:
            return None
        other = self.around(found.problem, found.z)
        vectors: dict[str, Any] = {**found.vectors, "explicit": found}
        if "limit" in vectors:
            vectors["limit"] = self._own_limit(found.problem, int(vectors["limit"]))
        refine = found.refine
        return Located(
            other.inner.z,
            found.error,
            vectors,
            found.refined,
            None if refine is None else lambda: self._wrapped(refine()),
            other,
        )

    def rate(self, name: str, sample: Sample) -> float:
        """Derivative of an observable along the branch."""
        explicit, own, length = self._explicit_sample(sample)
        return explicit.rate(name, own) * length

    def tangent_at(self, located: Located, near: Sample) -> np.ndarray | None:
        """At a branch point, the tangent of the branch that `near` is on."""
        explicit, own, _ = self._explicit_sample(near)
        under = located.vectors["explicit"]
        if under.problem.word != explicit.word:
            there = self.adapted_to(located.z, near.weights)
            explicit, own, _ = there._explicit_sample(replace(near, z=located.z))
        tangent = explicit.tangent_at(under, own)
        if tangent is None:
            return None
        found = Grouping(under.problem.word, under.problem.layout).split(tangent)[0]
        return found / float(np.linalg.norm(found / near.weights))

    def special_point(self, kind: OrbitKind, located: Located, sample: Sample, s: float) -> SpecialPoint:
        """The record of a located point of a kind, with its normal form, or what it is a limit of."""
        under, own = self._under(located, sample)
        record = under.problem.special_point(kind, under, own, s)
        if kind.test is Test.MARGIN and record.kind != "corner":
            record = replace(record, kind=self.limits[int(located.vectors["limit"])].kind)
        return replace(record, unknowns=tuple(located.z.tolist()), tangent=tuple(sample.tangent.tolist()))

    def _under(self, located: Located, sample: Sample) -> tuple[Located, Sample]:
        """A located point and the sample there, of the explicit orbit."""
        there = located.problem if located.problem is not None else self
        explicit, own, _ = there._explicit_sample(replace(sample, z=located.z))
        under = located.vectors.get("explicit")
        return under or Located(own.z, located.error, located.vectors, problem=explicit), own

    def stopped(self, located: Located, sample: Sample) -> str:
        """Why an orbit beyond a limit is not the machine's, and what lies next to it."""
        under, own = self._under(located, sample)
        return under.problem.stopped(under, own)

    # -- the branches that leave -------------------------------------------------------------------------

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

    def _beyond(self, point: SpecialPoint) -> tuple[Sequence[Seed], str]:
        try:
            _, explicit, own = self._stored(point)
        except NotFinite as error:
            return (), f"No neighbour to switch to: the motion there cannot be taken up again ({error})."
        found, told = explicit._beyond(own)
        return [softened_seed(seed) for seed in found], told


# -- from explicit orbits ----------------------------------------------------------------------------------


def softened(explicit: HybridOrbit, unknowns: np.ndarray) -> tuple[HybridOrbit, np.ndarray]:
    """A discretised orbit as one whose word leaves out soft transitions, if its machine has any."""
    if not _has_soft(explicit.system):
        return explicit, unknowns
    explicit, unknowns = softness.begun(explicit, unknowns)
    problem = explicit.like(SoftOrbit, softness.hard_word(explicit.word))
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
    if turned.word == seed.problem.word:
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


def _holds(found: Eliminated) -> bool:
    """Whether what is nearly a solution is one with the soft transitions that the machine meets."""
    return not found.settles or softness.holds(found.explicit, found.unknowns)


def applies(system: System, word: Word) -> bool:
    """Whether a word leaves out its machine's soft transitions."""
    return _has_soft(system) and not any(leg.soft for leg in word.legs)


def _has_soft(system: System) -> bool:
    return any(transition.role == "soft" for transition in system.transitions)

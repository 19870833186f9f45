"""Orbits of machines with soft transitions: branches go through where these come and go.

At a soft transition the field switches continuously: the motion through it is once continuously
differentiable in its start, even where the switch and its reverse meet and vanish. So itineraries leave these
transitions out, and the unknowns are those of the legs between hard ones; where there are none, of the whole
closure. Under them lies an orbit with a leg for every smooth piece (`explicit`): the further unknowns, states
and instants at the soft transitions, are solved for and eliminated, exactly. Which of them there are is found
by simulating each leg, and anew for every solution: it is a part of the discretisation, as steps are.

Everything that needs more than one derivative is asked of the explicit orbit: special points, normal forms,
limits.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any, Self

import numpy as np

from contwalk.errors import NotFinite
from contwalk.memory import unowned
from contwalk.numerics.linear import Factored, Factorization
from contwalk.problems.hybrid import softness
from contwalk.problems.hybrid.eliminated import Chord, Eliminated, OnLine, corrected, reached
from contwalk.problems.hybrid.forward_solution import solved_forward
from contwalk.problems.hybrid.grouping import Grouping
from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.hybrid.margins import Limit, Margins
from contwalk.problems.hybrid.view import GuardedView
from contwalk.problems.orbit.meshing import most_steps
from contwalk.problems.orbit.multipliers import Multipliers
from contwalk.problems.orbit.section import Section
from contwalk.problems.problem import Linearization

# Sets of soft transitions that a discretisation has beside the one that it was made with.
MOST_FURTHER = 8


class SoftEquations(HybridOrbit):
    """The equations of orbits of one itinerary of hard transitions; parameters as of `HybridOrbit`."""

    _inner: Eliminated | None = None
    _further: tuple[Eliminated, ...] = ()
    # Whether soft transitions that it does not know are looked for at once: on one of the many lines through
    # a plane of two parameters nobody goes on with the problem that knows them.
    _seeks = False

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

    def varied(self, **changes: Any) -> Self:
        """The same with some attributes changed; on another line its explicit orbits are those of that
        line.
        """
        other = super().varied(**changes)
        if "line" in changes:
            other._seeks = True
            known = [] if self._inner is None else [self._inner]
            moved = [OnLine(each, changes["line"]) for each in (*known, *self._further)]
            other._inner, other._further = (moved[0] if known else None), tuple(moved[len(known) :])
        return other

    def around(self, explicit: HybridOrbit, unknowns: np.ndarray) -> Self:
        """This problem on the steps of an explicit orbit, which is discretised.

        Unknowns have the shape (N + 1,) of the explicit orbit.
        """
        grouping = Grouping(explicit.itinerary, explicit.layout)
        other = self.varied(_mesh=explicit.mesh, section=explicit.section, _further=())
        other._inner = Eliminated(explicit, grouping, *grouping.split(unknowns))
        return other

    def explicit(self, z: np.ndarray) -> tuple[HybridOrbit, np.ndarray]:
        """The explicit orbit and its unknowns at z, those between soft transitions solved for.

        Both have the shape (N + 1,) of their problem.

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

    def remeshed(self, z: np.ndarray) -> Self:
        """This problem with the soft transitions that are met over z beside those that it knows.

        z has the shape (N + 1,).

        Raises
        ------
        NotFinite
            If the motion over z ends early, or is none with its soft transitions solved for.
        """
        magnitudes = self.weighted(self.mesh.magnitudes)
        there = self.adapted_to(z, magnitudes, self.mesh.tolerance, self.section).inner
        if not (there.solved and np.array_equal(there.z, z)):
            raise NotFinite("The instants of the soft transitions have no solution there.", "")
        return self.varied(_further=(*self._further, there)[-MOST_FURTHER:])

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

        return self.known.at("expanded", z, self.most_kept, made)

    def _near(self, z: np.ndarray) -> Eliminated | None:
        """As `_at`, solved for as far as Newton's method for the rest needs it; None where others are needed.

        Both converge together: what is left of the one enters the other's equations, to first order.
        """
        return self.known.at("approximate", z, self.most_kept, lambda: self._reached(z))

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

    def _sought(self, z: np.ndarray) -> Eliminated | None:
        """What is eliminated at z with soft transitions that are looked for, where that is done at once."""
        try:
            return self._at(z) if self._seeks else None
        except NotFinite:
            return None

    def _solved(self, z: np.ndarray, rough: Eliminated | None) -> Eliminated | None:
        """What is eliminated at z, from where it is known roughly."""
        if rough is None or rough.solved:
            return rough
        found = corrected(rough.explicit, rough.grouping, z, rough.soft - rough.correction)
        return found if found is not None and _holds(found) else None

    def adapted_to(
        self,
        z: np.ndarray,
        weights: np.ndarray,
        tolerance: float | None = None,
        section: Section | None = None,
    ) -> Self:
        """As of any orbit, with the soft transitions of that of z. z and weights have the shape (N + 1,)."""
        itinerary, states, lasting = softness.passed(self, z, self.magnitudes_of(weights))
        rough, begins = self.like(HybridOrbit, itinerary), float(self.starting_times(z)[0])
        asked = tolerance or self.discretization.walking
        rough.section, rough.most_steps = self.section, most_steps(self._mesh, asked)
        unknowns = rough.assembled(states, lasting, z[self.layout.drifts], float(z[-1]), begins)
        explicit = rough.adapted_to(unknowns, self._explicit_weights(rough, weights), asked, section)
        grouping = Grouping(itinerary, rough.layout)
        found = corrected(explicit, grouping, z, solved_forward(explicit, grouping, z, unknowns))
        there = self.around(explicit, unknowns)
        if found is not None:
            there._inner = there.known.at("expanded", z, 1, lambda: found)
        return there

    def refined(self, z: np.ndarray, weights: np.ndarray, tolerance: float | None = None) -> Self:
        """The same problem, section included, on steps for located points.

        z and weights have the shape (N + 1,).
        """
        there = self.adapted_to(z, weights, tolerance or self.discretization.marking)
        if self.section is None:
            return there
        explicit, unknowns = there.explicit(z)
        assert isinstance(explicit, HybridOrbit)
        return there.around(explicit.varied(section=self.section), unknowns)

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
        """Half the range of each state over the orbit; declared scales where there are any.

        Both have the shape (N + 1,).
        """
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

    def _linearized(self, z: np.ndarray) -> Linearization:
        found, magnitudes = self._near(z) or self._sought(z), unowned(self.magnitudes_near)
        if found is None:
            lost, remeshed = np.full((self.size, self.size + 1), np.nan), unowned(self.remeshed)
            levels = np.ones(self.size)
            return Linearization(lost[:, 0], lost, lambda: (levels, None), remeshed=lambda: remeshed(z))
        there = Linearization(
            found.residual,
            found.jacobian,
            lambda: (found.levels(found.explicit.linearize(found.unknowns).levels[0]), None),
            lambda: magnitudes(z),
            nearby=lambda: Chord(found).residual,
        )
        there.dear = True  # soft transitions are solved for in each
        return there

    def factored(self, matrix: np.ndarray, weights: np.ndarray) -> Factorization:
        """A bordered Jacobian, factored. The matrix has the shape (m, m), the weights (m,)."""
        return Factored(matrix, weights)

    def errors_at(self, z: np.ndarray) -> np.ndarray:
        """Estimated error of each equation at a solution. z has the shape (N + 1,), the errors (N,)."""
        there = self._at(z)
        return there.levels(there.explicit.errors_at(there.unknowns))

    def pieces_of(self, z: np.ndarray, i: int) -> list[GuardedView]:
        """Leg i looked at, piece by piece. z has the shape (N + 1,)."""
        views = self.view(z)
        return [views[k] for k in self._at(z).grouping.groups[i]]

    def multipliers(self, z: np.ndarray, jacobian: np.ndarray) -> Multipliers:
        """Multipliers of the closure. z has the shape (N + 1,), the jacobian (N, N + 1)."""
        explicit, unknowns = self.explicit(z)
        return explicit.multipliers(unknowns, explicit.jacobian(unknowns))

    def at_kinks(self, z: np.ndarray) -> Self:
        """Itself: the steps are those of the explicit orbit, which looks after its own.

        z has the shape (N + 1,).
        """
        return self

    @cached_property
    def limits(self) -> tuple[Limit, ...]:
        """All that must stay positive, whichever soft transitions there are."""
        return softness.limits_of(self.system, self.itinerary)

    def margins(self, z: np.ndarray) -> Margins:
        """Values of all limits at a solution. z has the shape (N + 1,)."""
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
        groups = Grouping(explicit.itinerary, explicit.layout).groups
        leg = next(i for i, group in enumerate(groups) if other.leg in group)
        return next(
            k
            for k, limit in enumerate(self.limits)
            if (limit.leg, limit.name, limit.test) == (leg, other.name, other.test)
        )


def _holds(found: Eliminated) -> bool:
    """Whether what is nearly a solution is one with the soft transitions that the machine meets."""
    return not found.settles or softness.holds(found.explicit, found.unknowns)

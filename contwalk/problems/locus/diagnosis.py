"""Where a curve of equilibria ends, or cannot go on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contwalk.branch import Outcome
from contwalk.problems.capabilities import Diagnosis
from contwalk.problems.equilibrium.diagnosis import EquilibriumDiagnosis
from contwalk.problems.equilibrium.unbounded import escape
from contwalk.problems.kink import Kink, Met
from contwalk.problems.locus.lead import lead_of_others
from contwalk.problems.locus.persistence import NOTHING, not_persistent
from contwalk.problems.sample import Sample

# Unknowns this small against their magnitudes may be zero.
NOISE = 1e-13


@dataclass(frozen=True)
class LocusDiagnosis(Diagnosis):
    """What is known of such places: what is known of the equilibria themselves, and of the curve's condition.

    `problem` is an `EquilibriumLocus`.
    """

    problem: Any

    def ended(self, a: Sample, b: Sample) -> Outcome | None:
        """Branch points that do not persist, an eigenvalue that is marked no longer, and what runs off."""
        return self._unfolded(b) or self._overtaken(a, b) or self._escaped(a, b)

    def end_functions(self, sample: Sample) -> tuple[float, ...]:
        """How far other eigenvalues are ahead of those that are marked; how near a pair is to being real."""
        return lead_of_others(self.problem, sample.z, sample.eigenvalues)

    def explain(self, z: np.ndarray) -> str:
        """Where in the plugin a residual at z, shape (N + 1,), is not finite."""
        return EquilibriumDiagnosis(self.problem.plane).explain(self.problem.in_plane(z))

    def passed(self, a: np.ndarray, b: np.ndarray) -> Sequence[Met]:
        """Where the equilibria's equations change their piece between two places, shape (N + 1,)."""
        within = self.problem.in_plane
        return EquilibriumDiagnosis(self.problem.plane).passed(within(a), within(b))

    def kinks_between(self, a: Sample, b: Sample) -> Sequence[Kink]:
        """Where the equilibria's equations are smooth by pieces only."""
        within = self.problem.in_plane
        places = (replace(s, z=within(s.z), weights=within(s.weights)) for s in (a, b))
        return EquilibriumDiagnosis(self.problem.plane).kinks_between(*places)

    def unfolded(self, z: np.ndarray) -> bool:
        """Whether a branch point at z, shape (N + 1,), would need the equations to be others."""
        problem = self.problem
        (condition,) = problem.augmented.conditions
        if condition.unfolding is None:
            return False
        added, place = abs(problem.own(z)) * np.abs(condition.unfolding), problem.in_plane(z)
        levels, magnitudes = problem.plane.linearize(place).levels
        if np.all(added <= NOTHING * levels):
            return False
        # An equation of which nothing but noise of zero is left has no level: that of the others is what
        # Newton's method ends at.
        noise = np.abs(place) < NOISE * magnitudes
        return not (np.any(noise[: problem.plane.size]) and np.all(added <= NOTHING * np.max(levels)))

    def _unfolded(self, b: Sample) -> Outcome | None:
        """The end where a branch point is none any more."""
        if not self.unfolded(b.z):
            return None
        return Outcome("failed", "no_convergence", not_persistent(self.problem, b.z))

    def _overtaken(self, a: Sample, b: Sample) -> Outcome | None:
        """The end of a curve of the largest real part where that is another eigenvalue's."""
        problem = self.problem
        level = problem.curve.real_part
        if level is None:
            return None
        ahead, *past_real = self.end_functions(b)
        known = 1e-9 * max(abs(level), float(np.abs(b.eigenvalues).max()))
        if ahead <= known and all(past < 0.0 for past in past_real):
            return None
        first = problem.free
        return Outcome(
            "complete",
            "stop_at",
            f"The largest real part is another eigenvalue's beyond {first} = {a.parameter:.10g}: the curve "
            f"of max_re = {level:.10g} goes on there with that one, as another branch.",
        )

    def _escaped(self, a: Sample, b: Sample) -> Outcome | None:
        """The end of a curve along which a state or the second parameter grows without bound."""
        problem = self.problem

        def unknown(which: int) -> str | None:
            states = dict(enumerate(problem.system.state_names))
            return str(problem.plane.second) if which == len(b.z) - 2 else states.get(which)

        return escape(problem, a, b, unknown, "The curve runs off")

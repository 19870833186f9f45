"""The boundaries of the mode of an equilibrium, as limits of its branch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.equilibrium import boundaries as boundary
from contwalk.problems.equilibrium.beyond_boundary import beyond
from contwalk.problems.equilibrium.boundaries import Boundary, boundaries_of
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.equilibrium.points.boundary import BOUNDARY_EQUILIBRIUM
from contwalk.problems.problem import Limit, LimitType, Located, Sample, Seed


@dataclass(frozen=True)
class ModeLimit(Boundary):
    """A boundary as a `Limit`."""

    kind: str | None = None

    @property
    def type(self) -> LimitType:
        """The kind of special point where its guard is zero."""
        return BOUNDARY_EQUILIBRIUM


class ModeLimits:
    """The boundaries of the mode of an equilibrium; a `Limited`.

    Parameters
    ----------
    problem : EquilibriumEquations
    """

    def __init__(self, problem: EquilibriumEquations) -> None:
        self._problem = problem

    @cached_property
    def limits(self) -> Sequence[Limit]:
        """All of them, in the order of their declaration."""
        return tuple(ModeLimit(each.transition, each.rank) for each in self._boundaries)

    @cached_property
    def _boundaries(self) -> tuple[Boundary, ...]:
        return boundaries_of(self._problem.system)

    def margins(self, z: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Those of all boundaries; z and the weights have the shape (N + 1,)."""
        return boundary.margins(self._problem, self._boundaries, z, weights)

    def limit_of(self, point: SpecialPoint) -> int:
        """Which boundary a special point lies on."""
        z = np.array(point.unknowns)
        return int(np.nanargmin(np.abs(self.margins(z, np.maximum(np.abs(z), 1.0)))))

    def stopped(self, located: Located, sample: Sample) -> str:
        """In words, which guard is reached, and what is beyond."""
        reached = located.among(self._boundaries)
        found = beyond(self._problem, located.z, sample.weights, reached)
        return f"At {self._problem.free} = {located.z[-1]:.12g} the equilibrium reaches {found.words}"

    def neighbours(self, point: SpecialPoint) -> tuple[Sequence[Seed], str]:
        """The branch of equilibria of the other mode; in words, why there is none."""
        z = np.array(point.unknowns)
        reached = self._boundaries[self.limit_of(point)]
        found = beyond(self._problem, z, np.maximum(np.abs(z), 1.0), reached)
        if found.seed is None:
            return (), "No mode of the plugin has equilibria there that could be followed."
        return (found.seed,), f"The branch goes on with the equilibria of mode '{found.mode}'."

"""What becomes of a small deviation along a smooth orbit, at the same time as the orbit itself."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from contwalk import flow
from contwalk.problems.orbit import monodromy
from contwalk.problems.orbit.closure import images_of
from contwalk.problems.orbit.lifts import TANGENT
from contwalk.problems.orbit.modes import Mode, chosen_multiplier, eigenvector, linear_part
from contwalk.problems.orbit.segmented_orbit import SegmentedOrbit
from contwalk.system.declarations import ParameterValues


class SmoothDeviations:
    """Deviations from a smooth orbit.

    Parameters
    ----------
    problem : PeriodicOrbit
    z : ndarray
        A solution.
    """

    legs = 1

    def __init__(self, problem: SegmentedOrbit, z: np.ndarray) -> None:
        self.problem, self.z = problem, z

    @property
    def rounds(self) -> int:
        """Closures of the motion that `motion_of` tells."""
        return self.problem.closure.fold

    @cached_property
    def _factors(self) -> list[np.ndarray]:
        return monodromy.chain(self.problem, self.problem.linearize(self.z).jacobian)[0]

    def mode(self, number: int) -> Mode:
        """A mode by the number of its multiplier, from 1 on; it starts across the neutral directions.

        Raises
        ------
        ContwalkError
            If there is no multiplier of this number, or it is infinite.
        """
        problem, z = self.problem, self.z
        found = problem.multipliers(z, problem.linearize(z).jacobian)
        multiplier = chosen_multiplier(found.values, number)
        neutral, own = monodromy.neutral_directions(problem, z, 0), problem.mesh.variation
        product = np.eye(problem.states)
        for factor in self._factors:
            product = factor @ product
        return Mode(multiplier, eigenvector(product, neutral, own, number), neutral, own)

    def full(self, start: np.ndarray) -> np.ndarray:
        """A deviation at the start: of all states."""
        return start

    def closure(self, start: np.ndarray, which: int, shares: Sequence[np.ndarray]) -> list[np.ndarray]:
        """Deviations along a closure, (k, n), as a list of this one array; see `HybridDeviations`."""
        problem, (at,) = self.problem, shares
        mesh, n, field = problem.mesh, problem.states, problem.passage.field(TANGENT)
        still = np.zeros(len(problem.passage.columns))
        c = field.constants(np.concatenate([problem.given(self.z), still]))
        found, d = np.zeros((len(at), 2 * n)), start
        segments = np.searchsorted(mesh.cuts, at, side="right") - 1
        for i, (x, steps) in enumerate(zip(problem.starts(self.z), mesh.steps, strict=True)):
            nodes = flow.along(field, c, steps, np.concatenate([x, d]), mesh.method)
            inside = segments == i
            if np.any(inside):
                wanted = np.clip(at[inside], steps[0], steps[-1])
                found[inside] = flow.interpolation(field, c, steps, nodes, mesh.method)(wanted)
            d = nodes[-1, n:]
        return [self._imaged(found[:, :n], found[:, n:], which)]

    def _imaged(self, states: np.ndarray, deviations: np.ndarray, which: int) -> np.ndarray:
        """Deviations in a closure of the motion: images of the integrated ones, as those of the states."""
        closure = self.problem.closure
        power = (closure.power * (closure.fold - which)) % closure.fold
        if power == 0:
            return deviations
        p = ParameterValues(**self.problem.values_of(self.z))
        scale = self.problem.mesh.magnitudes
        return linear_part(lambda y: images_of(closure.symmetry, y, p, power), states, deviations, scale)

    def after(self, start: np.ndarray) -> np.ndarray:
        """The deviation after a closure."""
        for factor in self._factors:
            start = factor @ start
        return start

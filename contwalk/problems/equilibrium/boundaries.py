"""Guards that an equilibrium of a machine with events may reach: the boundaries of its mode."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from contwalk.fields.kernel import Kernel
from contwalk.numerics.linear import EPSILON
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.system import System, Transition


@dataclass(frozen=True)
class Boundary:
    """A transition out of the mode of an equilibrium; `rank` is its number among these."""

    transition: Transition
    rank: int

    @property
    def name(self) -> str:
        """The transition's."""
        return self.transition.name

    @property
    def acts(self) -> bool:
        """Whether something happens there."""
        return self.transition.role != "watched"

    @property
    def side(self) -> float:
        """The sign of the guard on the mode's side."""
        return 1.0 if self.transition.direction == "falling" else -1.0

    def gradient(self, problem: EquilibriumEquations, z: np.ndarray) -> np.ndarray:
        """Of the guard, positive on the mode's side, by z; both of shape (N + 1,)."""
        return np.asarray(self.side * problem.guard_kernels(self.name)[1](*problem.inputs(z)))

    def rate(self, problem: EquilibriumEquations, z: np.ndarray) -> float:
        """d(margin)/d(parameter) along the branch of a mode's equilibria; z has the shape (N + 1,).

        Zero where its terms cancel to half of the digits: its sign is not known then.

        Raises
        ------
        numpy.linalg.LinAlgError
            If the equations are singular there.
        """
        n, gradient, jacobian = problem.size, self.gradient(problem, z), problem.jacobian(z)
        along = np.linalg.solve(jacobian[:, :n], -jacobian[:, n])
        return known(float(gradient[:n] @ along + gradient[n]), np.append(gradient[:n] * along, gradient[n]))


def known(value: float, terms: np.ndarray) -> float:
    """A sum of terms, shape (k,), or zero where no more than half of its digits are left of them."""
    return value if abs(value) > EPSILON**0.5 * float(np.abs(terms).sum()) else 0.0


def boundaries_of(system: System) -> tuple[Boundary, ...]:
    """Those of the first mode. A guard that may be passed both ways has no side that is the mode's."""
    leaving = (t for t in system.leaving(system.modes[0].name) if t.direction != "both")
    return tuple(Boundary(transition, rank) for rank, transition in enumerate(leaving))


def margins(
    problem: EquilibriumEquations, boundaries: Sequence[Boundary], z: np.ndarray, weights: np.ndarray
) -> np.ndarray:
    """Guards, positive on the mode's side, in units of what the metric's change them by.

    z and the weights have the shape (N + 1,), the margins one number a boundary.
    """
    found, inputs = np.empty(len(boundaries)), problem.inputs(z)
    for which, boundary in enumerate(boundaries):
        value, gradient = problem.guard_kernels(boundary.name)
        found[which] = boundary.side * float(value(*inputs)[0]) / unit(gradient, inputs, weights)
    return found


def unit(gradient: Kernel, inputs: tuple[list[float], ...], weights: np.ndarray) -> float:
    """What weights of the metric, shape (N + 1,), change a guard by; one where that is nothing."""
    return float(np.abs(gradient(*inputs)) @ weights) or 1.0

"""What lies between soft transitions, eliminated from the equations of an explicit orbit, exactly."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from contwalk.problems.hybrid.grouping import Grouping

if TYPE_CHECKING:
    from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit

# Corrections of what is eliminated, and a residual of it that is solved, in units of its level: what is left
# of it enters the other equations, to first order.
MOST_CORRECTIONS, SOLVED = 4, 1e2
# Beyond corrections of this size, against the orbit's, the next solution may be another one.
COARSE = 1e-2
# What is left of the other equations, in their units, near a solution.
NEARLY = 1e-7
# The same where it is worth to ask whether it is the machine's.
SETTLED = 1e-4


class Eliminated:
    """An explicit orbit's equations with what is eliminated from them, at the unknowns z that are left."""

    def __init__(self, explicit: HybridOrbit, grouping: Grouping, z: np.ndarray, soft: np.ndarray) -> None:
        self.explicit, self.grouping, self.z, self.soft = explicit, grouping, z, soft
        self.unknowns = grouping.joined(z, soft)

    @cached_property
    def _parts(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        found, grouping = self.explicit.linearize(self.unknowns), self.grouping
        own, soft = grouping.columns(found.jacobian)
        hard_rows, soft_rows = grouping.hard_rows, grouping.soft_rows
        return (
            found.residual[hard_rows],
            found.residual[soft_rows],
            own[hard_rows],
            soft[hard_rows],
            own[soft_rows],
            soft[soft_rows],
        )

    @property
    def finite(self) -> bool:
        """Whether the equations have values."""
        return self.explicit.linearize(self.unknowns).finite

    @property
    def excess(self) -> float:
        """Residual of what is eliminated, in units of its level."""
        if not len(self.grouping.soft_rows):
            return 0.0
        level = self.explicit.linearize(self.unknowns).levels[0][self.grouping.soft_rows]
        return float(np.max(np.abs(self._parts[1]) / level))

    @property
    def settles(self) -> bool:
        """Whether what is left is solved nearly."""
        return self.excess <= SOLVED and self._left < SETTLED

    @cached_property
    def _left(self) -> float:
        """What is left to solve, in units of the equations."""
        scales = self.explicit.equation_scales[self.grouping.hard_rows]
        return float(np.linalg.norm(self.residual / scales))

    @property
    def negligible(self) -> bool:
        """Whether what second derivatives make of the next correction is small beside what is left to solve.

        At a solution of what is left it has to be solved for.
        """
        return self._left > NEARLY and self.step**2 < 0.01 * self._left

    @cached_property
    def _inverse(self) -> np.ndarray:
        """Inverse of the derivatives by what is eliminated of its own equations: it is used often."""
        return np.linalg.inv(self._parts[5])

    @cached_property
    def correction(self) -> np.ndarray:
        """What Newton's method subtracts from what is eliminated."""
        return self._inverse @ self._parts[1]

    @cached_property
    def step(self) -> float:
        """Length of the correction, in units of the states' variation and of the closure's duration."""
        sizes = self.grouping.split(np.append(self.explicit.cycle_scales[1], 1.0))[1]
        return float(np.linalg.norm(self.correction / sizes))

    @cached_property
    def slope(self) -> np.ndarray:
        """Derivative of what is eliminated by the unknowns."""
        return -self._inverse @ self._parts[4]

    @property
    def residual(self) -> np.ndarray:
        """Of the equations that are left."""
        return self._parts[0] - self._parts[3] @ self.correction

    @property
    def jacobian(self) -> np.ndarray:
        """Derivatives of what is left by the unknowns that are left."""
        _, _, by_own, by_soft, _, _ = self._parts
        return by_own + by_soft @ self.slope

    def predicted(self, z: np.ndarray) -> np.ndarray:
        """What is eliminated elsewhere, to first order."""
        return self.soft - self.correction + self.slope @ (z - self.z)

    def levels(self, explicit: np.ndarray) -> np.ndarray:
        """Levels of what is left, from levels of all equations."""
        own, soft = explicit[self.grouping.hard_rows], explicit[self.grouping.soft_rows]
        return own + np.abs(self._parts[3] @ self._inverse) @ soft

    def followed(self, z: np.ndarray, before: Followed | None) -> tuple[np.ndarray, Followed]:
        """Residual of what is left at a point nearby, without its derivatives.

        What is eliminated is corrected by those there are, from where it was followed to before.
        """
        start = before or Followed(self, self.z, self.soft - self.correction)
        soft, grouping = start.predicted(z), self.grouping
        residual = self.explicit.residual(grouping.joined(z, soft))
        correction = self._inverse @ residual[grouping.soft_rows]
        left = residual[grouping.hard_rows] - self._parts[3] @ correction
        return left, Followed(self, z, soft - correction)

    def direction(self, tangent: np.ndarray) -> np.ndarray:
        """A direction of the unknowns that are left as one of all of them."""
        return self.grouping.joined(tangent, self.slope @ tangent)


@dataclass(frozen=True, eq=False)
class Followed:
    """What is eliminated at z, corrected by the derivatives at a point near it."""

    near: Eliminated
    z: np.ndarray
    soft: np.ndarray

    @property
    def explicit(self) -> HybridOrbit:
        """The explicit orbit."""
        return self.near.explicit

    @property
    def grouping(self) -> Grouping:
        """Its groups."""
        return self.near.grouping

    def predicted(self, z: np.ndarray) -> np.ndarray:
        """What is eliminated elsewhere, to first order."""
        return self.soft + self.near.slope @ (z - self.z)


def corrected(
    explicit: HybridOrbit,
    grouping: Grouping,
    z: np.ndarray,
    soft: np.ndarray,
    roughly: bool = False,
) -> Eliminated | None:
    """The explicit orbit over z; None where Newton's method finds none, or one that runs backwards.

    Residuals are solved to their level, or roughly: to where they are negligible beside those that are left.
    """
    before = np.inf
    for _ in range(MOST_CORRECTIONS):
        found = Eliminated(explicit, grouping, z, soft)
        if grouping.backward(found.unknowns[explicit.layout.durations]) or not found.finite:
            return None
        if found.excess <= SOLVED:
            return found
        try:
            if found.step > min(COARSE, before):  # it leads nowhere: another transition comes or goes
                return None
        except np.linalg.LinAlgError:
            return None
        if roughly and found.negligible:
            return found
        before, soft = found.step, soft - found.correction
    return None

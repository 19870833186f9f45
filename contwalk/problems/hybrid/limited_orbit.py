"""Orbits through events looked at leg by leg, for what limits them.

Beside the data stands here only what reads them: what is computed of an orbit are functions over this class,
and `HybridOrbit` offers them to the engine.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Collection
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from contwalk.problems.hybrid.margins import Limit, Margins
from contwalk.problems.hybrid.view import GuardedView
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit, seen_of
from contwalk.problems.orbit.layout import Layout
from contwalk.problems.orbit.shooting import Mesh

# Solutions that are looked at again soon: at a step's ends.
MOST_VIEWS = 4

Kind = TypeVar("Kind", bound="LimitedOrbit")


class LimitedOrbit(DiscretizedOrbit):
    """Orbits of legs, each in its own time, that limits bound; see `HybridOrbit` for the parameters."""

    layout: Layout
    _mesh: Mesh | None
    most_views = MOST_VIEWS

    def explicit(self, z: np.ndarray) -> tuple[LimitedOrbit, np.ndarray]:
        """The orbit with a leg for every smooth piece, and its unknowns: itself, if none is condensed.

        Both have the shape (N + 1,) of their problem.
        """
        return self, z

    if TYPE_CHECKING:

        def view(self, z: np.ndarray) -> tuple[GuardedView, ...]:
            """A solution looked at piece by smooth piece. z has the shape (N + 1,)."""

    def legs_viewed(self, z: np.ndarray) -> tuple[GuardedView, ...]:
        """The legs, each looked at with what is watched on it. z has the shape (N + 1,)."""
        return tuple(
            GuardedView(*given, left=_left(self, i), segments=segments)
            for i, (given, segments) in enumerate(seen_of(self, z))
        )

    def largest_guards(self, z: np.ndarray) -> np.ndarray:
        """Largest value of each leg's own guard on it, shape (m,); of one without, 1 or the unit of times.

        z has the shape (N + 1,).
        """
        # What is zero where no guard is: the time at which a force's period begins, or a duration.
        scales = np.full(self.layout.legs, self.mesh.total if self.forced else 1.0)
        for i, (leg, view) in enumerate(zip(self.itinerary.legs, self.view(z), strict=True)):
            if leg.transition is None:
                continue
            if leg.collapsed:
                scales[i] = self.mesh.total
                continue
            largest = float(np.abs(view.guard_values(leg.transition)).max())
            scales[i] = largest if np.isfinite(largest) and largest > 0.0 else 1.0
        return scales

    def pieces_of(self, z: np.ndarray, i: int) -> list[GuardedView]:
        """Leg i looked at, piece by piece where there are soft transitions on it.

        z has the shape (N + 1,).
        """
        return [self.view(z)[i]]

    # -- what is computed of them, of whichever class they are -------------------------------------------

    @property
    @abstractmethod
    def limits(self) -> tuple[Limit, ...]:
        """All that must stay positive for an orbit to be the machine's."""

    @abstractmethod
    def margins(self, z: np.ndarray) -> Margins:
        """Values of all limits at a solution. z has the shape (N + 1,)."""


def _left(orbit: LimitedOrbit, i: int) -> Collection[str]:
    """Transitions whose guards are zero where leg i starts, if what leads into it is hard."""
    before, itinerary = orbit.itinerary.legs[i - 1].transition, orbit.itinerary
    if before is None or before.role != "hard":
        return ()
    return orbit.system.left_at_zero(itinerary.leading_in(orbit.system, i), itinerary.legs[i].mode)

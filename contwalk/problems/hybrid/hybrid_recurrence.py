"""A motion that comes back, cut into legs by its events."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contwalk.problems.hybrid.mirrors import Span
from contwalk.problems.orbit.itinerary import Itinerary


@dataclass(frozen=True, eq=False)
class HybridRecurrence:
    """A motion that (nearly) comes back, or comes to the image of where it was.

    `magnitudes` are the largest of each state; `returned` is the state after the last event and
    the image, `origin` the one that the motion began with.
    """

    stretches: tuple[Span, ...]
    magnitudes: np.ndarray
    missed: float
    returned: np.ndarray
    image: str = ""
    origin: np.ndarray | None = None

    @property
    def itinerary(self) -> Itinerary:
        """The itinerary that was read off."""
        return Itinerary(tuple(stretch.leg for stretch in self.stretches), self.image)

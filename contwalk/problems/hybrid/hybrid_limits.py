"""What the engine asks of the limits of orbits through events, and what lies beyond them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.memory import memory_of, remembered
from contwalk.problems.hybrid import limits_in_words, locating_limits
from contwalk.problems.hybrid.adjacent import itineraries
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.margins import Limit
from contwalk.problems.orbit.fine_steps import discretized
from contwalk.problems.problem import Located, Sample, Seed

# Limits whose neighbours are kept.
_MOST_NEIGHBOURS = 4


class HybridLimits:
    """The limits of an orbit, and the orbits beyond them.

    Parameters
    ----------
    orbit : LimitedOrbit
    """

    def __init__(self, orbit: LimitedOrbit) -> None:
        self._orbit = orbit

    @property
    def limits(self) -> tuple[Limit, ...]:
        """All that must stay positive for an orbit to be the machine's."""
        return self._orbit.limits

    def margins(self, z: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Those of all limits; z and the weights have the shape (N + 1,)."""
        return self._orbit.margins(z).relative

    def limit_of(self, point: SpecialPoint) -> int:
        """Which of the limits a special point is one of."""
        orbit, z = self._orbit, np.array(point.unknowns)
        known = orbit._mesh is not None and len(z) == orbit.size + 1
        return locating_limits.nearest(orbit if known else discretized(orbit, z), point)

    def stopped(self, located: Located, sample: Sample) -> str:
        """Why an orbit beyond a limit is not the machine's, and what lies next to it."""
        return limits_in_words.sentence(self._orbit, located)

    def neighbours(self, point: SpecialPoint) -> tuple[Sequence[Seed], str]:
        """The branches of other words beyond a limit, and in words what was found, or tried.

        They are asked for twice: where a branch ends, for the words, and where others begin.
        """
        key = (*_given(self._orbit, np.array(point.unknowns)), point.label, point.unknowns)
        known = memory_of(self._orbit.system, "neighbours")
        found: tuple[Sequence[Seed], str] = remembered(
            known, key, _MOST_NEIGHBOURS, lambda: self._beyond(point)
        )
        return found

    def _beyond(self, point: SpecialPoint) -> tuple[Sequence[Seed], str]:
        return itineraries.found(self._orbit, point)


def _given(orbit: LimitedOrbit, z: np.ndarray) -> tuple:
    """All that orbits beside a solution follow from, besides its steps."""
    line, held = orbit.line, orbit.reference if orbit.pins else None
    numbers = (orbit.turns, line.direction, np.zeros(0) if held is None else held)
    values = tuple(orbit.values_of(z).items()), *(each.tobytes() for each in numbers)
    kinds = orbit.itinerary, line.free, orbit.pins, orbit.subharmonic, orbit.discretization
    return *kinds, *values

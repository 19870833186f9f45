"""Orbits through events looked at leg by leg, for what limits them.

Beside the data stands here only what reads them: what is computed of an orbit are functions over this class,
and `HybridOrbit` offers them to the engine.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Collection
from dataclasses import replace
from typing import TypeVar

import numpy as np

from contwalk.problems.hybrid.margins import Limit, Margins
from contwalk.problems.hybrid.shooting import LegMesh
from contwalk.problems.hybrid.view import LegView
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.layout import Layout, Segment, joined
from contwalk.problems.orbit.piece import Piece

# Solutions that are looked at again soon: at a step's ends.
MOST_VIEWS = 4

Kind = TypeVar("Kind", bound="LimitedOrbit")


class LimitedOrbit(DiscretizedOrbit):
    """Orbits of legs, each in its own time, that limits bound; see `HybridOrbit` for the parameters."""

    layout: Layout
    _mesh: LegMesh | None

    # The most steps of a leg, where they are known; how many segments of legs a stored branch has room for.
    _most_steps: int | None = None
    room: int | None = None

    def explicit(self, z: np.ndarray) -> tuple[LimitedOrbit, np.ndarray]:
        """The orbit with a leg for every smooth piece, and its unknowns: itself, if none is condensed.

        Both have the shape (N + 1,) of their problem.
        """
        return self, z

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """The legs on their steps."""
        return self.known.once("pieces", lambda: _pieces(self))

    def view(self, z: np.ndarray) -> tuple[LegView, ...]:
        """A solution looked at piece by smooth piece. z has the shape (N + 1,)."""
        there, own = self.explicit(z)
        return there.known.at("view", own, MOST_VIEWS, lambda: _views(there, own))

    @property
    def guard_scales(self) -> np.ndarray:
        """Units of the legs' guards, shape (m,)."""
        return np.ones(self.layout.legs) if self.mesh.guards is None else self.mesh.guards

    def pieces_of(self, z: np.ndarray, i: int) -> list[LegView]:
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
    def residual(self, z: np.ndarray) -> np.ndarray:
        """F(z), shape (N,), for far less than with its derivatives."""

    @abstractmethod
    def margins(self, z: np.ndarray) -> Margins:
        """Values of all limits at a solution. z has the shape (N + 1,)."""


def _pieces(orbit: LimitedOrbit) -> tuple[Piece, ...]:
    if orbit.cuts == 1:
        return orbit.segments
    own = [orbit.layout.segments_of(i) for i in range(orbit.layout.legs)]
    ends = np.cumsum([0, *map(len, own)])
    return tuple(
        replace(orbit.segments[b - 1], steps=joined(places, orbit.mesh.steps[a:b]))
        for places, a, b in zip(own, ends[:-1].tolist(), ends[1:].tolist(), strict=True)
    )


def _views(orbit: LimitedOrbit, z: np.ndarray) -> tuple[LegView, ...]:
    times, nodes = orbit.starting_times(z), orbit.known.found("nodes", z)
    known: list[list[np.ndarray]] = [[] for _ in orbit.pieces]
    for segment, own in zip(orbit.layout.segments, nodes or (), strict=nodes is not None):
        known[segment.leg].append(own)
    return tuple(
        LegView(
            piece,
            *orbit.layout.inputs(i, z),
            float(times[i]),
            _left(orbit, i),
            _segments_of(orbit, z, i),
            known[i],
        )
        for i, piece in enumerate(orbit.pieces)
    )


def _segments_of(
    orbit: LimitedOrbit, z: np.ndarray, i: int
) -> list[tuple[Segment, Piece, np.ndarray, np.ndarray]]:
    """The segments of leg i, if there are several."""
    if orbit.layout.cuts[i] == 1:
        return []
    return [
        (segment, piece, *orbit.layout.inputs_of(segment, z))
        for segment, piece in zip(orbit.layout.segments, orbit.segments, strict=True)
        if segment.leg == i
    ]


def _left(orbit: LimitedOrbit, i: int) -> Collection[str]:
    """Transitions whose guards are zero where leg i starts, if what leads into it is hard."""
    before, itinerary = orbit.itinerary.legs[i - 1].transition, orbit.itinerary
    if before is None or before.role != "hard":
        return ()
    return orbit.system.left_at_zero(itinerary.leading_in(orbit.system, i), itinerary.legs[i].mode)

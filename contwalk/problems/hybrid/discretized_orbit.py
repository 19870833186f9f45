"""Discretised orbits through events: what they are, and how their unknowns are read.

Beside the data stands here only what reads them: what is computed of an orbit are functions over this class,
and `HybridOrbit` offers them to the engine.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Self, TypeVar, Unpack

import numpy as np

from contwalk.problems.angles import whole_turns
from contwalk.problems.hybrid.margins import Limit, Margins
from contwalk.problems.hybrid.shooting import LegMesh
from contwalk.problems.hybrid.view import LegView
from contwalk.problems.kinks import Course
from contwalk.problems.orbit.itinerary import Itinerary
from contwalk.problems.orbit.layout import Layout, Segment, joined
from contwalk.problems.orbit.orbit_data import Further, OrbitData
from contwalk.problems.orbit.passage import Passage, passage_of
from contwalk.problems.orbit.piece import Piece
from contwalk.problems.orbit.section import Section
from contwalk.problems.orbit.traced_leg import Closing, ScalarInputs
from contwalk.problems.parameter_line import Ends
from contwalk.system import System, Transition

# Solutions that are looked at again soon: at a step's ends.
MOST_VIEWS = 4

Kind = TypeVar("Kind", bound="DiscretizedOrbit")


class DiscretizedOrbit(OrbitData):
    """Orbits of one itinerary on given steps; see `HybridOrbit` for its parameters."""

    layout: Layout
    _mesh: LegMesh | None

    def __init__(
        self,
        system: System,
        itinerary: Itinerary,
        parameters: Mapping[str, float],
        free: str,
        path: Ends | None = None,
        **further: Unpack[Further],
    ) -> None:
        self.itinerary = itinerary
        super().__init__(system, parameters, free, path, **further)

    def _begin(self) -> None:
        self.turns = np.zeros(self.states)
        self._most_steps: int | None = None
        # Segments of each leg; how many a stored branch has room for.
        self.cuts, self.room, self.layout = 1, None, _laid_out(self, 1)

    def of_itinerary(self, itinerary: Itinerary, times: int = 1, turns: np.ndarray | None = None) -> Self:
        """The orbits of another itinerary, lasting `times` as many periods of the forcing.

        `turns` has the shape (n,).
        """
        return self.like(type(self), itinerary, times, turns)

    def like(
        self, kind: type[Kind], itinerary: Itinerary, times: int = 1, turns: np.ndarray | None = None
    ) -> Kind:
        """As `of_itinerary`, of a class of orbits."""
        other = kind(
            self.system,
            itinerary,
            self.parameters,
            self.free,
            self.line.ends,
            pins=self.pins,
            reference=self.reference,
            subharmonic=self.subharmonic * (times if self.forced else 1),
            discretization=self.discretization,
        )
        other.line = self.line  # it may be one through a plane of two parameters, which its ends do not tell
        other.turns = self.turns * times if turns is None else turns
        other.effort = self.effort
        return other

    def on(self, mesh: LegMesh, section: Section | None) -> Self:
        """The same problem on another mesh, with another section."""
        return self.varied(_mesh=mesh, section=section)

    def cut_into(self, cuts: int) -> Self:
        """The same problem with so many segments in each leg; its steps are made anew: see `adapted_to`."""
        return self if cuts == self.cuts else self.varied(cuts=cuts, layout=_laid_out(self, cuts))

    @property
    def cuttable(self) -> bool:
        """Whether legs may be cut into segments: those of itineraries that end with an event, and a single
        leg that ends where it began.
        """
        return self.itinerary.eventful or len(self.itinerary) == 1

    def fitting(self, z: np.ndarray) -> Self:
        """The same problem with the segments of a solution, which its length tells."""
        if len(z) == self.size + 1:
            return self
        return self.cut_into(1 + (len(z) - 1 - self.layout.rest.stop) // added_by_cuts(self))

    @cached_property
    def passages(self) -> tuple[Passage, ...]:
        """The legs' compiled functions."""
        inputs = ScalarInputs(self.line.own, self.line.moving, self.pins)
        return tuple(
            passage_of(
                self.system, leg, self.itinerary.target(i), inputs, Closing(self.itinerary.image_at(i))
            )
            for i, leg in enumerate(self.itinerary.legs)
        )

    def explicit(self, z: np.ndarray) -> tuple[DiscretizedOrbit, np.ndarray]:
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

    def duration(self, z: np.ndarray) -> float:
        """Duration of the closure, seconds. z has the shape (N + 1,)."""
        return float(z[self.layout.durations].sum())

    def starting_times(self, z: np.ndarray) -> np.ndarray:
        """Times at which the legs start, and the last one ends, shape (m + 1,)."""
        first = 0.0 if self.layout.start is None else float(z[self.layout.start])
        return first + np.concatenate([[0.0], np.cumsum(z[self.layout.durations])])

    def assembled(
        self,
        states: Sequence[np.ndarray],
        lasting: Sequence[float] | np.ndarray,
        drifts: np.ndarray,
        value: float,
        start: float = 0.0,
    ) -> np.ndarray:
        """Unknowns from full states at the starts of the legs, their durations, and when the first begins.

        Segments are not cut: see `cutting.filled`.

        States have the shape (n,) each, durations (m,), drifts (k,); unknowns (N + 1,).
        """
        z = np.zeros(self.layout.size + 1)
        for place, passage, x in zip(self.layout.states, self.passages, states, strict=True):
            z[place] = x[list(passage.states)]
        z[self.layout.durations], z[self.layout.drifts], z[-1] = lasting, drifts, value
        if self.layout.start is not None:
            z[self.layout.start] = start
        return z

    def magnitudes_of(self, weights: np.ndarray) -> np.ndarray:
        """Typical magnitudes of all states, of weights of the unknowns; 1 for those of no leg.

        Magnitudes have the shape (n,), weights (N + 1,).
        """
        magnitudes = np.ones(self.states)
        for place, passage in zip(self.layout.states, self.passages, strict=True):
            magnitudes[list(passage.states)] = weights[place] / np.sqrt(len(self.layout.segments))
        return magnitudes

    @property
    def events(self) -> list[tuple[int, Transition]]:
        """The legs that last until an event whose guard depends on the states, and that event."""
        each = [(i, leg.transition) for i, leg in enumerate(self.itinerary.legs) if not leg.collapsed]
        return [(i, own) for i, own in each if own and not self.passages[i].of_time_alone(own)]

    @property
    def guard_scales(self) -> np.ndarray:
        """Units of the legs' guards, shape (m,)."""
        return np.ones(self.layout.legs) if self.mesh.guards is None else self.mesh.guards

    def pieces_of(self, z: np.ndarray, i: int) -> list[LegView]:
        """Leg i looked at, piece by piece where there are soft transitions on it.

        z has the shape (N + 1,).
        """
        return [self.view(z)[i]]

    def courses(self, z: np.ndarray) -> list[Course]:
        """The legs as they are looked at for kinks of their fields. z has the shape (N + 1,)."""
        if all(passage.switching is None for passage in self.passages):
            return []
        return [course for leg in self.view(z) for course in leg.course()]

    def nearest_turn(self, z: np.ndarray, near: np.ndarray) -> np.ndarray:
        """The same solution with its angles turned as near as possible to those of another one.

        Of a forced orbit the instant at which it begins counts modulo its period, as an angle does.

        All have the shape (N + 1,).
        """
        if len(z) != self.size + 1:
            return self.fitting(z).nearest_turn(z, near)
        periods = self.periods
        if self.layout.start is not None:
            periods[self.layout.start] = self.rounds * self.duration(z)
        return z + whole_turns(near - z, periods)

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


def _laid_out(orbit: DiscretizedOrbit, cuts: int) -> Layout:
    """Where what stands with so many segments in each leg; one that is collapsed has one."""
    sizes = [len(orbit.system.states_of(leg.mode)) for leg in orbit.itinerary.legs]
    each = [1 if leg.collapsed else cuts for leg in orbit.itinerary.legs]
    return Layout(sizes, orbit.forced, len(orbit.pins), each)


def added_by_cuts(orbit: DiscretizedOrbit) -> int:
    """How many unknowns each further segment in all legs adds."""
    each = zip(orbit.itinerary.legs, orbit.layout.sizes, strict=True)
    return sum(n for leg, n in each if not leg.collapsed)


def _pieces(orbit: DiscretizedOrbit) -> tuple[Piece, ...]:
    if orbit.cuts == 1:
        return orbit.segments
    own = [orbit.layout.segments_of(i) for i in range(orbit.layout.legs)]
    ends = np.cumsum([0, *map(len, own)])
    return tuple(
        replace(orbit.segments[b - 1], steps=joined(places, orbit.mesh.steps[a:b]))
        for places, a, b in zip(own, ends[:-1].tolist(), ends[1:].tolist(), strict=True)
    )


def _views(orbit: DiscretizedOrbit, z: np.ndarray) -> tuple[LegView, ...]:
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
    orbit: DiscretizedOrbit, z: np.ndarray, i: int
) -> list[tuple[Segment, Piece, np.ndarray, np.ndarray]]:
    """The segments of leg i, if there are several."""
    if orbit.layout.cuts[i] == 1:
        return []
    return [
        (segment, piece, *orbit.layout.inputs_of(segment, z))
        for segment, piece in zip(orbit.layout.segments, orbit.segments, strict=True)
        if segment.leg == i
    ]


def _left(orbit: DiscretizedOrbit, i: int) -> Collection[str]:
    """Transitions whose guards are zero where leg i starts, if what leads into it is hard."""
    before, itinerary = orbit.itinerary.legs[i - 1].transition, orbit.itinerary
    if before is None or before.role != "hard":
        return ()
    return orbit.system.left_at_zero(itinerary.leading_in(orbit.system, i), itinerary.legs[i].mode)

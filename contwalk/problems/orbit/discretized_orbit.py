"""Discretised orbits: what they are, and how their unknowns are read.

An orbit is a cycle of legs; one that meets no event is one leg that ends where it began. Its unknowns stand
as its layout says: legs in their own times, or, of a smooth system, one leg whose segments are in times of
the closure. These are of equal duration, or cut where a run's discretisation has it so. Times of such
cuts, as parts of the closure, stand among the unknowns, behind drifts and before the free parameter, and are
held by an equation each: a stored solution then tells the cuts that it was solved on.

Beside the data stands here only what reads them: what is computed of an orbit are functions over this class,
and `PeriodicOrbit` and `HybridOrbit` offer them to the engine.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property, partial
from itertools import pairwise
from typing import Any, ClassVar, Self, TypeVar

import numpy as np

from contwalk.problems.angles import whole_turns
from contwalk.problems.forcing import period_at
from contwalk.problems.kinks import Course
from contwalk.problems.orbit.itinerary import Itinerary
from contwalk.problems.orbit.layout import ClosureLayout, Layout, Segment, joined, times_chosen
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.passage import Passage, passage_of
from contwalk.problems.orbit.piece import Piece, passed
from contwalk.problems.orbit.section import Section
from contwalk.problems.orbit.shooting import Mesh
from contwalk.problems.orbit.traced_leg import Closing, ScalarInputs
from contwalk.problems.orbit.view import SAMPLES, LegView
from contwalk.system import Transition

# Halves: pitchforks of orbits with a symmetry that nobody declared stay pitchforks as well.
PARTS = 2
# Parts of the closure by which times are those of segments of equal duration.
SAME_TIME = 1e-12
# Linearizations and motions that are kept: a step asks for the same ones several times.
MOST_KEPT = 12

Kind = TypeVar("Kind", bound="DiscretizedOrbit")


class DiscretizedOrbit(OrbitData):
    """Orbits of one itinerary on given steps; see `PeriodicOrbit` and `HybridOrbit` for the parameters."""

    most_views: ClassVar[int] = MOST_KEPT
    layout: Any  # a `ClosureLayout`, or of legs a `Layout`
    room: int | None = None  # how many segments of legs a stored branch has room for
    most_steps: int | None = None  # of a segment, where that is known

    def _lay_out(self) -> None:
        # Parts of the closure in which the steps are alike.
        self.parts = PARTS if self.cuttable and not self.itinerary.eventful else 1
        self.layout = self._laid_out(1)

    def _laid_out(self, cuts: int, times: np.ndarray | None = None) -> ClosureLayout | Layout:
        """Where what stands with so many segments in each leg, by default of equal duration; a leg that is
        momentary has one.
        """
        legs, pins = self.itinerary.legs, len(self.pins)
        if self.in_closure:
            if self.discretization.uneven and times is None:
                times = np.arange(cuts) / cuts
            if not self.discretization.uneven and (times is None or not _chosen(self, times)):
                times = None
            return ClosureLayout(self.states, self.forced, pins, cuts, times)
        sizes = [len(self.system.states_of(leg.mode)) for leg in legs]
        return Layout(sizes, self.forced, pins, [1 if leg.momentary else cuts for leg in legs])

    # -- variants ----------------------------------------------------------------------------------------

    def of_itinerary(self, itinerary: Itinerary, times: int = 1, turns: np.ndarray | None = None) -> Self:
        """The orbits of another itinerary, lasting `times` as many periods of the forcing.

        `turns` has the shape (n,).
        """
        return self.like(type(self), itinerary, times, turns)

    def like(
        self, kind: type[Kind], itinerary: Itinerary, times: int = 1, turns: np.ndarray | None = None
    ) -> Kind:
        """As `of_itinerary`, of a class of orbits."""
        other = kind.__new__(kind)  # smooth ones are asked for without the one itinerary that they have
        DiscretizedOrbit.__init__(
            other,
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

    def closing(self, turns: np.ndarray, image: str = "", power: int = 1, order: int = 1) -> Self:
        """The same legs closed up to a symmetry (or to none), with angles that turn, (n,)."""
        itinerary = Itinerary(self.itinerary.legs, image, power, order)
        other = self.varied(itinerary=itinerary, turns=turns)
        return other.varied(passages=other._compiled())

    def on(self, mesh: Mesh, section: Section | None) -> Self:
        """The same problem on another mesh, with another section."""
        times = mesh.cuts if self.uneven else None
        layout = self._laid_out(mesh.segments, times) if self.in_closure else self.layout
        return self.varied(_mesh=mesh, section=section, reference_orbit=None, layout=layout)

    def cut_into(self, cuts: int) -> Self:
        """The same problem with so many segments in each leg; its steps are made anew: see `adapted_to`."""
        return self if cuts == self.cuts else self.varied(layout=self._laid_out(cuts))

    def cut_at(self, times: np.ndarray) -> Self:
        """As `cut_into`, with segments that start at given times of each leg, shape (m,)."""
        return self.varied(layout=self._laid_out(len(times), times))

    @property
    def cuts(self) -> int:
        """Number of segments in each leg that may be cut."""
        most: int = max(self.layout.cuts)
        return most

    @property
    def cuttable(self) -> bool:
        """Whether legs may be cut into segments: those of itineraries that end with an event, and a single
        leg that ends where it began.
        """
        return self.itinerary.eventful or len(self.itinerary) == 1

    def fitting(self, z: np.ndarray) -> Self:
        """The same problem with the segments of a solution, which its length tells; where times of cuts stand
        in it, with these.
        """
        times = _times_in(self, z)
        if times is not None:
            return self.varied(layout=self._laid_out(len(times), times))
        if len(z) == self.size + 1 and not self.uneven:
            return self
        if self.uneven:
            return self.varied(layout=self._laid_out(1)).fitting(z)
        return self.cut_into(self.cuts + (len(z) - 1 - self.size) // added_by_cuts(self))

    @property
    def uneven(self) -> bool:
        """Whether times of cuts are chosen, and stand among the unknowns."""
        return self.in_closure and self.layout.times is not None

    @cached_property
    def passages(self) -> tuple[Passage, ...]:
        """The legs' compiled functions."""
        return self._compiled()

    def _compiled(self) -> tuple[Passage, ...]:
        system, itinerary = self.system, self.itinerary
        inputs = ScalarInputs(self.line.own, self.line.moving, self.pins)
        periods = self.forcings if self.in_closure and self.forced else None
        return tuple(
            passage_of(
                system,
                leg,
                itinerary.target(i),
                inputs,
                Closing(itinerary.image_at(i), itinerary.power, periods),
            )
            for i, leg in enumerate(itinerary.legs)
        )

    # -- unknowns ----------------------------------------------------------------------------------------

    def starts(self, z: np.ndarray) -> np.ndarray:
        """States at the starts of the segments of a closure that is one leg, shape (m, n)."""
        m, n = len(self.layout.segments), self.states
        return z[: m * n].reshape(m, n)

    def scalars(self, z: np.ndarray) -> np.ndarray:
        """Scalars of the first leg: duration, start, drifts and free parameter, where they are unknown.

        Shape (k,) of z, shape (N + 1,).
        """
        scalars: np.ndarray = self.layout.inputs_of(self.layout.segments[0], z)[1]
        return scalars

    def given(self, z: np.ndarray) -> np.ndarray:
        """What the first leg's field depends on at z, shape (N + 1,): scalars and fixed parameters."""
        return np.concatenate([self.scalars(z), self.line.constants])

    def duration(self, z: np.ndarray) -> float:
        """Duration of the closure, seconds. z has the shape (N + 1,)."""
        lasting = z[self.layout.durations]
        if len(lasting):
            return float(lasting.sum())
        return self.forcings * period_at(self.system, self.values_of(z))

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

        Segments are not cut: see `cut_legs.filled`.

        States have the shape (n,) each, durations (m,), drifts (k,); unknowns (N + 1,).
        """
        z = np.zeros(self.layout.size + 1)
        for place, passage, x in zip(self.layout.states, self.passages, states, strict=True):
            z[place] = x[list(passage.states)]
        z[self.layout.durations], z[self.layout.drifts], z[-1] = lasting, drifts, value
        if self.layout.start is not None:
            z[self.layout.start] = start
        return z

    def bare(self, vector: np.ndarray) -> np.ndarray:
        """Unknowns, or a direction or weights of them, (N + 1,), without those of inner segments of legs."""
        return np.append(vector[: self.layout.rest.stop], vector[-1])

    def magnitudes_of(self, weights: np.ndarray) -> np.ndarray:
        """Typical magnitudes of all states, of weights of the unknowns; 1 for those of no leg.

        Magnitudes have the shape (n,), weights (N + 1,).
        """
        magnitudes = np.ones(self.states)
        for place, passage in zip(self.layout.states, self.passages, strict=True):
            magnitudes[list(passage.states)] = weights[place] / np.sqrt(len(self.layout.segments))
        return magnitudes

    def nearest_turn(self, z: np.ndarray, near: np.ndarray) -> np.ndarray:
        """The same solution with its angles turned as near as possible to those of another one.

        Of a forced orbit the instant at which it begins, where that is unknown, counts modulo its period, as
        an angle does.

        All have the shape (N + 1,).
        """
        if len(z) != self.size + 1:
            return self.fitting(z).nearest_turn(z, near)
        periods = self.periods
        if self.layout.start is not None:
            periods[self.layout.start] = self.rounds * self.duration(z)
        return z + whole_turns(near - z, periods)

    # -- the motion --------------------------------------------------------------------------------------

    def passes(self, z: np.ndarray) -> tuple[list[np.ndarray], Any, Any]:
        """Of all segments the states at their steps, their ends, and the derivatives of these: of segments in
        times of the closure all in one pass, shapes (m, n) and (m, n, n + k).
        """
        if not self.in_closure:
            return super().passes(z)
        times, ends = self.mesh.times, self.mesh.ends
        nodes, ended, moved = passed(self.segments[-1], times, ends, self.starts(z), self.scalars(z))
        bounds = [0, *(ends + 1).tolist()]
        return [nodes[a:b] for a, b in pairwise(bounds)], ended, moved

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """The legs on their steps."""
        return self.known.once("pieces", lambda: _pieces(self))

    def view(self, z: np.ndarray) -> tuple[LegView, ...]:
        """A solution looked at piece by smooth piece. z has the shape (N + 1,)."""
        there, own = self.explicit(z)
        return there.known.at("view", own, self.most_views, lambda: there.legs_viewed(own))

    def legs_viewed(self, z: np.ndarray) -> tuple[LegView, ...]:
        """The legs, each looked at. z has the shape (N + 1,)."""
        return tuple(LegView(*given) for given, _ in seen_of(self, z))

    def largest_guards(self, z: np.ndarray) -> np.ndarray | None:
        """Units of the legs' guards, shape (m,); None where there are no guards. z has the shape (N + 1,)."""
        return None

    @property
    def events(self) -> list[tuple[int, Transition]]:
        """The legs that last until an event whose guard depends on the states, and that event."""
        each = [(i, leg.transition) for i, leg in enumerate(self.itinerary.legs) if not leg.collapsed]
        return [(i, own) for i, own in each if own and not self.passages[i].of_time_alone(own)]

    def courses(self, z: np.ndarray) -> list[Course]:
        """The legs as they are looked at for kinks of their fields. z has the shape (N + 1,)."""
        if all(passage.switching is None for passage in self.passages):
            return []
        return [course for leg in self.view(z) for course in leg.course()]


def _pieces(orbit: DiscretizedOrbit) -> tuple[Piece, ...]:
    if orbit.cuts == 1:
        return orbit.segments
    if orbit.in_closure:
        return (replace(orbit.segments[-1], steps=orbit.mesh.times),)
    own = [orbit.layout.segments_of(i) for i in range(orbit.layout.legs)]
    ends = np.cumsum([0, *map(len, own)])
    return tuple(
        replace(orbit.segments[b - 1], steps=joined(places, orbit.mesh.steps[a:b]))
        for places, a, b in zip(own, ends[:-1].tolist(), ends[1:].tolist(), strict=True)
    )


# A segment of a leg with its piece, its state and its scalars.
Viewed = tuple[Segment, Piece, np.ndarray, np.ndarray]


def seen_of(orbit: DiscretizedOrbit, z: np.ndarray) -> Iterator[tuple[tuple[Any, ...], list[Viewed]]]:
    """Of each leg what its `LegView` is made of, and its segments. z has the shape (N + 1,)."""
    nodes, z = orbit.known.found("nodes", z), z.copy()  # what is looked at later is of this very solution
    times = orbit.starting_times(z)
    known: list[list[np.ndarray]] = [[] for _ in orbit.pieces]
    segments: list[list[Viewed]] = [[] for _ in orbit.pieces]
    for segment, own in zip(orbit.layout.segments, nodes or (), strict=nodes is not None):
        known[segment.leg].append(own)
    for segment, piece in zip(orbit.layout.segments, orbit.segments, strict=True):
        segments[segment.leg].append((segment, piece, *orbit.layout.inputs_of(segment, z)))
    for i, piece in enumerate(orbit.pieces):
        x, scalars = orbit.layout.inputs(i, z)
        lasting = orbit.duration(z) if orbit.in_closure else float(scalars[0])
        passed_on = partial(_nodes, piece, known[i], segments[i])
        evenly = SAMPLES if orbit.in_closure else 0
        yield (piece, x, scalars, float(times[i]), lasting, passed_on, evenly), segments[i]


def _nodes(whole: Piece, known: list[np.ndarray], segments: list[Viewed]) -> np.ndarray:
    """States at the steps of a leg, of those of its segments; these are integrated if they are not known."""
    parts = known or [piece.nodes(x, scalars) for _, piece, x, scalars in segments]
    if len(parts) == 1:
        return parts[0]
    if sum(map(len, parts)) == len(whole.steps):
        return np.concatenate(parts)
    return np.concatenate([*(part[:-1] for part in parts), parts[-1][-1:]])


def _times_in(orbit: DiscretizedOrbit, z: np.ndarray) -> np.ndarray | None:
    """The times of cuts that stand in a solution, shape (m,), if they were chosen."""
    asked = orbit.discretization
    if not orbit.in_closure or not (asked.uneven or asked.evenly_first):
        return None
    if asked.evenly_first:
        return times_chosen(z, orbit.states, orbit.layout.others)
    m = (len(z) - orbit.layout.others + 1) // (orbit.states + 1)
    return np.append(0.0, z[len(z) - m : -1])


def _chosen(orbit: DiscretizedOrbit, times: np.ndarray) -> bool:
    """Whether times of cuts, shape (m,), are chosen, or those of segments of equal duration."""
    even = np.arange(len(times)) / len(times)
    return orbit.discretization.evenly_first and not np.allclose(times, even, rtol=0.0, atol=SAME_TIME)


def added_by_cuts(orbit: DiscretizedOrbit) -> int:
    """How many unknowns each further segment in all legs adds."""
    each = zip(orbit.itinerary.legs, orbit.layout.sizes, strict=True)
    return sum(n for leg, n in each if not leg.momentary) + int(orbit.uneven)

"""Discretised orbits through events: what they are, and how their unknowns are read.

Beside the data stands here only what reads them: what is computed of an orbit are functions over this class,
and `HybridOrbit` offers them to the engine.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Self, TypeVar

import numpy as np

from contwalk.problems.angles import whole_turns
from contwalk.problems.hybrid.margins import Guarded, Limit, Margins
from contwalk.problems.hybrid.shooting import LegMesh
from contwalk.problems.hybrid.stretch import Stretch
from contwalk.problems.hybrid.view import LegView
from contwalk.problems.kinks import Course
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.orbit.layout import Layout, Segment, joined
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.passage import Passage, passage_of
from contwalk.problems.orbit.piece import Piece
from contwalk.problems.orbit.section import Section
from contwalk.problems.orbit.traced_leg import Closing, ScalarInputs
from contwalk.problems.orbit.word import Word
from contwalk.problems.parameter_line import Ends
from contwalk.system import Condition, Neutral, System, Transition

# Solutions that are looked at again soon: at a step's ends.
MOST_VIEWS = 4

Kind = TypeVar("Kind", bound="DiscretizedOrbit")


class DiscretizedOrbit(OrbitData):
    """Orbits of one word on given steps; see `HybridOrbit` for its parameters."""

    layout: Layout

    def __init__(
        self,
        system: System,
        word: Word,
        parameters: Mapping[str, float],
        free: str,
        path: Ends | None = None,
        pins: Sequence[Neutral] = (),
        reference: np.ndarray | None = None,
        subharmonic: int = 1,
        discretization: Discretization | None = None,
    ) -> None:
        super().__init__(system, parameters, free, path, pins, reference, subharmonic, discretization)
        self.word = word
        self.turns = np.zeros(self.states)
        self._mesh: LegMesh | None = None
        self._most_steps: int | None = None
        # Segments of each leg; how many a stored branch has room for.
        self.cuts, self.room, self.layout = 1, None, self._laid_out(1)

    def _laid_out(self, cuts: int) -> Layout:
        """Where what stands with so many segments in each leg; one that is collapsed has one."""
        sizes = [len(self.system.states_of(leg.mode)) for leg in self.word.legs]
        each = [1 if leg.collapsed else cuts for leg in self.word.legs]
        return Layout(sizes, self.forced, len(self.pins), each)

    def of_word(self, word: Word, times: int = 1, turns: np.ndarray | None = None) -> Self:
        """The orbits of another word, lasting `times` as many periods of the forcing."""
        return self.like(type(self), word, times, turns)

    def like(self, kind: type[Kind], word: Word, times: int = 1, turns: np.ndarray | None = None) -> Kind:
        """As `of_word`, of a class of orbits."""
        other = kind(
            self.system,
            word,
            self.parameters,
            self.free,
            self.line.ends,
            self.pins,
            self.reference,
            self.subharmonic * (times if self.forced else 1),
            self.discretization,
        )
        other.turns = self.turns * times if turns is None else turns
        other.effort = self.effort
        return other

    def with_room(self, cuts: int) -> Self:
        """The same orbits with room for so many segments in each leg along their branch."""
        return self._varied(room=cuts)

    def turning(self, turns: np.ndarray) -> Self:
        """The same orbits with states that grow by so much in each closure."""
        return self._varied(turns=turns)

    def on(self, mesh: LegMesh, section: Section | None) -> Self:
        """The same problem on another mesh, with another section."""
        return self._varied(_mesh=mesh, section=section)

    def cut_into(self, cuts: int) -> Self:
        """The same problem with so many segments in each leg; its steps are made anew: see `adapted_to`."""
        return self if cuts == self.cuts else self._varied(cuts=cuts, layout=self._laid_out(cuts))

    @property
    def cuttable(self) -> bool:
        """Whether legs may be cut into segments: those of words that end with an event, and a single leg that
        ends where it began.
        """
        return self.word.eventful or len(self.word) == 1

    def fitting(self, z: np.ndarray) -> Self:
        """The same problem with the segments of a solution, which its length tells."""
        if len(z) == self.size + 1:
            return self
        bare, more = self.sizes_with_cuts
        return self.cut_into(1 + (len(z) - 1 - bare) // more)

    @property
    def mesh(self) -> LegMesh:
        """The steps of this discretisation."""
        if self._mesh is None:
            raise ValueError("the problem has no mesh yet: see `adapted_to`")
        return self._mesh

    @cached_property
    def passages(self) -> tuple[Passage, ...]:
        """The legs' compiled functions."""
        inputs = ScalarInputs(self.line.own, self.line.moving, self.pins)
        return tuple(
            passage_of(self.system, leg, self.word.target(i), inputs, Closing(self.word.image_at(i)))
            for i, leg in enumerate(self.word.legs)
        )

    @property
    def sizes_with_cuts(self) -> tuple[int, int]:
        """Number of unknowns with one segment in each leg, and how many each further one adds."""
        each = zip(self.word.legs, self.layout.sizes, strict=True)
        return self.layout.rest.stop, sum(n for leg, n in each if not leg.collapsed)

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """The legs on their steps."""
        return self.known.once("pieces", self._pieces)

    def _pieces(self) -> tuple[Piece, ...]:
        if self.cuts == 1:
            return self.segments
        own = [self.layout.segments_of(i) for i in range(self.layout.legs)]
        ends = np.cumsum([0, *map(len, own)])
        return tuple(
            replace(self.segments[b - 1], steps=joined(places, self.mesh.steps[a:b]))
            for places, a, b in zip(own, ends[:-1].tolist(), ends[1:].tolist(), strict=True)
        )

    @property
    def segments(self) -> tuple[Piece, ...]:
        """The segments of the legs on their steps, each in its own time."""
        return self.known.once("segments", self._segments)

    def _segments(self) -> tuple[Piece, ...]:
        mesh = self.mesh
        return tuple(
            Piece(self.passages[own.leg], steps, mesh.method, self.line.constants, not own.last)
            for own, steps in zip(self.layout.segments, mesh.steps, strict=True)
        )

    def view(self, z: np.ndarray) -> tuple[LegView, ...]:
        """A solution looked at leg by leg."""
        return self.known.at("view", z, MOST_VIEWS, lambda: self._looked_at(z))

    def _looked_at(self, z: np.ndarray) -> tuple[LegView, ...]:
        times, nodes = self.starting_times(z), self.known.found("nodes", z)
        known: list[list[np.ndarray]] = [[] for _ in self.pieces]
        for segment, own in zip(self.layout.segments, nodes or (), strict=nodes is not None):
            known[segment.leg].append(own)
        return tuple(
            LegView(
                piece,
                *self.layout.inputs(i, z),
                float(times[i]),
                self._left(i),
                self._segments_of(z, i),
                known[i],
            )
            for i, piece in enumerate(self.pieces)
        )

    def _segments_of(self, z: np.ndarray, i: int) -> list[tuple[Segment, Piece, np.ndarray, np.ndarray]]:
        """The segments of leg i, if there are several."""
        if self.layout.cuts[i] == 1:
            return []
        return [
            (segment, piece, *self.layout.inputs_of(segment, z))
            for segment, piece in zip(self.layout.segments, self.segments, strict=True)
            if segment.leg == i
        ]

    def _left(self, i: int) -> Collection[str]:
        """Transitions whose guards are zero where leg i starts, if what leads into it is hard."""
        before, word = self.word.legs[i - 1].transition, self.word
        if before is None or before.role != "hard":
            return ()
        return self.system.left_at_zero(word.leading_in(self.system, i), word.legs[i].mode)

    @cached_property
    def named_conditions(self) -> dict[str, Condition]:
        """The system's conditions by name."""
        return {condition.name: condition for condition in self.system.conditions}

    def duration(self, z: np.ndarray) -> float:
        """Duration of the closure, seconds."""
        return float(z[self.layout.durations].sum())

    def starting_times(self, z: np.ndarray) -> np.ndarray:
        """Times at which the legs start, and the last one ends, shape (m + 1,)."""
        first = 0.0 if self.layout.start is None else float(z[self.layout.start])
        return first + np.concatenate([[0.0], np.cumsum(z[self.layout.durations])])

    @property
    def whole(self) -> tuple[str, int]:
        """How the orbit closes (`full`, or the name of a symmetry), and how many closures its period has."""
        name, times = self.word.relabelled(self.system)
        return name or "full", times

    @property
    def signature(self) -> tuple[str, ...]:
        """Names of the events, from the one that leads into the first leg."""
        return self.word.signature(self.system)

    @property
    def whole_word(self) -> Word:
        """The word of the whole motion, images included."""
        return self.word.unfolded(self.system)

    @property
    def rounds(self) -> int:
        """Closures of the motion that `max_abs` is of: a relabelled closure is a whole one."""
        return 2 if self.word.image else 1

    @property
    def forcings(self) -> float:
        """Periods of the forcing in a closure: a half of them, if the closure is half of a cycle."""
        return self.subharmonic / self.rounds

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
        """
        z = np.zeros(self.layout.size + 1)
        for place, passage, x in zip(self.layout.states, self.passages, states, strict=True):
            z[place] = x[list(passage.states)]
        z[self.layout.durations], z[self.layout.drifts], z[-1] = lasting, drifts, value
        if self.layout.start is not None:
            z[self.layout.start] = start
        return z

    def magnitudes_of(self, weights: np.ndarray) -> np.ndarray:
        """Typical magnitudes of all states, of weights of the unknowns; 1 for those of no leg."""
        magnitudes = np.ones(self.states)
        for place, passage in zip(self.layout.states, self.passages, strict=True):
            magnitudes[list(passage.states)] = weights[place] / np.sqrt(len(self.layout.segments))
        return magnitudes

    @property
    def clocked(self) -> bool:
        """Whether an event happens at given times: at rest, too."""
        each = zip(self.word.legs, self.passages, strict=True)
        return any(leg.transition is not None and own.of_time_alone(leg.transition) for leg, own in each)

    @property
    def events(self) -> list[tuple[int, Transition]]:
        """The legs that last until an event whose guard depends on the states, and that event."""
        each = [(i, leg.transition) for i, leg in enumerate(self.word.legs) if not leg.collapsed]
        return [(i, own) for i, own in each if own and not self.passages[i].of_time_alone(own)]

    @property
    def guard_scales(self) -> np.ndarray:
        """Units of the legs' guards, shape (m,)."""
        return np.ones(self.layout.legs) if self.mesh.guards is None else self.mesh.guards

    def pieces_of(self, z: np.ndarray, i: int) -> list[LegView]:
        """Leg i looked at, piece by piece where there are soft transitions on it."""
        return [self.view(z)[i]]

    def leg_starts(self, z: np.ndarray) -> list[tuple[str, np.ndarray]]:
        """Modes of the legs, and full states at their starts."""
        each = zip(self.passages, self.layout.states, strict=True)
        return [(passage.leg.mode, passage.full(z[place])) for passage, place in each]

    def courses(self, z: np.ndarray) -> list[Course]:
        """The legs as they are looked at for kinks of their fields."""
        if all(passage.switching is None for passage in self.passages):
            return []
        return [course for leg in self.view(z) for course in leg.course()]

    def duration_gradient(self, z: np.ndarray) -> np.ndarray:
        """Derivative of the closure's duration by unknowns and free parameter, shape (N + 1,)."""
        gradient = np.zeros(len(z))
        gradient[self.layout.durations] = 1.0
        return gradient

    def nearest_turn(self, z: np.ndarray, near: np.ndarray) -> np.ndarray:
        """The same solution with its angles turned as near as possible to those of another one.

        Of a forced orbit the instant at which it begins counts modulo its period, as an angle does.
        """
        if len(z) != self.size + 1:
            return self.fitting(z).nearest_turn(z, near)
        periods = self.periods
        if self.layout.start is not None:
            periods[self.layout.start] = self.rounds * self.duration(z)
        return z + whole_turns(near - z, periods)

    def measure_guards(self, units: np.ndarray) -> None:
        """Give the legs' guards their units, shape (m,): views tell them, which need the steps first."""
        self._mesh = replace(self.mesh, guards=units)

    # -- what is computed of them, of whichever class they are -------------------------------------------

    @property
    @abstractmethod
    def limits(self) -> tuple[Limit, ...]:
        """All that must stay positive for an orbit to be the machine's."""

    @property
    @abstractmethod
    def guarded(self) -> tuple[Guarded | None, ...]:
        """The sampled guards that `limits` are of."""

    @abstractmethod
    def residual(self, z: np.ndarray) -> np.ndarray:
        """F(z), shape (N,), for far less than with its derivatives."""

    @abstractmethod
    def margins(self, z: np.ndarray) -> Margins:
        """Values of all limits at a solution."""

    @abstractmethod
    def stretches(self, z: np.ndarray) -> list[Stretch]:
        """The legs of the whole motion, images included."""

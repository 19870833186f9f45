"""What every discretised orbit is made of, whatever its unknowns are."""

from __future__ import annotations

import copy
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Self

import numpy as np

from contwalk.numerics.linear import norm_in
from contwalk.problems import neutral as neutrals
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.orbit.effort import Effort
from contwalk.problems.orbit.evaluations import Evaluations
from contwalk.problems.orbit.itinerary import Itinerary
from contwalk.problems.orbit.layout import Positions
from contwalk.problems.orbit.passage import Passage
from contwalk.problems.orbit.piece import Piece
from contwalk.problems.orbit.protocol import Orbit
from contwalk.problems.orbit.section import Reference
from contwalk.problems.orbit.stretch import Stretch
from contwalk.problems.orbit.view import LegView
from contwalk.problems.parameter_line import Ends, ParameterLine
from contwalk.system import Neutral, System

# An orbit that goes a smaller part of its own size in one period has become a point.
MOVES = 1e-2


class OrbitData(Orbit):
    """A system, the line of its parameters, what is pinned, and how finely orbits are computed."""

    # Whether the one leg is in times of the closure: its period is no unknown where a force has it.
    in_closure: ClassVar[bool] = False
    layout: Positions
    _mesh: Any
    # Of an integral phase condition, the orbit to which the phase is nearest.
    reference_orbit: Reference | None = None

    def __init__(
        self,
        system: System,
        itinerary: Itinerary,
        parameters: Mapping[str, float],
        free: str,
        path: Ends | None = None,
        *,
        pins: Sequence[Neutral] = (),
        reference: np.ndarray | None = None,
        subharmonic: int = 1,
        discretization: Discretization | None = None,
    ) -> None:
        self.system, self.itinerary = system, itinerary
        self.line = ParameterLine.of(system, parameters, free, path)
        self.free, self.parameters = free, self.line.parameters
        self.pins, self.reference = tuple(pins), reference
        self.subharmonic = subharmonic
        self.discretization = discretization or Discretization()
        self.states = len(system.states)
        self.forced = system.period is not None
        self.section, self._mesh = None, None
        self.known, self.effort = Evaluations(), Effort()
        self.turns = np.zeros(self.states)
        self._lay_out()

    @abstractmethod
    def _lay_out(self) -> None:
        """Where unknowns stand until there are steps."""

    @property
    @abstractmethod
    def passages(self) -> tuple[Passage, ...]:
        """The legs' compiled functions."""

    @property
    def mesh(self) -> Any:
        """The steps of this discretisation: a `Mesh`."""
        if self._mesh is None:
            raise ValueError("the problem has no mesh yet: see `adapted_to`")
        return self._mesh

    @property
    def segments(self) -> tuple[Piece, ...]:
        """The segments of the legs on their steps."""
        return self.known.once("segments", lambda: _segments(self))

    def explicit(self, z: np.ndarray) -> tuple[Any, np.ndarray]:
        """The orbit with a leg for every smooth piece, and its unknowns: itself, if none is condensed.

        z, and what is returned, has the shape (N + 1,).
        """
        return self, z

    @abstractmethod
    def legs_viewed(self, z: np.ndarray) -> tuple[LegView, ...]:
        """The legs, each looked at. z has the shape (N + 1,)."""

    @abstractmethod
    def view(self, z: np.ndarray) -> Sequence[LegView]:
        """A solution of shape (N + 1,) looked at piece by smooth piece."""

    @abstractmethod
    def stretches(self, z: np.ndarray) -> list[Stretch[Any]]:
        """The legs of the whole motion of z, shape (N + 1,), images included."""

    @property
    def forcings(self) -> float:
        """Periods of the forcing in a closure: a part of them, if the closure is part of a cycle."""
        return self.subharmonic / self.itinerary.closures

    @property
    def whole(self) -> tuple[str, int]:
        """How the orbit closes (`full`, or the name of a symmetry), and how many closures its period has."""
        name, times = self.itinerary.relabelled(self.system)
        return name or "full", times

    @property
    def rounds(self) -> int:
        """Closures of the motion that `max_abs` is of: the whole, if the orbit closes up to a mirror image.

        A relabelled closure is a whole one: the machine is in the same state again.
        """
        image = self.itinerary.image
        return self.itinerary.order if image and self.system.symmetry(image).role == "spatial" else 1

    def passes(self, z: np.ndarray) -> tuple[list[np.ndarray], Any, Any]:
        """Of all segments the states at their steps, their ends, and the derivatives of these."""
        each = zip(self.layout.segments, self.segments, strict=True)
        found = [piece.passed(*self.layout.inputs_of(segment, z)) for segment, piece in each]
        nodes, ended, moved = (list(parts) for parts in zip(*found, strict=True))
        return nodes, ended, moved

    @property
    def places(self) -> list[tuple[slice, Passage]]:
        """Where the states at the starts of all segments stand, and of which legs they are."""
        return [(segment.states, self.passages[segment.leg]) for segment in self.layout.segments]

    @property
    def guard_scales(self) -> np.ndarray:
        """Units of the legs' guards, shape (m,)."""
        return np.ones(self.layout.legs) if self.mesh.guards is None else self.mesh.guards

    @property
    def size(self) -> int:
        """Number of unknowns without the free parameter."""
        return self.layout.size

    @property
    def method(self) -> str:
        """How motions are integrated, and why so."""
        return f"{self.mesh.method}, {self.mesh.reason}"

    @property
    def evaluations(self) -> int:
        """Steps of integration so far, in right-hand sides."""
        return self.effort.spent

    @property
    def periods(self) -> np.ndarray:
        """Periods of the states that are angles, 0 for the others, shape (N + 1,)."""
        result = np.zeros(self.size + 1)
        own = np.array([s.period or 0.0 for s in self.system.states])
        for place, passage in self.places:
            result[place] = own[list(passage.states)]
        return result

    @property
    def eventful(self) -> bool:
        """Whether the closure ends with an event."""
        return self.itinerary.eventful

    @property
    def smallest(self) -> int:
        """The leg whose start has fewest states, of those that last: on a collapsed one there is no flow.

        Without an event only the first one is a section.
        """
        if not self.itinerary.eventful:
            return 0
        lasting = [i for i, leg in enumerate(self.itinerary.legs) if not leg.collapsed]
        return min(lasting, key=lambda i: self.layout.sizes[i])

    def timed(self, i: int) -> bool:
        """Whether the time is a coordinate of the start of leg i: it may begin earlier or later."""
        return self.forced and (self.itinerary.eventful or i > 0)

    def extended(self, i: int) -> np.ndarray:
        """Typical magnitudes of the coordinates at the start of leg i: its states, and time if it is one.

        Shape (n_i,), or (n_i + 1,) with the time.
        """
        own = self.mesh.variation[list(self.passages[i].states)]
        return np.append(own, self.mesh.total) if self.timed(i) else own

    @property
    def spectrum_size(self) -> int:
        """Number of multipliers: dimension of the smallest section, pinned directions and those across the
        surfaces of what is conserved left out.
        """
        left_out = len(self.pins) + len(self.system.conserved)
        return self.layout.sizes[self.smallest] - 1 + int(self.forced) - left_out

    def moves(self, z: np.ndarray) -> bool:
        """Whether the orbit of z is more than a point; of a forced system it may be one.

        z has the shape (N + 1,).
        """
        if self.forced:
            return True
        way = self.velocity(z) * self.duration(z)
        return norm_in(way, self.mesh.variation[list(self.passages[0].states)]) > MOVES

    def values_of(self, z: np.ndarray) -> dict[str, float]:
        """All parameters at z, by name. z has the shape (N + 1,)."""
        return self.line.at(float(z[-1]))

    def first_state(self, z: np.ndarray) -> np.ndarray:
        """The state at the start of the first leg, shape (n,)."""
        return self.passages[0].full(z[self.layout.states[0]])

    def held(self, pin: Neutral, x: np.ndarray, values: Mapping[str, float]) -> tuple[np.ndarray, float]:
        """Across which direction, (n,), a full state is held, and how far it is from there."""
        assert self.reference is not None
        normal = np.zeros(self.states)
        if pin.pin is None:
            g = neutrals.generator_at(pin, self.reference, self.parameters)
            normal = g / np.linalg.norm(g)
            return normal, float(normal @ (x - self.reference))
        k = self.system.state_names.index(pin.pin)
        normal[k] = 1.0
        return normal, float(x[k] - (self.reference[k] if pin.value is None else values[pin.value]))

    def weighted(self, magnitudes: np.ndarray) -> np.ndarray:
        """Weights of the unknowns for typical magnitudes of all states; 1 for what is no state.

        Magnitudes have the shape (n,), weights (N + 1,).
        """
        weights = np.ones(self.size + 1)
        for place, passage in self.places:
            weights[place] = magnitudes[list(passage.states)] * np.sqrt(len(self.layout.segments))
        return weights

    def varied(self, **changes: Any) -> Self:
        """The same with some attributes changed; nothing that is remembered of this one is true of it."""
        other = copy.copy(self)
        other.known = Evaluations()
        for name, value in changes.items():
            setattr(other, name, value)
        return other


def _segments(orbit: OrbitData) -> tuple[Piece, ...]:
    mesh, each = orbit.mesh, zip(orbit.layout.segments, orbit.mesh.steps, strict=True)
    return tuple(
        Piece(orbit.passages[own.leg], steps, mesh.method, orbit.line.constants, not own.last)
        for own, steps in each
    )

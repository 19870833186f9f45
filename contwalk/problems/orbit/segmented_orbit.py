"""Discretised orbits of smooth systems, in segments: what they are, and how their unknowns are read.

The segments are of equal duration, or cut where a run's discretisation has it so. Times of such cuts, as
parts of the closure, stand among the unknowns, behind drifts and before the free parameter, and are held by
an equation each: a stored solution then tells the cuts that it was solved on.

Beside the data stands here only what reads them: what is computed of an orbit are functions over this class,
and `PeriodicOrbit` offers them to the engine.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, Self, TypeVar

import numpy as np

from contwalk.problems.angles import whole_turns
from contwalk.problems.forcing import period_at
from contwalk.problems.kink import Kink
from contwalk.problems.kinks import Course
from contwalk.problems.orbit.closure import closure_image
from contwalk.problems.orbit.closure_view import SAMPLES, ClosureView
from contwalk.problems.orbit.itinerary import Itinerary, Leg
from contwalk.problems.orbit.layout import ClosureLayout
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.passage import Passage, closure_of
from contwalk.problems.orbit.piece import passed
from contwalk.problems.orbit.section import Section, section_at
from contwalk.problems.orbit.shooting import Mesh, velocity
from contwalk.problems.orbit.solution import Curve, Solution
from contwalk.problems.orbit.stretch import Stretch
from contwalk.problems.orbit.traced_leg import Closing, ScalarInputs
from contwalk.system.declarations import ParameterValues

# Halves: pitchforks of orbits with a symmetry that nobody declared stay pitchforks as well.
PARTS = 2
# Linearizations and motions that are kept: a step asks for the same ones several times.
MOST_KEPT = 12

Kind = TypeVar("Kind", bound="SegmentedOrbit")


class SegmentedOrbit(OrbitData):
    """Orbits of one closure on given steps; see `PeriodicOrbit` for its parameters."""

    _mesh: Mesh | None

    def _begin(self) -> None:
        self.itinerary, self.turns = Itinerary((Leg(self.system.modes[0].name),)), np.zeros(self.states)
        self._compile()
        self.parts = PARTS  # of the closure in which the steps are alike
        self.layout = self._laid_out(1)

    def _compile(self) -> None:
        """The field over one closure, and the map at its end."""
        inputs = ScalarInputs(self.line.own, self.line.moving, self.pins)
        closing = Closing(self.itinerary.image, self.itinerary.power, self.forcings)
        self.passage: Passage = closure_of(self.system, inputs, closing)

    def closing(self, turns: np.ndarray, image: str = "", power: int = 1, order: int = 1) -> Self:
        """The same orbits closed up to a symmetry (or to none), with angles that turn, (n,)."""
        other = self.varied(itinerary=Itinerary(self.itinerary.legs, image, power, order), turns=turns)
        other._compile()
        return other

    def on(self, mesh: Mesh, section: Section | None) -> Self:
        """The same problem on another mesh, with another section."""
        return self.varied(
            _mesh=mesh, section=section, reference_orbit=None, layout=self._laid_out(mesh.segments, mesh.cuts)
        )

    def _laid_out(self, cuts: int, times: np.ndarray | None = None) -> ClosureLayout:
        """Where what stands in so many segments, which start at some times."""
        if self.uneven and times is None:
            times = np.arange(cuts) / cuts
        return ClosureLayout(self.states, self.forced, len(self.pins), cuts, times if self.uneven else None)

    @property
    def uneven(self) -> bool:
        """Whether times of cuts stand among the unknowns."""
        return self.discretization.uneven

    @property
    def passages(self) -> tuple[Passage, ...]:
        """The one leg's compiled functions."""
        return (self.passage,)

    def passes(self, z: np.ndarray) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Of each segment the states at its steps, its end, and the derivatives of that: all in one pass."""
        times, ends = self.mesh.times, self.mesh.ends
        nodes, ended, moved = passed(self.segments[-1], times, ends, self.starts(z), self.scalars(z))
        return list(zip(np.split(nodes, ends[:-1] + 1), ended, moved, strict=True))

    def given(self, z: np.ndarray) -> np.ndarray:
        """What the field depends on at z: scalars and fixed parameters. z has the shape (N + 1,)."""
        return np.concatenate([self.scalars(z), self.line.constants])

    def segments_in(self, z: np.ndarray) -> int:
        """Number of segments of a solution, which its length tells."""
        k = len(self.passage.columns)
        return (len(z) - k + 1) // (self.states + 1) if self.uneven else (len(z) - k) // self.states

    def cuts_in(self, z: np.ndarray) -> np.ndarray:
        """Times at which the segments of a solution start, shape (m,)."""
        m = self.segments_in(z)
        if not self.uneven:
            return np.arange(m) / m
        return np.concatenate([[0.0], z[len(z) - m : -1]])

    def scalar_places(self, z: np.ndarray) -> np.ndarray:
        """Where the columns of the passage stand in z, shape (k,)."""
        first, k = self.segments_in(z) * self.states, len(self.passage.columns)
        return np.append(np.arange(first, first + k - 1), len(z) - 1)

    def laid_out(self, states: np.ndarray, scalars: np.ndarray, cuts: np.ndarray | float = 0.0) -> np.ndarray:
        """A vector of unknowns, or of something of each, from its parts.

        Parameters
        ----------
        states : ndarray, shape (m, n) or (m n,)
        scalars : ndarray, shape (k,)
        cuts : ndarray, shape (m,), or float
            The times at which segments start; or what stands in the place of all these.
        """
        flat = np.ravel(states)
        if not self.uneven:
            return np.concatenate([flat, scalars])
        inner = np.broadcast_to(cuts, len(flat) // self.states)[1:]
        return np.concatenate([flat, scalars[:-1], inner, scalars[-1:]])

    def starts(self, z: np.ndarray) -> np.ndarray:
        """States at the starts of the segments, shape (m, n)."""
        return z[: self.mesh.segments * self.states].reshape(self.mesh.segments, self.states)

    def scalars(self, z: np.ndarray) -> np.ndarray:
        """Period (where unknown), drifts and free parameter: the columns of the passage.

        Shape (k,) of z, shape (N + 1,).
        """
        return z[self.scalar_places(z)] if self.uneven else z[self.mesh.segments * self.states :]

    def duration(self, z: np.ndarray) -> float:
        """Duration of the closure, seconds. z has the shape (N + 1,)."""
        if not self.forced:
            return float(self.scalars(z)[0])
        return self.forcings * period_at(self.system, self.values_of(z))

    def solution(self, z: np.ndarray) -> Solution:
        """The motion of z on these steps, of which every part is integrated once.

        z has the shape (N + 1,).
        """

        def made() -> Solution:
            own = z.copy()
            return Solution(self.passage, self.mesh, self.given(own), self.starts(own))

        return self.known.at("solution", z, MOST_KEPT, made)

    def curve(self, z: np.ndarray) -> Curve:
        """The integrated part of the motion, in 0..1. z has the shape (N + 1,)."""
        return self.solution(z).curve

    def view(self, z: np.ndarray) -> tuple[ClosureView, ...]:
        """The integrated part of the motion of z, shape (N + 1,): one leg."""
        constants = self.passage.field(PLAIN).constants(self.given(z))
        return (ClosureView(self.segments[-1], self.curve(z), constants, self.duration(z)),)

    def stretches(self, z: np.ndarray) -> list[Stretch[ClosureView]]:
        """The whole motion of z, shape (N + 1,): the integrated part, and its images, one after the other."""
        (view,), system, itinerary = self.view(z), self.system, self.itinerary
        p, every = ParameterValues(**self.values_of(z)), tuple(range(self.states))

        def seen(number: int) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
            return lambda _, states: closure_image(system, itinerary, states, p, number)

        return [Stretch("", view, j * view.duration, seen(j), every) for j in range(itinerary.closures)]

    def velocity(self, z: np.ndarray) -> np.ndarray:
        """dx/dt at the start. z has the shape (N + 1,), the velocity (n,)."""
        return self.solution(z).velocities[0] / self.duration(z)

    def kinks_at_events(self, z: np.ndarray) -> tuple[Kink, ...]:
        """None: there are no events. z has the shape (N + 1,)."""
        return ()

    def courses(self, z: np.ndarray) -> list[Course]:
        """The motion as it is looked at for kinks of the field. z has the shape (N + 1,)."""
        if self.passage.switching is None:
            return []
        curve = self.curve(z)
        course = self.passage.course(self.given(z), *curve.sampled(SAMPLES), curve.at)
        return [] if course is None else [course]

    def nearest_turn(self, z: np.ndarray, near: np.ndarray) -> np.ndarray:
        """The same solution with its angles turned as near as possible to those of another one.

        All have the shape (N + 1,).
        """
        return z + whole_turns(near - z, self.periods)

    # -- what is computed of them ------------------------------------------------------------------------

    @abstractmethod
    def adapted_to(self, z: np.ndarray, weights: np.ndarray, tolerance: float | None = None) -> Any:
        """The problem on steps for the orbit of z. z and weights have the shape (N + 1,)."""


def section_through(
    problem: SegmentedOrbit, x: np.ndarray, values: np.ndarray, magnitudes: np.ndarray
) -> Section | None:
    """The section through a state, across the flow there; of an orbit that is a point, the one it has.

    x and magnitudes have the shape (n,).
    """
    if problem.forced:
        return None
    own = velocity(problem.passage, x, 0.0, values)
    if np.linalg.norm(own / magnitudes) <= 1e-9 and problem.section is not None:
        return problem.section
    return section_at(x, own, magnitudes)

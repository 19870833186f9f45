"""What becomes of a small deviation along an orbit, at the same time as the orbit itself.

At an event the neighbour is late by d = -g_x v / g_t, where g is the guard at the end of the leg. A moment
after, it differs by R_x v + (R_t - f) d: what the transition R makes of it, less what the orbit has moved on
meanwhile.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from contwalk import flow
from contwalk.errors import ContwalkError
from contwalk.problems.orbit import monodromy
from contwalk.problems.orbit.lifts import TANGENT
from contwalk.problems.orbit.modes import NOTHING, Mode, chosen_multiplier, eigenvector, linear_part
from contwalk.problems.orbit.monodromy import NO_RATE
from contwalk.problems.orbit.orbit_data import OrbitData


class Deviations:
    """Deviations from an orbit.

    Parameters
    ----------
    problem : PeriodicOrbit or HybridOrbit
    z : ndarray, shape (N + 1,)
        A solution.
    """

    def __init__(self, problem: OrbitData, z: np.ndarray) -> None:
        self.problem, self.z = problem.explicit(z)
        self.legs = self.problem.layout.legs
        self.timed = self.problem.timed(0)

    @property
    def rounds(self) -> int:
        """Closures of the motion that `stretches` are of."""
        return len(self.problem.stretches(self.z)) // self.legs

    @cached_property
    def _jacobian(self) -> np.ndarray:
        return self.problem.linearize(self.z).jacobian

    def _drifting(self, i: int, j: int = 0) -> np.ndarray:
        """What drifts along pinned directions add to the velocity at the start of leg i, of its segment j."""
        size = self.problem.layout.sizes[i]
        along = _columns([v[:size] for v in monodromy.pinned_directions(self.problem, self.z, i, j)], size)
        return along @ self.z[self.problem.layout.drifts]

    def _velocity(self, i: int) -> np.ndarray:
        """dx/dt at the start of leg i, as seen from the ground."""
        flowing = monodromy.flow_direction(self.problem, self.z, i)[: self.problem.layout.sizes[i]]
        return flowing - self._drifting(i)

    def mode(self, number: int) -> Mode:
        """A mode by the number of its multiplier, from 1 on; along pinned directions it starts at zero.

        It starts at the event that leads into the first leg, unless it is forgotten within a closure.

        Raises
        ------
        ContwalkError
            If there is no multiplier of this number, or it is infinite.
        """
        problem, z = self.problem, self.z
        multiplier = chosen_multiplier(problem.multipliers(z, self._jacobian).values, number)
        own, size = problem.extended(0), problem.layout.sizes[0]
        product = monodromy.once_round(problem, self._jacobian, 0)
        v = eigenvector(product, monodromy.neutral_directions(problem, z, 0), own, number)
        if problem.itinerary.eventful and abs(multiplier) > NOTHING:
            v = product @ v / multiplier
        start = v[:size]
        if self.timed:
            start = start - self._velocity(0) * v[size]
        along = _columns([direction[:size] for direction in monodromy.pinned_directions(problem, z, 0)], size)
        if along.shape[1]:
            start = start - along @ np.linalg.solve(self._held @ along, self._held @ start)
        flowing = [] if problem.forced else [self._velocity(0)]
        neutral = np.hstack([_columns(flowing, size), along])
        return Mode(multiplier, start, neutral, own[:size])

    @cached_property
    def _held(self) -> np.ndarray:
        """Across which directions the start is held, shape (k, n)."""
        problem, x = self.problem, self.problem.first_state(self.z)
        normals = [problem.held(pin, x, problem.values_of(self.z))[0] for pin in problem.pins]
        return np.array(normals)[:, list(problem.passages[0].states)]

    def full(self, start: np.ndarray) -> np.ndarray:
        """A deviation at the start, of all states of the system; those that do not exist there are zero.

        Shapes (n_0,) and (n,).
        """
        passage = self.problem.passages[0]
        return passage.full(start.real) + 1j * passage.full(start.imag)

    def closure(self, start: np.ndarray, which: int, shares: Sequence[np.ndarray]) -> list[np.ndarray]:
        """Deviations of all states along each leg of a closure, as seen from the ground, each (k, n).

        Parameters
        ----------
        start : ndarray
        which : int
            Which closure of those in `rounds`.
        shares : sequence of ndarray, shape (k,)
            Instants of each leg, 0 to 1.
        """
        found, d = [], start
        stretches = self.problem.stretches(self.z)[which * self.legs : (which + 1) * self.legs]
        for i, (stretch, at) in enumerate(zip(stretches, shares, strict=True)):
            passage, states = self.problem.passages[i], self._along(i, d, at)
            n = len(passage.states)
            times = stretch.view.start + stretch.view.duration * at
            own, moved = passage.full(states[:, :n]), passage.full(states[:, n:])
            seen, scale = stretch.seen, self.problem.mesh.magnitudes
            if seen(times, own) is not own:  # else it is seen as it is integrated
                moved = linear_part(lambda y, t=times, s=seen: s(t, y), own, moved, scale)  # type: ignore[misc]
            found.append(moved)
            d = self._through(i, d)
        return found

    def _along(self, i: int, d: np.ndarray, at: np.ndarray) -> np.ndarray:
        """States of leg i at instants of it, 0 to 1, and deviations beside them, shape (k, 2 n)."""
        problem, layout = self.problem, self.problem.layout
        found = np.zeros((len(at), 2 * len(d)))
        for segment, piece in zip(layout.segments, problem.segments, strict=True):
            if segment.leg != i:
                continue
            x, scalars = layout.inputs_of(segment, self.z)
            field, n = piece.passage.field(TANGENT), len(x)
            c = field.constants(piece.values(scalars, np.zeros(len(scalars))))
            nodes = flow.along(field, c, piece.steps, np.concatenate([x, d]), piece.method)
            inside = at >= segment.begin
            if np.any(inside):
                own = layout.inside_of(segment, at[inside])
                between = flow.interpolation(field, c, piece.steps, nodes, piece.method)
                found[inside] = between(np.clip(own, piece.steps[0], piece.steps[-1]))
            d = nodes[-1, n:]
        return found

    def after(self, start: np.ndarray) -> np.ndarray:
        """The deviation after a closure. Shape (n_0,)."""
        for i in range(self.legs):
            start = self._through(i, start)
        return start

    def _through(self, i: int, d: np.ndarray) -> np.ndarray:
        """The deviation at the start of the leg after leg i, from that at the start of leg i."""
        problem, layout, jacobian = self.problem, self.problem.layout, self._jacobian
        for segment in layout.segments_of(i)[:-1]:
            d = jacobian[segment.ends, segment.states] @ d
        last = layout.segments_of(i)[-1]
        rows, place = last.ends, last.states
        x = jacobian[rows, place].copy()
        if last.following == place:  # the start is the next one's
            x += np.eye(len(x))
        if problem.itinerary.legs[i].transition is None:
            return x @ d
        guard = layout.guards + i
        rate = monodromy.by_duration(problem, last, jacobian, guard)
        if abs(rate) * problem.mesh.total <= NO_RATE * problem.guard_scales[i]:
            raise ContwalkError(
                f"Event '{problem.itinerary.legs[i].name}' is only touched: what becomes of a deviation "
                "there has no derivative.",
                "Name a point beside it.",
            )
        late = -float(jacobian[guard, place] @ d) / rate
        # A mirror may turn a drift round, so that it is left out on both sides.
        arriving = monodromy.by_duration(problem, last, jacobian, rows) - x @ self._drifting(
            i, len(layout.segments_of(i)) - 1
        )
        return x @ d + (arriving - self._velocity((i + 1) % self.legs)) * late


def _columns(vectors: Sequence[np.ndarray], size: int) -> np.ndarray:
    return np.array(vectors).reshape(len(vectors), size).T

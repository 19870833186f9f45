"""What becomes of a start state over a leg, or a segment of one, derivatives included.

Everything is integrated on given steps, which stay as they are during a solve: the equations that Newton's
method sees are smooth, and their derivatives are those of the integrator's own steps.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from contwalk import flow
from contwalk.problems.orbit.lifts import MIXED, PLAIN, TANGENT
from contwalk.problems.orbit.passage import Passage


@dataclass(frozen=True, eq=False)
class Piece:
    """A leg, or a segment of one, on its steps.

    Parameters
    ----------
    passage : Passage
    steps : ndarray
        Times in 0..1 of its steps, ends included: in its own time, or in that of the leg.
    method : str
    fixed : ndarray
        Values of the parameters, and their changes along a path.
    inner : bool
        Whether another segment of the leg follows it: then no transition does.
    """

    passage: Passage
    steps: np.ndarray
    method: str
    fixed: np.ndarray
    inner: bool = False

    def values(self, scalars: np.ndarray, *directions: np.ndarray) -> np.ndarray:
        """What a lift's functions depend on, in their order.

        Scalars and each direction have the shape (k,).
        """
        return np.concatenate([scalars, self.fixed, *directions])

    @property
    def mapped(self) -> bool:
        """Whether anything happens at its end."""
        return self.passage.mapped and not self.inner

    def _field(self, lift: str) -> flow.CompiledField:
        return self.passage.field(lift, implicit=flow.implicit(self.method))

    def before(self, lift: str, y: np.ndarray, scalars: np.ndarray, *directions: np.ndarray) -> np.ndarray:
        """A lift's states at the end, before the transition."""
        return self._before(lift, y, self.values(scalars, *directions))

    def _before(self, lift: str, y: np.ndarray, values: np.ndarray) -> np.ndarray:
        field = self._field(lift)
        return flow.along(field, field.constants(values), self.steps, y, self.method)[-1]

    def end(self, lift: str, y: np.ndarray, scalars: np.ndarray, *directions: np.ndarray) -> np.ndarray:
        """State after the transition and guard, of a lift order by order."""
        values = self.values(scalars, *directions)
        before = self._before(lift, y, values)
        if not self.mapped:
            return before
        map_ = self.passage.end(lift)
        return map_(1.0, before, map_.constants(values))

    def differentiated(
        self, lift: str, y: np.ndarray, scalars: np.ndarray, *directions: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """As `end`, with the derivatives by the state (its first n components) and the columns, (.,
        n + k).
        """
        x, moved = self.before_differentiated(lift, y, scalars, *directions)
        return self.through(lift, x, moved, self.values(scalars, *directions))

    def passed(self, x: np.ndarray, scalars: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The nodes, and `end` with its derivatives as `differentiated` has it, from one pass."""
        field, n, k = self._field(PLAIN), len(self.passage.states), len(self.passage.columns)
        columns, sources = _beginnings(n, n, k)
        values = self.values(scalars)
        c = field.constants(values)
        nodes, moved = flow.along_with_tangents(field, c, self.steps, x[None], columns, sources, self.method)
        return nodes, *self.through(PLAIN, nodes[-1], moved[0], values)

    def before_differentiated(
        self, lift: str, y: np.ndarray, scalars: np.ndarray, *directions: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """As `before`, with the derivatives by the state (its first n components) and the columns."""
        field, n, k = self._field(lift), len(self.passage.states), len(self.passage.columns)
        columns, sources = _beginnings(len(y), n, k)
        c = field.constants(self.values(scalars, *directions))
        return flow.tangents(field, c, self.steps, y, columns, sources, self.method)

    def changing(
        self,
        x: np.ndarray,
        scalars: np.ndarray,
        direction: tuple[np.ndarray, np.ndarray],
        along: tuple[np.ndarray, np.ndarray],
    ) -> np.ndarray:
        """Derivative of `end` in one direction, of the tangent lift, along another one.

        Directions are of the state and of the scalars. Of many states it is far cheaper than all derivatives.
        """
        moved, change = self._moved_along(x, scalars, direction, along)
        if not self.mapped:
            return change
        map_ = self.passage.end(TANGENT)
        _, derivative = map_.linearized(1.0, moved, map_.constants(self.values(scalars, direction[1])))
        return derivative[:, : len(moved)] @ change + derivative[:, len(moved) :] @ along[1]

    def _moved_along(
        self,
        x: np.ndarray,
        scalars: np.ndarray,
        direction: tuple[np.ndarray, np.ndarray],
        along: tuple[np.ndarray, np.ndarray],
    ) -> tuple[np.ndarray, np.ndarray]:
        """The tangent lift before the transition, and its derivative."""
        y, n, k = np.concatenate([x, direction[0]]), len(x), len(scalars)
        start = np.concatenate([along[0], np.zeros(n)])
        if not flow.implicit(self.method):
            end = self.before(MIXED, np.concatenate([y, start]), scalars, direction[1], along[1])
            return end[: 2 * n], end[2 * n :]
        # Of the tangent lift implicit steps have the Jacobian; of a further lift it takes long to compile.
        field, columns = self._field(TANGENT), np.column_stack([start, np.zeros((2 * n, k))])
        c = field.constants(self.values(scalars, direction[1]))
        end, moved = flow.tangents(field, c, self.steps, y, columns, np.arange(-1, k), self.method)
        return end, moved[:, 0] + moved[:, 1:] @ along[1]

    def through(
        self, lift: str, x: np.ndarray, moved: np.ndarray, values: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """The map at the end with its derivatives by the start and the columns."""
        if not self.mapped:
            return x, moved
        map_ = self.passage.end(lift)
        return self.through_map(map_, x, moved, values)

    def through_map(
        self, map_: flow.Field, x: np.ndarray, moved: np.ndarray, values: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """A map of the leg's end with its derivatives by the start and the columns."""
        c, k = map_.constants(values), len(self.passage.columns)
        value, derivative = map_.linearized(1.0, x, c)
        with np.errstate(over="ignore", invalid="ignore"):  # whoever asks looks whether it is finite
            total = derivative[:, : len(x)] @ moved
            total[:, -k:] += derivative[:, len(x) :]
        return value, total

    def at_the_end(self, x: np.ndarray, moved: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Derivatives by the start, (n, n), carried through the map at the end."""
        if not self.mapped:
            return moved
        map_ = self.passage.end(PLAIN)
        return map_.jacobian(1.0, x, map_.constants(values))[:, : len(x)] @ moved

    def along(self, x: np.ndarray, scalars: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """States at the steps, shape (s + 1, n), and their derivatives, shape (s + 1, n, n + k)."""
        field, n, k = self.passage.field(PLAIN), len(x), len(scalars)
        c = field.constants(self.values(scalars))
        return flow.tangents(field, c, self.steps, x, *_beginnings(n, n, k), self.method, every=True)

    def nodes(self, x: np.ndarray, scalars: np.ndarray) -> np.ndarray:
        """States at the steps, shape (s + 1, n_i)."""
        field = self.passage.field(PLAIN)
        return flow.along(field, field.constants(self.values(scalars)), self.steps, x, self.method)

    def at(self, nodes: np.ndarray, times: np.ndarray, scalars: np.ndarray) -> np.ndarray:
        """States at times in 0..1, from those at the steps.

        Times have the shape (m,), `nodes` (s + 1, n_i).
        """
        field = self.passage.field(PLAIN)
        c = field.constants(self.values(scalars))
        return flow.dense(field, c, self.steps, nodes, times, self.method)

    def velocity(self, x: np.ndarray, scalars: np.ndarray) -> np.ndarray:
        """dx/dt at the start, in the leg's own time. x has the shape (n_i,), scalars (k,)."""
        field = self.passage.field(PLAIN)
        return field(0.0, x, field.constants(self.values(scalars)))


@lru_cache
def _beginnings(length: int, n: int, k: int) -> tuple[np.ndarray, np.ndarray]:
    """Tangents at the start of a leg, and which column drives each: of n states, and of k columns."""
    columns, sources = np.eye(length, n + k), np.concatenate([np.full(n, -1), np.arange(k)])
    columns[n:] = 0.0
    columns[:, n:] = 0.0
    for array in (columns, sources):
        array.flags.writeable = False
    return columns, sources


def passed(
    last: Piece, times: np.ndarray, ends: np.ndarray, starts: np.ndarray, scalars: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As `Piece.passed`, of all segments of one leg in its own time at once.

    Parameters
    ----------
    last : Piece
        The last segment.
    times : ndarray, shape (s,)
        The steps of all, one after the other.
    ends : ndarray, shape (m,)
        Where in `times` the segments end.
    starts : ndarray, shape (m, n)
    scalars : ndarray, shape (k,)

    Returns
    -------
    nodes : ndarray, shape (s, n)
        States at `times`.
    ended : ndarray, shape (m, n)
    moved : ndarray, shape (m, n, n + k)
    """
    field, values, n = last.passage.field(PLAIN), last.values(scalars), starts.shape[1]
    columns, sources = _beginnings(n, n, len(scalars))
    c = field.constants(values)
    nodes, moved = flow.along_with_tangents(field, c, times, starts, columns, sources, last.method)
    ended = nodes[ends]
    ended[-1], moved[-1] = last.through(PLAIN, ended[-1], moved[-1], values)
    return nodes, ended, moved

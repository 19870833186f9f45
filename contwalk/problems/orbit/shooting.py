"""Multiple shooting: what becomes of a start state over a leg, or a segment of one, derivatives included.

Everything is integrated on the steps of a `Mesh`, which stays as it is during a solve: the equations that
Newton's method sees are smooth, and their derivatives are those of the integrator's own steps.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from contwalk import flow
from contwalk.errors import NotFinite
from contwalk.flow.method import Carried, choose
from contwalk.problems.kinks import at_the_end
from contwalk.problems.orbit.lifts import MIXED, PLAIN, TANGENT
from contwalk.problems.orbit.passage import Passage
from contwalk.problems.orbit.repeating import repeating

# An orbit that would go a smaller part of its magnitudes in one period is a point.
STILL = 1e-11
# What a state is taken to move at least, in parts of what the one that moves most does.
LEAST_SHARE = 1e-3
CONSTANT = 1e-5
# Local errors this small, in units of the magnitudes, are below rounding.
ROUNDED = 3e-15
# A motion that has grown so much when its steps vanish grows without bound.
BURST = 1e3
# What moves this much less on finer steps did not move.
SHRINKS = 0.3
# A motion that ends beyond this part of a leg may have passed the leg's own event.
AT_ITS_END = 1.0 - 1e-6
# Steps of a leg at most.
MOST_STEPS = 100_000


@dataclass(frozen=True, eq=False)
class Mesh:
    """Steps in time, 0 to 1 over the closure, of each segment, and how they came about.

    Parameters
    ----------
    steps : tuple of ndarray
        Times of each segment's steps, its two ends included.
    method : str
        The integrator, one of `flow.METHODS`.
    tolerance : float
        Local error of each state in units of its variation along the orbit.
    variation : ndarray, shape (n,)
        Half the range of each state, or its typical magnitude where it hardly moves.
    magnitudes : ndarray, shape (n,)
        Typical magnitudes of the states.
    growth : float
        The largest growth of a generic deviation within a segment.
    reason : str
        Why this integrator.
    """

    steps: tuple[np.ndarray, ...]
    method: str
    tolerance: float
    variation: np.ndarray
    magnitudes: np.ndarray
    growth: float = 1.0
    reason: str = ""

    @property
    def segments(self) -> int:
        """Number of segments."""
        return len(self.steps)

    @cached_property
    def times(self) -> np.ndarray:
        """Times of all segments' steps, one segment after the other: where two meet, a time is repeated."""
        return np.concatenate(self.steps)

    @cached_property
    def ends(self) -> np.ndarray:
        """Where in `times` the segments end, shape (m,)."""
        return np.cumsum([len(steps) for steps in self.steps]) - 1


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
        """What a lift's functions depend on, in their order."""
        return np.concatenate([scalars, self.fixed, *directions])

    @property
    def mapped(self) -> bool:
        """Whether anything happens at its end."""
        return self.passage.mapped and not self.inner

    def _field(self, lift: str) -> flow.CompiledField:
        return self.passage.field(lift, implicit=flow.implicit(self.method))

    def before(self, lift: str, y: np.ndarray, scalars: np.ndarray, *directions: np.ndarray) -> np.ndarray:
        """A lift's states at the end, before the transition."""
        field = self._field(lift)
        c = field.constants(self.values(scalars, *directions))
        return flow.along(field, c, self.steps, y, self.method)[-1]

    def end(self, lift: str, y: np.ndarray, scalars: np.ndarray, *directions: np.ndarray) -> np.ndarray:
        """State after the transition and guard, of a lift order by order."""
        before = self.before(lift, y, scalars, *directions)
        if not self.mapped:
            return before
        map_ = self.passage.end(lift)
        return map_(1.0, before, map_.constants(self.values(scalars, *directions)))

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
        """States at times in 0..1, from those at the steps."""
        field = self.passage.field(PLAIN)
        c = field.constants(self.values(scalars))
        return flow.dense(field, c, self.steps, nodes, times, self.method)

    def velocity(self, x: np.ndarray, scalars: np.ndarray) -> np.ndarray:
        """dx/dt at the start, in the leg's own time."""
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
    last: Piece, mesh: Mesh, starts: np.ndarray, scalars: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As `Piece.passed`, of all segments of one leg in its own time at once; `last` is its last one.

    Returns
    -------
    nodes : ndarray, shape (s, n)
        States at `Mesh.times`.
    ends : ndarray, shape (m, n)
    moved : ndarray, shape (m, n, n + k)
    """
    field, values, n = last.passage.field(PLAIN), last.values(scalars), starts.shape[1]
    columns, sources = _beginnings(n, n, len(scalars))
    c = field.constants(values)
    nodes, moved = flow.along_with_tangents(field, c, mesh.times, starts, columns, sources, mesh.method)
    ends = nodes[mesh.ends]
    ends[-1], moved[-1] = last.through(PLAIN, ends[-1], moved[-1], values)
    return nodes, ends, moved


def velocity(passage: Passage, x: np.ndarray, time: float, values: np.ndarray) -> np.ndarray:
    """dx/dt at a time in 0..1, in units of the leg's duration, shape (n,)."""
    field = passage.field(PLAIN)
    return field(time, x, field.constants(values))


@dataclass(frozen=True, eq=False)
class Run:
    """A part of a motion that steps are made for.

    Parameters
    ----------
    passage : Passage
    x, scalars : ndarray
        Its start, and the scalars of the leg.
    carried : int
        Tangents that are to be computed on its steps.
    begin, end : float
        Times of the leg, 0..1.
    """

    passage: Passage
    x: np.ndarray
    scalars: np.ndarray
    carried: int
    begin: float = 0.0
    end: float = 1.0


def stepped(
    runs: Sequence[Run],
    fixed: np.ndarray,
    variation: np.ndarray,
    tolerance: float,
    method: str,
    most: int = MOST_STEPS,
    far_out: bool = False,
) -> tuple[list[flow.Path], str, str]:
    """The path of every run with a generic neighbour, the integrator, and why this one.

    The neighbour makes sure that derivatives are right too: where the motion stands still, itself would
    allow steps of any length.
    """
    given, values = [], [np.concatenate([run.scalars, fixed]) for run in runs]
    for run, own in zip(runs, values, strict=True):
        field, sizes = run.passage.field(TANGENT), variation[list(run.passage.states)]
        generic = np.concatenate([run.x, sizes * np.cos(np.arange(1.0, len(sizes) + 1.0))])
        c = field.constants(np.concatenate([own, np.zeros(len(run.scalars))]))
        control = flow.ErrorControl(tolerance, np.concatenate([sizes, sizes]), most, far_out)
        given.append((field, c, run.begin, generic, run.end, control))
    if method == "auto":
        choices = []
        for run, own, there in zip(runs, values, given, strict=True):
            carried = Carried(run.passage.field(PLAIN), run.carried)
            choices.append(choose(*there, carried))
            # Where one ends on the way, the others need not be tried.
            arrived(choices[-1].path, run.passage, own)
        stiffest = max(choices, key=lambda choice: choice.stability_limited)
        method, reason = stiffest.method, stiffest.reason
        if len({choice.method for choice in choices}) == 1:
            return [choice.path for choice in choices], method, reason
    else:
        reason = "as the run file says"
    paths = [
        arrived(flow.controlled(*there, method), run.passage, own)
        for run, own, there in zip(runs, values, given, strict=True)
    ]
    return paths, method, reason


def arrived(path: flow.Path, passage: Passage | None = None, values: np.ndarray | None = None) -> flow.Path:
    """A path that reached its end; `passage` and `values` tell more of one that did not.

    Raises
    ------
    NotFinite
        With what became of the motion.
    """
    if path.status == "ok":
        return path
    status, rough = path.status, ""
    if passage is not None and values is not None:
        _refuse_steep_event(path, passage, values)
        rough = roughness(passage, values, path)
    if status == "step_too_small" and np.abs(path.states[-1]).max() > BURST * np.abs(path.states[0]).max():
        status = "not_finite"
    raise NotFinite(_SENTENCES[status] + rough, "Start elsewhere, or keep the run away from there.")


def _refuse_steep_event(path: flow.Path, passage: Passage, values: np.ndarray) -> None:
    """Raise for a motion that ends right after its event, for which its instant is too steep."""
    transition, n = passage.leg.transition, len(passage.states)
    if path.status == "too_many_steps" or transition is None or path.times[-1] < AT_ITS_END:
        return
    watched, state = passage.watched(transition.name, transition.guard), np.nan_to_num(path.states[-1:, :n])
    after = float(watched.along(path.times[-1:], state, values, np.zeros((1, n)))[0, 0])
    if (after < 0.0) != (transition.direction == "falling"):
        return
    raise NotFinite(
        # By how little is not said: steps end before the pole, and guesses of the duration beyond it.
        f"The motion ceases to exist right after '{transition.name}', as a spike does that runs to a pole: "
        "so near to it the event's instant is not known well enough. "
        "Let the guard act earlier on the way up, and the reset stand for the rest of it.",
        "Start elsewhere, or mend the plugin.",
    )


def roughness(passage: Passage, values: np.ndarray, path: flow.Path) -> str:
    """A sentence where a path of a lift ends at a place at which the field is smooth by pieces only."""
    course = passage.course(values, path.times, path.states[:, : len(passage.states)])
    return "" if course is None or path.status == "not_finite" else at_the_end(course)


def growth_of(deviations: np.ndarray) -> float:
    """How much a deviation grows at most from any time on."""
    sizes = np.linalg.norm(deviations, axis=1)
    return float(np.max(sizes / np.minimum.accumulate(np.maximum(sizes, 1e-300))))


_SENTENCES = {
    "not_finite": "The motion is not finite within one period: it ends, or grows without bound.",
    "too_many_steps": "One period of the motion takes more steps than are allowed.",
    "step_too_small": "The integrator's step becomes too small within one period: the field is not "
    "smooth there.",
}


def meshed(
    passage: Passage,
    starts: np.ndarray,
    values: np.ndarray,
    magnitudes: np.ndarray,
    tolerance: float,
    method: str,
    parts: int = 1,
) -> Mesh:
    """Steps on which a motion, and a generic neighbour of it, are integrated to a tolerance.

    Parameters
    ----------
    starts : ndarray, shape (m, n)
        State at the beginning of each segment.
    values : ndarray
        Scalars and fixed parameters.
    magnitudes : ndarray, shape (n,)
        Typical magnitudes of the states. Where a state varies less along the orbit, its variation counts.
    parts : int
        The steps are made alike in so many parts of the closure.

    Raises
    ------
    NotFinite
        If the motion ends before the closure does.
    """
    k, fixed = len(passage.columns), values[len(passage.columns) :]
    n, m, given = len(magnitudes), len(starts), (tolerance, method)
    runs = [Run(passage, x, values[:k], n + k, i / m, (i + 1) / m) for i, x in enumerate(starts)]
    variation = magnitudes
    paths, chosen, reason = stepped(runs, fixed, variation, *given)
    smaller = _variation(passage, values, paths, variation, tolerance)
    if np.any(smaller < 0.2 * variation):
        finer = stepped(runs, fixed, smaller, *given)
        # A motion that shrinks on finer steps was their error: the orbit is a point.
        if np.any(_variation(passage, values, finer[0], magnitudes, tolerance) >= SHRINKS * smaller):
            variation = smaller
            paths, chosen, reason = finer
    growth = max(growth_of(path.states[:, len(variation) :] / variation) for path in paths)
    steps = tuple(path.steady for path in paths)
    if parts > 1:
        steps = repeating(steps, parts)
    return Mesh(steps, chosen, tolerance, variation, magnitudes, growth, reason)


def _variation(
    passage: Passage, values: np.ndarray, paths: Sequence[flow.Path], magnitudes: np.ndarray, tolerance: float
) -> np.ndarray:
    """Half the range of each state, not above its magnitude; the magnitudes themselves of an orbit that is
    a point.

    A state that moves far less than the others is taken as moving a thousandth of what they do, and one
    that does not move as moving as they do: what it seems to move is the error of the steps.
    """
    n = len(magnitudes)
    shares = 0.5 * np.ptp(np.concatenate([path.states for path in paths])[:, :n], axis=0) / magnitudes
    largest = float(shares.max())
    if largest < tolerance and (largest * tolerance < ROUNDED or _still(passage, values, paths, magnitudes)):
        return magnitudes
    shares = np.where(shares < CONSTANT * largest, largest, shares)
    return magnitudes * np.clip(shares, LEAST_SHARE * largest, 1.0)


def _still(passage: Passage, values: np.ndarray, paths: Sequence[flow.Path], magnitudes: np.ndarray) -> bool:
    """Whether the field vanishes all along, to rounding."""
    n, field = len(magnitudes), passage.field(PLAIN)
    c = field.constants(values)
    for path in paths:
        for k in range(0, len(path.times), max(len(path.times) // 8, 1)):
            if np.abs(field(path.times[k], path.states[k, :n], c) / magnitudes).max() > STILL:
                return False
    return True

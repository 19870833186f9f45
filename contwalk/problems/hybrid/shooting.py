"""What becomes of a start state over each leg, up to and through its transition, derivatives included.

Everything is integrated on the steps of a mesh, which stays as it is during a solve: the equations that
Newton's method sees are smooth, and their derivatives are those of the integrator's own steps. Events are
not located here: a leg lasts as long as its unknown duration says, and that its guard is zero then is an
equation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from contwalk import flow
from contwalk.errors import NotFinite
from contwalk.flow.method import Carried, choose
from contwalk.problems.hybrid.passage import Passage
from contwalk.problems.orbit.discretization import TIGHTEST
from contwalk.problems.orbit.motion import MIXED, PLAIN, TANGENT
from contwalk.problems.orbit.repeating import repeating
from contwalk.problems.orbit.shooting import CONSTANT, LEAST_SHARE, Mesh, arrived, growth_of

# An orbit that moves less than this part of typical magnitudes is at rest: solutions are known to 1e-10.
AT_REST = 1e-9
# A motion that ends beyond this part of a leg may have passed the leg's own event.
AT_ITS_END = 1.0 - 1e-6
# Local errors may grow by so much over a leg before its steps are made finer.
SAFE = 30.0
# Steps of a leg at most: of any, and against those of the orbit that it is a neighbour of.
MOST_STEPS, LEAST_MOST, MANY_TIMES = 100_000, 2_000, 50


@dataclass(frozen=True, eq=False)
class LegMesh(Mesh):
    """Steps of each segment of each leg, in its own time from 0 to 1.

    `growth` is what local errors grow by at most over a segment, in units of the tolerance.
    `grown` is how much a deviation grows at most over each segment, from any time on.
    `total` is the duration of the closure, `guards` the largest value of each leg's own guard on it, shape
    (m,): the units of durations and of guards.
    """

    grown: tuple[float, ...] = ()
    total: float = 1.0
    guards: np.ndarray | None = None


@dataclass(frozen=True, eq=False)
class Piece:
    """A leg, or a segment of one, on its steps.

    Parameters
    ----------
    passage : Passage
    steps : ndarray
        Times in 0..1 of its steps, ends included.
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

    def _field(self, lift: str) -> flow.CompiledField:
        return self.passage.field(lift, implicit=flow.implicit(self.method))

    def before(self, lift: str, y: np.ndarray, scalars: np.ndarray, *directions: np.ndarray) -> np.ndarray:
        """A lift's states at the end, before the transition."""
        field = self._field(lift)
        c = field.constants(self.values(scalars, *directions))
        return flow.along(field, c, self.steps, y, self.method)[-1]

    def end(self, lift: str, y: np.ndarray, scalars: np.ndarray, *directions: np.ndarray) -> np.ndarray:
        """State after the transition and guard, of a lift order by order."""
        if self.inner:
            return self.before(lift, y, scalars, *directions)
        map_ = self.passage.end(lift)
        c = map_.constants(self.values(scalars, *directions))
        return map_(1.0, self.before(lift, y, scalars, *directions), c)

    def differentiated(
        self, lift: str, y: np.ndarray, scalars: np.ndarray, *directions: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """As `end`, with the derivatives by the state (its first n components) and the columns, (.,
        n + k).
        """
        x, moved = self.before_differentiated(lift, y, scalars, *directions)
        if self.inner:
            return x, moved
        map_ = self.passage.end(lift)
        return self.through(map_, x, moved, self.values(scalars, *directions))

    def passed(self, x: np.ndarray, scalars: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The nodes, and `end` with its derivatives as `differentiated` has it, from one pass."""
        field, n, k = self._field(PLAIN), len(self.passage.states), len(self.passage.columns)
        columns, sources = _beginnings(n, n, k)
        values = self.values(scalars)
        c = field.constants(values)
        nodes, moved = flow.along_with_tangents(field, c, self.steps, x[None], columns, sources, self.method)
        if self.inner:
            return nodes, nodes[-1], moved[0]
        return nodes, *self.through(self.passage.end(PLAIN), nodes[-1], moved[0], values)

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
        if self.inner:
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
        self, map_: flow.Field, x: np.ndarray, moved: np.ndarray, values: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """A map of the leg's end with its derivatives by the start and the columns."""
        c, k = map_.constants(values), len(self.passage.columns)
        value, derivative = map_.linearized(1.0, x, c)
        with np.errstate(over="ignore", invalid="ignore"):  # whoever asks looks whether it is finite
            total = derivative[:, : len(x)] @ moved
            total[:, -k:] += derivative[:, len(x) :]
        return value, total

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


def meshed(
    passages: Sequence[Passage],
    starts: Sequence[np.ndarray],
    scalars: Sequence[np.ndarray],
    fixed: np.ndarray,
    magnitudes: np.ndarray,
    tolerance: float,
    method: str,
    alike: bool,
    most: int = MOST_STEPS,
    parts: int = 1,
) -> LegMesh:
    """Steps on which each segment, and a generic neighbour of it, are integrated to a tolerance.

    Parameters
    ----------
    passages, starts, scalars : sequences
        One for each segment.
    magnitudes : ndarray, shape (n,)
        Typical magnitudes of all states. Where one varies less along the orbit, its variation counts.
    alike : bool
        The second half of the legs repeats the first, or its image: steps are made the same in both.
    most : int
        Steps that a leg may take.
    parts : int
        Of a closure that is one leg: its steps are made alike in so many parts.

    Raises
    ------
    NotFinite
        If the motion ends before a leg does, or takes too many steps.
    """
    variation = magnitudes
    paths, chosen, reason = _passed(passages, starts, scalars, fixed, variation, tolerance, method, most)
    smaller = _variation(passages, paths, magnitudes)
    if np.any(smaller < 0.2 * variation):
        variation = smaller
        paths, chosen, reason = _passed(passages, starts, scalars, fixed, variation, tolerance, method, most)
    # Over a leg that passes a saddle, an error grows with whatever else does: its steps have to be finer.
    growth, finer = _growth(passages, paths, variation), tolerance
    while growth * finer > SAFE * tolerance and finer > TIGHTEST:
        finer = max(0.5 * tolerance * SAFE / growth, TIGHTEST)
        paths, chosen, reason = _passed(passages, starts, scalars, fixed, variation, finer, method, most)
        growth = _growth(passages, paths, variation)
    amplified = max(growth * finer / tolerance, 1.0)
    steps = [path.steady for path in paths]
    if alike:
        half = len(steps) // 2
        for i in range(half):
            longer = max(steps[i], steps[i + half], key=len)
            steps[i] = steps[i + half] = longer
    if parts > 1:
        steps = _alike(steps, parts)
    grown = tuple(_growth([p], [path], variation) for p, path in zip(passages, paths, strict=True))
    return LegMesh(tuple(steps), chosen, tolerance, variation, magnitudes, amplified, reason, grown)


def _alike(steps: Sequence[np.ndarray], parts: int) -> list[np.ndarray]:
    """Steps of a closure's segments, each in its own time, made alike in so many parts of it."""
    m = len(steps)
    whole = repeating([(i + own) / m for i, own in enumerate(steps)], parts)
    return [np.concatenate([[0.0], m * own[1:-1] - i, [1.0]]) for i, own in enumerate(whole)]


def _growth(passages: Sequence[Passage], paths: Sequence[flow.Path], variation: np.ndarray) -> float:
    """How much a deviation grows at most over a leg, from any time on."""
    return max(
        growth_of(path.states[:, len(p.states) :] / variation[list(p.states)])
        for p, path in zip(passages, paths, strict=True)
    )


def _variation(passages: Sequence[Passage], paths: Sequence[flow.Path], magnitudes: np.ndarray) -> np.ndarray:
    """Half the range of each state over the orbit, not above its magnitude, nor a thousandth of what others
    do.
    """
    states = np.concatenate(
        [p.full(path.states[:, : len(p.states)]) for p, path in zip(passages, paths, strict=True)]
    )
    shares = 0.5 * np.ptp(states, axis=0) / magnitudes
    largest = float(shares.max())
    if largest <= AT_REST:
        return magnitudes
    shares = np.where(shares < CONSTANT * largest, largest, shares)
    return magnitudes * np.clip(shares, LEAST_SHARE * largest, 1.0)


def _passed(
    passages: Sequence[Passage],
    starts: Sequence[np.ndarray],
    scalars: Sequence[np.ndarray],
    fixed: np.ndarray,
    variation: np.ndarray,
    tolerance: float,
    method: str,
    most: int,
) -> tuple[list[flow.Path], str, str]:
    """The path of every leg with a generic neighbour, the integrator, and why this one."""
    runs, values = [], []
    for passage, x, own in zip(passages, starts, scalars, strict=True):
        field, k = passage.field(TANGENT), len(passage.columns)
        c = field.constants(np.concatenate([own, fixed, np.zeros(k)]))
        values.append(np.concatenate([own, fixed]))
        sizes = variation[list(passage.states)]
        generic = sizes * np.cos(np.arange(1.0, len(sizes) + 1.0))
        runs.append((passage, field, c, np.concatenate([x, generic]), np.concatenate([sizes, sizes])))
    if method == "auto":
        choices = []
        for (p, field, c, y, weights), own in zip(runs, values, strict=True):
            carried = Carried(p.field(PLAIN), len(y))
            choices.append(choose(field, c, 0.0, y, 1.0, tolerance, weights, most, carried, far_out=True))
            _arrived(p, own, choices[-1].path)  # where one leg does not, the others are not asked
        stiffest = max(choices, key=lambda choice: choice.stability_limited)
        method, reason = stiffest.method, stiffest.reason
        if len({choice.method for choice in choices}) == 1:
            return [choice.path for choice in choices], method, reason
    else:
        reason = "as the run file says"
    paths = [
        _arrived(p, own, flow.adaptive(field, c, 0.0, y, 1.0, tolerance, weights, method, most, far_out=True))
        for (p, field, c, y, weights), own in zip(runs, values, strict=True)
    ]
    return paths, method, reason


def _arrived(passage: Passage, values: np.ndarray, path: flow.Path) -> flow.Path:
    """As `arrived`; a motion that ends right after its event, for which its instant is too steep, is told."""
    transition = passage.leg.transition
    if path.status in ("ok", "too_many_steps") or transition is None or path.times[-1] < AT_ITS_END:
        return arrived(path)
    n = len(passage.states)
    state = np.nan_to_num(path.states[-1:, :n])
    after = float(
        passage.watched(transition.name, transition.guard).along(
            path.times[-1:], state, values, np.zeros((1, n))
        )[0, 0]
    )
    if (after < 0.0) != (transition.direction == "falling"):
        return arrived(path)
    raise NotFinite(
        f"The motion ceases to exist {1.0 - path.times[-1]:.0e} of its duration after '{transition.name}', "
        "as a spike does that runs to a pole: so near to it the event's instant is not known well enough. "
        "Let the guard act earlier on the way up, and the reset stand for the rest of it.",
        "Start elsewhere, or mend the plugin.",
    )


def most_steps(mesh: LegMesh | None, tolerance: float) -> int:
    """Steps that a leg of a neighbouring orbit may take: many times those of an orbit that is known.

    Newton's method may ask for motions that no machine has: each of their legs would take all the steps that
    there are.
    """
    if mesh is None:
        return MOST_STEPS
    longest = max(len(steps) for steps in mesh.steps)
    finer = max(mesh.tolerance / tolerance, 1.0) ** (1.0 / 8.0)  # at the order of the explicit pair
    return min(max(LEAST_MOST, int(MANY_TIMES * finer * longest)), MOST_STEPS)

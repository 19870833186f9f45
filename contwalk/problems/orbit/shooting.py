"""Multiple shooting: what becomes of a start state over each segment of the closure, derivatives included.

Everything is integrated on the steps of a `Mesh`, which stays as it is during a solve: the equations that
Newton's method sees are smooth, and their derivatives are those of the integrator's own steps.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contwalk import flow
from contwalk.errors import NotFinite
from contwalk.flow.method import Carried, choose
from contwalk.problems.kinks import at_the_end
from contwalk.problems.orbit.closure import Closure
from contwalk.problems.orbit.motion import PLAIN, TANGENT, Motion
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
class Shooting:
    """One closure of a motion, cut into segments of equal duration.

    `fixed` holds the parameters' values: at the beginning of the path (or all of them), then their changes
    along it.
    """

    motion: Motion
    closure: Closure
    mesh: Mesh
    fixed: np.ndarray

    def values(self, scalars: np.ndarray, directions: tuple[np.ndarray, ...]) -> np.ndarray:
        """What a lift's field depends on, in its order."""
        return np.concatenate([scalars, self.fixed, *directions])

    def carried(
        self, lift: str, segment: int, y: np.ndarray, scalars: np.ndarray, *directions: np.ndarray
    ) -> np.ndarray:
        """A lift's states at the end of a segment, the closure applied to the last one."""
        values = self.values(scalars, directions)
        field = self.motion.field(lift, implicit=flow.implicit(self.mesh.method))
        steps, method = self.mesh.steps[segment], self.mesh.method
        end = flow.along(field, field.constants(values), steps, y, method)[-1]
        return self.closure.end(lift, end, values) if segment == self.mesh.segments - 1 else end

    def passed(
        self, starts: np.ndarray, columns: np.ndarray, sources: np.ndarray, scalars: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """All segments at once, with their derivatives `columns`, each driven by the scalar in `sources`.

        Returns
        -------
        nodes : ndarray, shape (s, n)
            States at `Mesh.times`.
        ends : ndarray, shape (m, n)
            The closure is applied to the last one.
        moved : ndarray, shape (m, n, q)
        """
        field, values, mesh = self.motion.field(PLAIN), self.values(scalars, ()), self.mesh
        c = field.constants(values)
        nodes, moved = flow.along_with_tangents(field, c, mesh.times, starts, columns, sources, mesh.method)
        ends = nodes[mesh.ends]
        last = self.closure.end_with_columns(PLAIN, ends[-1], moved[-1], sources, values)
        ends[-1], moved[-1] = last
        return nodes, ends, moved

    def differentiated(
        self,
        lift: str,
        segment: int,
        y: np.ndarray,
        columns: np.ndarray,
        sources: np.ndarray,
        scalars: np.ndarray,
        *directions: np.ndarray,
    ) -> tuple[np.ndarray, np.ndarray]:
        """As `carried`, with the derivatives `columns`, each driven by the scalar in `sources` (-1: none)."""
        values = self.values(scalars, directions)
        field = self.motion.field(lift, implicit=flow.implicit(self.mesh.method))
        steps, method = self.mesh.steps[segment], self.mesh.method
        end, moved = flow.tangents(field, field.constants(values), steps, y, columns, sources, method)
        if segment < self.mesh.segments - 1:
            return end, moved
        return self.closure.end_with_columns(lift, end, moved, sources, values)

    def nodes(
        self, segment: int, x: np.ndarray, columns: np.ndarray, sources: np.ndarray, scalars: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """States at all steps of a segment, shape (s + 1, n), and their derivatives, shape (s + 1, n, q)."""
        field = self.motion.field(PLAIN)
        c = field.constants(self.values(scalars, ()))
        steps, method = self.mesh.steps[segment], self.mesh.method
        return flow.tangents(field, c, steps, x, columns, sources, method, every=True)

    def states(self, starts: np.ndarray, scalars: np.ndarray) -> np.ndarray:
        """States at `Mesh.times`, shape (s, n)."""
        field, mesh = self.motion.field(PLAIN), self.mesh
        c = field.constants(self.values(scalars, ()))
        return np.concatenate(
            [flow.along(field, c, steps, x, mesh.method) for steps, x in zip(mesh.steps, starts, strict=True)]
        )

    def curve(self, nodes: np.ndarray, scalars: np.ndarray) -> Curve:
        """The motion through the states at `Mesh.times`, to be looked at anywhere."""
        field, mesh = self.motion.field(PLAIN), self.mesh
        c = field.constants(self.values(scalars, ()))
        at = flow.interpolation(field, c, mesh.times, nodes, mesh.method)
        return Curve(mesh.times, nodes, at, lambda t, x: field.along(t, x, c))

    def velocities(self, starts: np.ndarray, scalars: np.ndarray) -> np.ndarray:
        """dx/dt at the segments' starts in units of the closure's duration, shape (m, n); NaN in a row of
        which one entry does not exist.
        """
        field, m = self.motion.field(PLAIN), self.mesh.segments
        found = field.along(np.arange(m) / m, starts, field.constants(self.values(scalars, ())))
        found[~np.isfinite(found).all(axis=1)] = np.nan
        return found


@dataclass(frozen=True, eq=False)
class Curve:
    """An integrated motion over a closure, in times 0..1.

    Parameters
    ----------
    times : ndarray, shape (s,)
        As `Mesh.times`.
    nodes : ndarray, shape (s, n)
        The states there.
    at : callable
        States (k, n) at times (k,) in growing order, exact as the integrator's own interpolation is. Where
        two segments meet, that of the later one.
    rates : callable
        Rates at times (k,) and states (k, n) there.
    """

    times: np.ndarray
    nodes: np.ndarray
    at: Callable[[np.ndarray], np.ndarray]
    rates: Callable[[np.ndarray, np.ndarray], np.ndarray]

    def sampled(self, number: int) -> tuple[np.ndarray, np.ndarray]:
        """Times and states, shape (k, n), at least `number` of them evenly spread, and the steps' own."""
        even = np.linspace(0.0, 1.0, number + 1)
        return self._with(even[even != self.times[np.searchsorted(self.times, even)]])

    def divided(self, parts: int) -> tuple[np.ndarray, np.ndarray]:
        """Times and states, shape (k, n): the steps' own, and instants that part each step evenly."""
        lengths = np.diff(self.times)
        inner = self.times[:-1, None] + lengths[:, None] * (np.arange(1, parts) / parts)
        return self._with(inner[lengths > 0.0].ravel())

    def _with(self, inner: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The steps' own times and states, and those at further times, in growing order."""
        places = np.searchsorted(self.times, inner)
        return np.insert(self.times, places, inner), np.insert(self.nodes, places, self.at(inner), axis=0)


def velocity(motion: Motion, x: np.ndarray, time: float, values: np.ndarray) -> np.ndarray:
    """dx/dt in units of the closure's duration, shape (n,)."""
    field = motion.field(PLAIN)
    return field(time, x, field.constants(values))


def meshed(
    motion: Motion,
    starts: np.ndarray,
    values: np.ndarray,
    magnitudes: np.ndarray,
    tolerance: float,
    method: str,
    parts: int = 1,
) -> Mesh:
    """Steps on which a motion, and a generic neighbour of it, are integrated to a tolerance.

    The neighbour makes sure that derivatives are right too: where the motion stands still, itself would
    allow steps of any length.

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
    variation = magnitudes
    paths, chosen, reason = _passed(motion, starts, values, variation, tolerance, method)
    smaller = _variation(motion, values, paths, variation, tolerance)
    if np.any(smaller < 0.2 * variation):
        finer = _passed(motion, starts, values, smaller, tolerance, method)
        # A motion that shrinks on finer steps was their error: the orbit is a point.
        if np.any(_variation(motion, values, finer[0], magnitudes, tolerance) >= SHRINKS * smaller):
            variation = smaller
            paths, chosen, reason = finer
    growth = max(growth_of(path.states[:, len(variation) :] / variation) for path in paths)
    steps = tuple(path.steady for path in paths)
    if parts > 1:
        steps = repeating(steps, parts)
    return Mesh(steps, chosen, tolerance, variation, magnitudes, growth, reason)


def _variation(
    motion: Motion, values: np.ndarray, paths: Sequence[flow.Path], magnitudes: np.ndarray, tolerance: float
) -> np.ndarray:
    """Half the range of each state, not above its magnitude; the magnitudes themselves of an orbit that is
    a point.

    A state that moves far less than the others is taken as moving a thousandth of what they do, and one
    that does not move as moving as they do: what it seems to move is the error of the steps.
    """
    n = len(magnitudes)
    shares = 0.5 * np.ptp(np.concatenate([path.states for path in paths])[:, :n], axis=0) / magnitudes
    largest = float(shares.max())
    if largest < tolerance and (largest * tolerance < ROUNDED or _still(motion, values, paths, magnitudes)):
        return magnitudes
    shares = np.where(shares < CONSTANT * largest, largest, shares)
    return magnitudes * np.clip(shares, LEAST_SHARE * largest, 1.0)


def _still(motion: Motion, values: np.ndarray, paths: Sequence[flow.Path], magnitudes: np.ndarray) -> bool:
    """Whether the field vanishes all along, to rounding."""
    n, field = len(magnitudes), motion.field(PLAIN)
    c = field.constants(values)
    for path in paths:
        for k in range(0, len(path.times), max(len(path.times) // 8, 1)):
            if np.abs(field(path.times[k], path.states[k, :n], c) / magnitudes).max() > STILL:
                return False
    return True


def growth_of(deviations: np.ndarray) -> float:
    """How much a deviation grows at most from any time on."""
    sizes = np.linalg.norm(deviations, axis=1)
    return float(np.max(sizes / np.minimum.accumulate(np.maximum(sizes, 1e-300))))


def _passed(
    motion: Motion,
    starts: np.ndarray,
    values: np.ndarray,
    variation: np.ndarray,
    tolerance: float,
    method: str,
) -> tuple[list[flow.Path], str, str]:
    """The path of every segment with a generic neighbour, the integrator, and why this one."""
    field = motion.field(TANGENT)
    c = field.constants(np.concatenate([values, np.zeros(len(motion.columns))]))
    n, m = motion.states, len(starts)
    generic = variation * np.cos(np.arange(1.0, n + 1.0))
    weights = np.concatenate([variation, variation])
    ends = [(i / m, np.concatenate([x, generic]), (i + 1) / m) for i, x in enumerate(starts)]
    if method == "auto":
        carried = Carried(motion.field(PLAIN), n + len(motion.columns))
        choices = []
        for end in ends:
            choices.append(choose(field, c, *end, tolerance, weights, carried=carried))
            arrived(
                choices[-1].path, motion, values
            )  # where one ends on the way, the others need not be tried
        methods = {choice.method for choice in choices}
        stiffest = max(choices, key=lambda choice: choice.stability_limited)
        method, reason = stiffest.method, stiffest.reason
        if len(methods) == 1:
            return [arrived(choice.path) for choice in choices], method, reason
    else:
        reason = "as the run file says"
    paths = [flow.adaptive(field, c, *end, tolerance, weights, method) for end in ends]
    return [arrived(path, motion, values) for path in paths], method, reason


def arrived(path: flow.Path, motion: Motion | None = None, values: np.ndarray | None = None) -> flow.Path:
    """A path that reached its end; `motion` and `values` tell more of one that did not.

    Raises
    ------
    NotFinite
        With what became of the motion.
    """
    if path.status != "ok":
        status = path.status
        if (
            status == "step_too_small"
            and np.abs(path.states[-1]).max() > BURST * np.abs(path.states[0]).max()
        ):
            status = "not_finite"
        rough = "" if motion is None or values is None else roughness(motion, values, path)
        raise NotFinite(_SENTENCES[status] + rough, "Start elsewhere, or keep the run away from there.")
    return path


def roughness(motion: Motion, values: np.ndarray, path: flow.Path) -> str:
    """A sentence where a path of a lift ends at a place at which the field is smooth by pieces only."""
    course = motion.course(values, path.times, path.states[:, : motion.states])
    return "" if course is None or path.status == "not_finite" else at_the_end(course)


_SENTENCES = {
    "not_finite": "The motion is not finite within one period: it ends, or grows without bound.",
    "too_many_steps": "One period of the motion takes more steps than are allowed.",
    "step_too_small": "The integrator's step becomes too small within one period: the field is not "
    "smooth there.",
}

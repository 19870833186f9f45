"""Multiple shooting: what becomes of a start state over each segment of the closure, derivatives included.

Everything is integrated on the steps of a `Mesh`, which stays as it is during a solve: the equations that
Newton's method sees are smooth, and their derivatives are those of the integrator's own steps.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from contwalk import flow
from contwalk.errors import NotFinite
from contwalk.flow.method import Carried, choose
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
        field = self.motion.field(lift, implicit=self.mesh.method.startswith("radau"))
        steps, method = self.mesh.steps[segment], self.mesh.method
        end = flow.along(field, field.constants(values), steps, y, method)[-1]
        return self.closure.end(lift, end, values) if segment == self.mesh.segments - 1 else end

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
        field = self.motion.field(lift, implicit=self.mesh.method.startswith("radau"))
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

    def states(self, starts: np.ndarray, scalars: np.ndarray) -> list[np.ndarray]:
        """States at the steps of each segment, shape (s + 1, n)."""
        field = self.motion.field(PLAIN)
        c = field.constants(self.values(scalars, ()))
        return [
            flow.along(field, c, steps, x, self.mesh.method)
            for steps, x in zip(self.mesh.steps, starts, strict=True)
        ]

    def curve(self, starts: np.ndarray, scalars: np.ndarray) -> Curve:
        """The motion, integrated once to be looked at anywhere."""
        field = self.motion.field(PLAIN)
        c = field.constants(self.values(scalars, ()))
        nodes, method = self.states(starts, scalars), self.mesh.method
        pieces = [
            flow.interpolation(field, c, steps, x, method)
            for steps, x in zip(self.mesh.steps, nodes, strict=True)
        ]
        return Curve(self.mesh.steps, tuple(pieces), lambda t, x: field.along(t, x, c))


@dataclass(frozen=True, eq=False)
class Curve:
    """An integrated motion over a closure, in times 0..1.

    Parameters
    ----------
    steps : tuple of ndarray
        Times of each segment's steps.
    pieces : tuple of callable
        States (k, n) at times (k,) of each segment, exact as the integrator's own interpolation is.
    rates : callable
        Rates at times (k,) and states (k, n) there.
    """

    steps: tuple[np.ndarray, ...]
    pieces: tuple[Callable[[np.ndarray], np.ndarray], ...]
    rates: Callable[[np.ndarray, np.ndarray], np.ndarray]

    def at(self, times: np.ndarray) -> np.ndarray:
        """States at times in growing order, shape (k, n)."""
        found = []
        for i, (steps, piece) in enumerate(zip(self.steps, self.pieces, strict=True)):
            last = i == len(self.steps) - 1
            inside = (times >= steps[0]) & ((times < steps[-1]) | (last & (times == steps[-1])))
            found.append(piece(times[inside]))
        return np.concatenate(found)

    def sampled(self, number: int) -> tuple[np.ndarray, np.ndarray]:
        """Times and states, shape (k, n), at least `number` of them evenly spread, and the steps' own."""
        times, states = [], []
        even = np.linspace(0.0, 1.0, number + 1)
        for steps, piece in zip(self.steps, self.pieces, strict=True):
            inside = even[(even > steps[0]) & (even < steps[-1])]
            wanted = np.unique(np.concatenate([steps, inside]))
            times.append(wanted)
            states.append(piece(wanted))
        return np.concatenate(times), np.concatenate(states)


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
            arrived(choices[-1].path)  # where one ends on the way, the others need not be tried
        methods = {choice.method for choice in choices}
        stiffest = max(choices, key=lambda choice: choice.stability_limited)
        method, reason = stiffest.method, stiffest.reason
        if len(methods) == 1:
            return [arrived(choice.path) for choice in choices], method, reason
    else:
        reason = "as the run file says"
    paths = [flow.adaptive(field, c, *end, tolerance, weights, method) for end in ends]
    return [arrived(path) for path in paths], method, reason


def arrived(path: flow.Path) -> flow.Path:
    """A path that reached its end.

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
        raise NotFinite(_SENTENCES[status], "Start elsewhere, or keep the run away from there.")
    return path


_SENTENCES = {
    "not_finite": "The motion is not finite within one period: it ends, or grows without bound.",
    "too_many_steps": "One period of the motion takes more steps than are allowed.",
    "step_too_small": "The integrator's step becomes too small within one period: the field is not "
    "smooth there.",
}

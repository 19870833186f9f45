"""Steps for the legs of an orbit through events.

Events are not located here: a leg lasts as long as its unknown duration says, and that its guard is zero then
is an equation.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contwalk import flow
from contwalk.data_class import dataclass
from contwalk.problems.orbit.discretization import TIGHTEST
from contwalk.problems.orbit.passage import Passage
from contwalk.problems.orbit.repeating import repeating
from contwalk.problems.orbit.shooting import (
    CONSTANT,
    LEAST_SHARE,
    MOST_STEPS,
    Mesh,
    Run,
    growth_of,
    stepped,
)

# An orbit that moves less than this part of typical magnitudes is at rest: solutions are known to 1e-10.
AT_REST = 1e-9
# Local errors may grow by so much over a leg before its steps are made finer.
SAFE = 30.0
# Steps of a leg at most, against those of the orbit that it is a neighbour of.
LEAST_MOST, MANY_TIMES = 2_000, 50


@dataclass(frozen=True, eq=False)
class LegMesh(Mesh):
    """Steps of each segment of each leg, in its own time from 0 to 1.

    `growth` is what local errors grow by at most over a segment, in units of the tolerance.
    `grown` is how much a deviation grows at most over each segment, from any time on.
    `total` is the duration of the closure, `guards` the largest value of each leg's own guard on it, shape
    (m,): the units of durations and of guards.
    """

    grown: tuple[float, ...] = ()
    guards: np.ndarray | None = None

    @property
    def amplified(self) -> float:
        """What local errors grow by on their way to the end of a segment."""
        return self.growth


def meshed(
    passages: Sequence[Passage],
    starts: Sequence[np.ndarray],
    scalars: Sequence[np.ndarray],
    fixed: np.ndarray,
    control: flow.ErrorControl,
    method: str,
    alike: bool,
    parts: int = 1,
) -> LegMesh:
    """Steps on which each segment, and a generic neighbour of it, are integrated to a tolerance.

    Parameters
    ----------
    passages, starts, scalars : sequences
        One for each segment.
    control : ErrorControl
        How finely; the steps that a leg may take. Weights are typical magnitudes of all states, shape (n,):
        where one varies less along the orbit, its variation counts.
    alike : bool
        The second half of the legs repeats the first, or its image: steps are made the same in both.
    parts : int
        Of a closure that is one leg: its steps are made alike in so many parts.

    Raises
    ------
    NotFinite
        If the motion ends before a leg does, or takes too many steps.
    """
    tolerance, magnitudes, most = control.tolerance, control.weights, control.max_steps
    given = zip(passages, starts, scalars, strict=True)
    runs, variation = [Run(p, x, own, 2 * len(x)) for p, x, own in given], magnitudes
    paths, chosen, reason = stepped(runs, fixed, variation, tolerance, method, most, far_out=True)
    smaller = _variation(passages, paths, magnitudes)
    if np.any(smaller < 0.2 * variation):
        variation = smaller
        paths, chosen, reason = stepped(runs, fixed, variation, tolerance, method, most, far_out=True)
    # Over a leg that passes a saddle, an error grows with whatever else does: its steps have to be finer.
    grown, finer = _grown(passages, paths, variation), tolerance
    while (growth := max(grown)) * finer > SAFE * tolerance and finer > TIGHTEST:
        finer = max(0.5 * tolerance * SAFE / growth, TIGHTEST)
        paths, chosen, reason = stepped(runs, fixed, variation, finer, method, most, far_out=True)
        grown = _grown(passages, paths, variation)
    amplified = max(growth * finer / tolerance, 1.0)
    steps = [path.steady for path in paths]
    if alike:
        half = len(steps) // 2
        for i in range(half):
            longer = max(steps[i], steps[i + half], key=len)
            steps[i] = steps[i + half] = longer
    if parts > 1:
        steps = _alike(steps, parts)
    return LegMesh(tuple(steps), chosen, tolerance, variation, magnitudes, amplified, reason, grown=grown)


def _alike(steps: Sequence[np.ndarray], parts: int) -> list[np.ndarray]:
    """Steps of a closure's segments, each in its own time, made alike in so many parts of it."""
    m = len(steps)
    whole = repeating([(i + own) / m for i, own in enumerate(steps)], parts)
    return [np.concatenate([[0.0], m * own[1:-1] - i, [1.0]]) for i, own in enumerate(whole)]


def _grown(
    passages: Sequence[Passage], paths: Sequence[flow.Path], variation: np.ndarray
) -> tuple[float, ...]:
    """How much a deviation grows at most over each leg, from any time on."""
    return tuple(
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

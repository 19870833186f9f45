"""Steps that are made for the segments of an orbit, whichever times they are in.

Events are not located here: a leg lasts as long as its unknown duration says, and that its guard is zero then
is an equation.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contwalk import flow
from contwalk.problems.orbit.discretization import TIGHTEST
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.problems.orbit.repeated_steps import repeating
from contwalk.problems.orbit.shooting import AT_REST, CONSTANT, MOST_STEPS, Mesh, Run, growth_of, stepped

# An orbit that would go a smaller part of its magnitudes in one period is a point.
STILL = 1e-11
# What a state is taken to move at least, in parts of what the one that moves most does.
LEAST_SHARE = 1e-3
# Local errors this small, in units of the magnitudes, are below rounding.
ROUNDED = 3e-15
# Steps are made anew for a state that varies by less than this part of what was taken; what moves so much
# less on these did not move.
LESS, SHRINKS = 0.2, 0.3
# Local errors may grow by so much over a leg before its steps are made finer.
SAFE = 30.0
# Steps of a leg at most, against those of the orbit that it is a neighbour of.
LEAST_MOST, MANY_TIMES = 2_000, 50


def meshed(
    runs: Sequence[Run],
    fixed: np.ndarray,
    control: flow.ErrorControl,
    method: str,
    parts: int = 1,
    *,
    closure: bool = False,
    alike: np.ndarray | None = None,
) -> Mesh:
    """Steps on which each segment, and a generic neighbour of it, are integrated to a tolerance.

    Parameters
    ----------
    runs : sequence of Run
        The segments.
    fixed : ndarray, shape (f,)
        Values of the parameters, and their changes along a path.
    control : ErrorControl
        How finely; the steps that a leg may take. Weights are typical magnitudes of all states, shape (n,):
        where one varies less along the orbit, its variation counts.
    method : str
    parts : int
        Of a closure that is one leg: its steps are made alike in so many parts.
    closure : bool
        The segments are those of one leg in times of the closure. Segments of legs are in times of their own.
    alike : ndarray, shape (legs,), optional
        Durations of legs of which the second half repeats the first, or its image: steps are made the same in
        both.

    Raises
    ------
    NotFinite
        If the motion ends before a segment does, or takes too many steps.
    """
    tolerance, magnitudes = control.tolerance, control.weights

    def integrated(variation: np.ndarray, tolerance: float) -> tuple[list[flow.Path], str, str]:
        return stepped(runs, fixed, variation, tolerance, method, control.max_steps, closure=closure)

    def varied(paths: Sequence[flow.Path]) -> np.ndarray:
        return _variation(runs, fixed, paths, magnitudes, tolerance if closure else None)

    variation, found = magnitudes, integrated(magnitudes, tolerance)
    smaller = varied(found[0])
    if np.any(smaller < LESS * variation):
        finer = integrated(smaller, tolerance)
        # A motion that shrinks on finer steps was their error: the closure is a point.
        if not closure or np.any(varied(finer[0]) >= SHRINKS * smaller):
            variation, found = smaller, finer
    grown, used = _grown(runs, found[0], variation), tolerance
    # Over a leg that passes a saddle, an error grows with whatever else does: its steps have to be finer.
    while not closure and (growth := max(grown)) * used > SAFE * tolerance and used > TIGHTEST:
        used = max(0.5 * tolerance * SAFE / growth, TIGHTEST)
        found = integrated(variation, used)
        grown = _grown(runs, found[0], variation)
    paths, chosen, reason = found
    steps = _repeated([path.steady for path in paths], parts, closure, alike)
    amplified = 1.0 if closure else max(max(grown) * used / tolerance, 1.0)
    return Mesh(steps, chosen, tolerance, variation, magnitudes, reason, grown=grown, amplified=amplified)


def _repeated(
    steps: list[np.ndarray], parts: int, closure: bool, alike: np.ndarray | None
) -> tuple[np.ndarray, ...]:
    """Steps made the same where the motion repeats itself, or its image; see `meshed`."""
    if alike is not None:
        steps = _alike_in_halves(steps, alike)
    if parts > 1:
        steps = list(repeating(steps, parts)) if closure else _alike(steps, parts)
    return tuple(steps)


def runs_of(orbit: DiscretizedOrbit, z: np.ndarray) -> list[Run]:
    """The segments of the orbit of z, shape (N + 1,): in times of the closure, or each in its own."""
    found = []
    for segment in orbit.layout.segments:
        x, scalars = orbit.layout.inputs_of(segment, z)
        begin, end = (segment.begin, segment.end) if orbit.in_closure else (0.0, 1.0)
        found.append(Run(orbit.passages[segment.leg], x, scalars, len(x) + len(scalars), begin, end))
    return found


def most_steps(mesh: Mesh | None, tolerance: float) -> int:
    """Steps that a leg of a neighbouring orbit may take: many times those of an orbit that is known.

    Newton's method may ask for motions that no machine has: each of their legs would take all the steps that
    there are.
    """
    if mesh is None:
        return MOST_STEPS
    longest = max(len(steps) for steps in mesh.steps)
    finer = max(mesh.tolerance / tolerance, 1.0) ** (1.0 / 8.0)  # at the order of the explicit pair
    return min(max(LEAST_MOST, int(MANY_TIMES * finer * longest)), MOST_STEPS)


def _alike_in_halves(steps: Sequence[np.ndarray], durations: np.ndarray) -> list[np.ndarray]:
    """Steps of legs of which the second half repeats the first: of both the more ones.

    Of an orbit that begins within a leg the one in the middle is the last one, and then the first one.
    """
    each, rest = divmod(len(steps), len(durations))
    if not len(durations) % 2:
        each = 0
    elif rest:  # one that lasts no time is not cut as the others are
        return list(steps)
    half = (len(steps) - each) // 2
    first, own, middle = steps[:each], steps[each:half], steps[half : half + each]
    again, last = steps[half + each : len(steps) - each], steps[len(steps) - each :]
    longer = [max(pair, key=len) for pair in zip(own, again, strict=True)]
    if each:
        share = durations[-1] / (durations[0] + durations[-1])
        pieces = (last, 0.0, share), (first, share, 1.0 - share), (middle, 1.0, 1.0)
        times = [0.5 * (at + of * (i + x) / each) for part, at, of in pieces for i, x in enumerate(part)]
        alike = [(x - x[0]) / (x[-1] - x[0]) for x in repeating(times, 2)]
        last, first, middle = alike[:each], alike[each : 2 * each], alike[2 * each :]
    return [*first, *longer, *middle, *longer, *last]


def _alike(steps: Sequence[np.ndarray], parts: int) -> list[np.ndarray]:
    """Steps of a closure's segments, each in its own time, made alike in so many parts of it."""
    m = len(steps)
    whole = repeating([(i + own) / m for i, own in enumerate(steps)], parts)
    return [np.concatenate([[0.0], m * own[1:-1] - i, [1.0]]) for i, own in enumerate(whole)]


def _grown(runs: Sequence[Run], paths: Sequence[flow.Path], variation: np.ndarray) -> tuple[float, ...]:
    """How much a deviation grows at most over each segment, from any time on."""
    return tuple(
        growth_of(path.states[:, len(run.x) :] / variation[list(run.passage.states)])
        for run, path in zip(runs, paths, strict=True)
    )


def _variation(
    runs: Sequence[Run],
    fixed: np.ndarray,
    paths: Sequence[flow.Path],
    magnitudes: np.ndarray,
    tolerance: float | None,
) -> np.ndarray:
    """Half the range of each state, not above its magnitude; the magnitudes themselves of an orbit that is
    a point, which a closure may be on steps of a tolerance.

    A state that moves far less than the others is taken as moving a thousandth of what they do, and one
    that does not move as moving as they do: what it seems to move is the error of the steps.
    """
    each = zip(runs, paths, strict=True)
    states = np.concatenate([run.passage.full(path.states[:, : len(run.x)]) for run, path in each])
    shares = 0.5 * np.ptp(states, axis=0) / magnitudes
    largest = float(shares.max())
    if tolerance is None:
        at_rest = largest <= AT_REST
    else:
        at_rest = largest < tolerance and (
            largest * tolerance < ROUNDED or _still(runs, fixed, paths, magnitudes)
        )
    if at_rest:
        return magnitudes
    shares = np.where(shares < CONSTANT * largest, largest, shares)
    varied: np.ndarray = magnitudes * np.clip(shares, LEAST_SHARE * largest, 1.0)
    return varied


def _still(
    runs: Sequence[Run], fixed: np.ndarray, paths: Sequence[flow.Path], magnitudes: np.ndarray
) -> bool:
    """Whether the field vanishes all along, to rounding."""
    for run, path in zip(runs, paths, strict=True):
        field = run.passage.field(PLAIN)
        c = field.constants(np.concatenate([run.scalars, fixed]))
        for k in range(0, len(path.times), max(len(path.times) // 8, 1)):
            moved = field(path.times[k], path.states[k, : len(run.x)], c)
            if np.abs(moved / magnitudes[list(run.passage.states)]).max() > STILL:
                return False
    return True

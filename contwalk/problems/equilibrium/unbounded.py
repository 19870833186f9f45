"""Branches that run off to infinity while their parameter converges.

Two neighbouring solutions between which the slope d lambda / dx of an unknown x falls raise the suspicion: if
it goes on falling like that, nearly nothing of the parameter's way is left. Whether it does is asked of
solutions further and further along x, which power laws, logarithms and exponentials have, and a branch that
turns round, or levels off for a while only, has not.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from contwalk.errors import PluginError
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.problem import Linearization, Sample

# The parameter is at its limit if what is left is this part of its magnitude; it must still be seen to move.
REST, SEEN = 1e-10, 1e-14
# Solutions that are asked: the first as far as the step was long, each following one so many times as far.
# (The parameter 1 / x of one twice as far is where Newton's method for 1 / lambda - x stops converging.)
PROBES, FURTHER = 34, 1.5
# Equations that fail further on overflow, and do not end there, where the slope has fallen so much before.
FALLEN = 1e-20
# They must have gone on so many times as far as where the slope would be zero if it fell in a straight line,
# which it does towards an edge of the equations' domain.
BEYOND = 2.0
# A solution has a residual this small against what the way to it would make, however steep its equations are.
REACHED = 0.1
# Where rounding hides that, the law has been seen as far as it can be, if what the parameter has left is this
# part of the suspicion's.
HIDDEN = 1e-3
# Newton steps that leave the domain of the equations are halved so often at most.
HALVINGS = 60
# How far from an edge of the domain, in magnitudes of the parameter, it is asked what is left to it; of a
# limit that exists it is this part of what it is at the second place, or less.
ASIDE, VANISHES = (1e-13, 1e-11), 0.95
# Iterations for such a solution. Residuals in units of their rounding error: where they stop, and what still
# counts as solved when they do not get there.
ITERATIONS, STOP, SOLVED = 12, 2.0, 20.0


@dataclass(frozen=True)
class Escape:
    """Which unknown grows without bound, and the limit of the parameter."""

    which: int
    limit: float


def escape(problem: EquilibriumEquations, a: Sample, b: Sample) -> Escape | None:
    """Where a branch runs off to infinity beyond two neighbouring solutions; None if it does not."""
    which = int(np.argmax(np.abs(b.tangent[:-1]) / b.weights[:-1]))
    if not _suspected(which, a, b):
        return None
    size, first = float(b.weights[-1]), float(b.tangent[-1] / b.tangent[which])
    limit, slope = b.parameter, first
    change = float(b.z[which] - a.z[which])
    before = float(a.tangent[-1] / a.tangent[which])
    straight, gone = abs(change * first / (before - first)), 0.0
    for distance, guess, there in _further(problem, which, change, b):
        if not isinstance(there, _Place):
            hidden = there is _HIDDEN and abs(slope * distance) <= HIDDEN * REST * size
            seen = abs(slope * distance) > SEEN * size and not hidden
            ends = seen or not _finite(problem, np.append(guess[:-1], b.parameter))
            told = gone > BEYOND * straight and (abs(slope) <= FALLEN * abs(first) or not ends)
            return Escape(which, limit) if told and not _at_an_edge(problem, b) else None
        gone += abs(distance)
        last, limit = slope, float(there.z[-1])
        slope = float(there.tangent[-1] / there.tangent[which])
        if abs(limit - b.parameter) > REST * size:
            return None  # it has not converged, or has turned round long ago
        falls = slope * last >= 0.0 and abs(slope) <= abs(last)
        if not falls and abs(slope * distance) > SEEN * size:
            return None
    return Escape(which, limit)


def _at_an_edge(problem: EquilibriumEquations, b: Sample) -> bool:
    """Whether right beyond a solution the equations have no value, but a limit where they cease to have one.

    There a branch arrives, however steeply: at p = 1 along x = (p - 1)**0.1, not along x = log(p - 1). What
    they change by on the rest of the way vanishes with it.
    """
    size, way = float(b.weights[-1]), float(np.copysign(1.0, b.tangent[-1]))
    inside, beyond = b.parameter, b.parameter + way * REST * size
    if _has_value(problem, b.z, beyond):
        return False
    while (between := 0.5 * (inside + beyond)) not in (inside, beyond):
        inside, beyond = (between, beyond) if _has_value(problem, b.z, between) else (inside, between)
    rests = []
    for distance in ASIDE:
        there = b.z.copy()
        there[-1] = inside - way * distance * size
        rests.append(distance * np.abs(problem.jacobian(there)[:, -1]).max())
    return bool(rests[0] < VANISHES * rests[1])


def _suspected(which: int, a: Sample, b: Sample) -> bool:
    """Whether nearly nothing of the parameter's way is left if its slope goes on falling as between two
    solutions.
    """
    change, moved, size = float(b.z[which] - a.z[which]), b.parameter - a.parameter, float(b.weights[-1])
    if change == 0.0 or a.tangent[which] * b.tangent[which] <= 0.0 or abs(moved) < SEEN * size:
        return False
    first, last = (float(s.tangent[-1] / s.tangent[which]) for s in (a, b))
    if not (first * last > 0.0 and abs(last) < abs(first)):
        return False
    return abs(last * change) <= REST * size * float(np.log(first / last))


@dataclass(frozen=True)
class _Place:
    """A solution further on, and the direction of the branch there."""

    z: np.ndarray
    tangent: np.ndarray


# What solves the equations to rounding, which is all that the way to it makes of them.
_HIDDEN = object()


def _further(
    problem: EquilibriumEquations, which: int, step: float, b: Sample
) -> Iterator[tuple[float, np.ndarray, _Place | object | None]]:
    """Solutions further and further from b along an unknown, each with its distance to the last one and the
    guess it comes from; `_HIDDEN` where rounding hides the next one, None where there is none.
    """
    place: _Place | object | None = _Place(b.z, b.tangent)
    for number in range(PROBES):
        if not isinstance(place, _Place):
            return
        distance = step * FURTHER**number
        guess = place.z + distance * place.tangent / place.tangent[which]
        guess[-1] = place.z[-1]  # what is left of its way is less than that
        try:
            with np.errstate(all="ignore"):  # what overflows is no solution
                place = _solved(problem, which, guess, b.weights, distance)
        except (PluginError, np.linalg.LinAlgError):
            place = None
        yield distance, guess, place


def _has_value(problem: EquilibriumEquations, z: np.ndarray, value: float) -> bool:
    """Whether the equations at z, shape (N + 1,), have a value with another parameter."""
    there = z.copy()
    there[-1] = value
    return _finite(problem, there)


def _finite(problem: EquilibriumEquations, z: np.ndarray) -> bool:
    try:
        with np.errstate(all="ignore"):
            return problem.linearize(z).finite
    except PluginError:
        return False


def _solved(
    problem: EquilibriumEquations, which: int, guess: np.ndarray, weights: np.ndarray, distance: float
) -> _Place | object | None:
    """The solution near a guess with the same value of an unknown, if there is one; `_HIDDEN` by rounding."""
    z, row = guess, np.zeros(len(guess))
    here = problem.linearize(z)
    for iteration in range(ITERATIONS + 1):
        if not here.finite:
            return None
        sizes = np.maximum(weights, np.abs(z))
        row[which] = 1.0 / sizes[which]
        if here.excess <= (SOLVED if iteration == ITERATIONS else STOP):
            if np.any(np.abs(here.residual) > REACHED * np.max(np.abs(here.jacobian[:, which] * distance))):
                return _HIDDEN if here.excess <= STOP else None
            tangent = here.tangent(row, sizes)
            return _Place(z, tangent) if np.all(np.isfinite(tangent)) and tangent[which] != 0.0 else None
        step = here.bordered(row, sizes).solve(np.append(here.residual, 0.0))
        z, here = _stepped(problem, z, step)
    return None


def _stepped(
    problem: EquilibriumEquations, z: np.ndarray, step: np.ndarray
) -> tuple[np.ndarray, Linearization]:
    """z - step, or less than that where the equations are not finite there."""
    here = problem.linearize(z - step)
    for _ in range(HALVINGS):
        if here.finite:
            break
        step = 0.5 * step
        here = problem.linearize(z - step)
    return z - step, here

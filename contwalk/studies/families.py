"""Orbits that come in a family at the same parameters: nothing says which one is meant.

There are two reasons for it. Along a neutral direction orbits are images of each other, and last equally
long. Where the motion conserves something, such as its energy, each value has an orbit of its own: the
multiplier 1 is double, and its left vector is the gradient of what is conserved.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from contwalk.problems.conserving import ONE_OF_EACH_VALUE
from contwalk.problems.orbit.branching import filled_magnitudes
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.problem import equations_at

# A singular value of the scaled equations below this part of the largest is zero, but for rounding and the
# steps of the start.
ZERO = 1e-7
# States that move by less than this part of the largest, in typical units, do not tell members apart.
MOVES = 1e-3
# A member whose duration changes by this part of itself, where states change by their size, is no image.
LASTS = 1e-4
# How far from an orbit another one of its family is looked for, in the metric, and how near its place it must
# be found there.
BESIDE, THERE = 1e-3, 0.5
ITERATIONS, SOLVED = 6, 1e3
# Steps from a guess to a member: how many, and how long they may be. They are damped by the square of the
# residual, by so much more each time it grows, and never by less than this part of it.
TRIES, LONGEST, DAMPED, LEAST = 30, 0.5, 10.0, 1e-3
# A multiplier is 1 to the root of this, where it is double: what rounding and the steps of a start do.
DOUBLE = 1e-6

ONE_OF_A_FAMILY = (
    "Declare a Neutral direction for each way in which they differ, or begin with an orbit that is alone, "
    "such as one that meets an event."
)


@dataclass(frozen=True)
class Family:
    """What is known of a family of orbits at the same parameters, and what to declare."""

    sentence: str
    remedy: str


@dataclass(frozen=True)
class Places:
    """Names of states: by their places in z, and by the equations that close the orbit."""

    unknowns: Mapping[int, str]
    closing: Mapping[int, str]


def family_at(problem: OrbitData, z: np.ndarray, places: Places) -> Family | None:
    """What is known of the family of orbits near a start, at the same parameters; None where there is none.

    Parameters
    ----------
    z : ndarray, shape (N + 1,)
    places : Places
    """
    weights = filled_magnitudes(problem, z)
    # At the same parameters: without the last column.
    problem, lin = equations_at(problem, z)
    matrix = lin.jacobian[:, :-1] * weights[:-1]
    if not np.isfinite(matrix).all():
        return None
    scales = _row_scales(problem, matrix)
    left, values, right = np.linalg.svd(matrix / scales[:, None])
    zero = values <= ZERO * values[0]
    if not zero.any():
        return None
    free = right[zero]
    moves = np.linalg.norm(free, axis=0)
    differ = _largest({name: moves[place] for place, name in places.unknowns.items()})
    among = f": they differ in {', '.join(differ)}" if differ else ""
    sentence = f"Orbits come in a family there, at the same parameters{among}."
    if problem.forced:
        return Family(sentence, ONE_OF_A_FAMILY)
    lasting = [abs(float(problem.duration_gradient(z)[:-1] @ (r * weights[:-1]))) for r in free]
    own = _conserved(problem, z, places, left[:, zero] / scales[:, None])
    if not own:
        return Family(sentence, ONE_OF_A_FAMILY)
    if max(lasting) > LASTS * abs(problem.duration(z)):
        return Family(f"{sentence} They last differently long. {own}", ONE_OF_EACH_VALUE)
    return Family(
        f"{sentence} {own}",
        f"{ONE_OF_EACH_VALUE} If they are images of each other instead: {ONE_OF_A_FAMILY}",
    )


def is_one_of_a_family(problem: OrbitData, z: np.ndarray) -> bool:
    """Whether a solution z, shape (N + 1,), is one of a family at the same parameters.

    More than one direction leads from it to neighbours; one in which another solution lies beside it is none
    of a branch point.
    """
    weights = filled_magnitudes(problem, z)
    whole = _scaled(problem, z, weights)
    if whole is None or not _deficient(whole):
        return False
    at_rest = whole[:, :-1]
    direction = np.append(np.linalg.svd(at_rest)[2][-1], 0.0) * weights
    there = z + BESIDE * direction
    for _ in range(ITERATIONS):
        own = _scaled(problem, there, weights)
        if own is None:
            return False
        problem, lin = equations_at(problem, there)
        if lin.excess_in(weights) <= SOLVED:
            break
        scales = _row_scales(problem, lin.jacobian[:, :-1] * weights[:-1])
        step = np.linalg.lstsq(own[:, :-1], -lin.residual / scales, rcond=ZERO)[0]
        there = there + np.append(step, 0.0) * weights
    else:
        return False
    moved = float(((there - z) / weights) @ (direction / weights))
    return moved > THERE * BESIDE and own is not None and _deficient(own)


def member_near(problem: OrbitData, z: np.ndarray) -> np.ndarray | None:
    """A member of a family near a guess z, at the same parameters; None where the guess leads to none.

    Both have the shape (N + 1,).

    Newton's method goes astray there: the smallest singular value vanishes with the residual. Damped by the
    residual's own size, steps by least squares come to the family as fast as Newton's to a single orbit
    (J. Fan & Y. Yuan, Computing 74 (2005) 23).
    """
    problem, lin = equations_at(problem, z)
    weights, extra = filled_magnitudes(problem, z), 1.0
    for _ in range(TRIES):
        matrix = lin.jacobian[:, :-1] * weights[:-1]
        if not (np.isfinite(matrix).all() and np.isfinite(lin.residual).all()):
            return None
        scales = _row_scales(problem, matrix)
        left, values, right = np.linalg.svd(matrix / scales[:, None])
        rest = lin.residual / scales
        damping = extra * float(rest @ rest)
        step = -right.T @ (values / (values**2 + damping) * (left.T @ rest))
        step *= LONGEST / max(LONGEST, float(np.abs(step).max()))
        trial = z + np.append(step, 0.0) * weights
        problem, there = equations_at(problem, trial)
        if not np.linalg.norm(there.residual / scales) < np.linalg.norm(rest):
            extra *= DAMPED
            continue
        z, lin, extra = trial, there, max(extra / DAMPED, LEAST)
        if lin.excess_in(weights) <= SOLVED:
            return z
    return None


def _scaled(problem: OrbitData, z: np.ndarray, weights: np.ndarray) -> np.ndarray | None:
    """DF(z) in the units of the unknowns and of the equations; None where it is not finite."""
    matrix = equations_at(problem, z)[1].jacobian * weights
    return matrix / _row_scales(problem, matrix[:, :-1])[:, None] if np.isfinite(matrix).all() else None


def _row_scales(problem: OrbitData, matrix: np.ndarray) -> np.ndarray:
    """Units of the equations, or what they tell, if that is more: of a row of rounding noise it is not."""
    return np.maximum(np.abs(matrix).max(axis=1), problem.equation_scales)


def _deficient(matrix: np.ndarray) -> bool:
    values = np.linalg.svd(matrix, compute_uv=False)
    return bool(values[-1] <= ZERO * values[0])


def _largest(sizes: Mapping[str, float]) -> list[str]:
    """Names whose sizes are no small part of the largest."""
    most = max(sizes.values(), default=0.0)
    return [name for name, size in sizes.items() if most > 0.0 and size > MOVES * most]


def _conserved(problem: OrbitData, z: np.ndarray, places: Places, left: np.ndarray) -> str:
    """The second multiplier 1 and its left vector in words; empty where none is seen."""
    found = problem.multipliers(z, problem.linearize(z).jacobian).values
    apart = np.abs(found - 1.0)
    if not len(found) or not apart.min() <= np.sqrt(DOUBLE):
        return ""
    gradient = np.array([np.linalg.norm(left[row]) for row in places.closing])
    names = list(places.closing.values())
    if left.shape[1] > 1:
        named = ", ".join(_largest(dict(zip(names, gradient.tolist(), strict=True))))
        vectors = f"with left vectors in {named}"
    else:
        own = left[list(places.closing), 0]
        own = own / own[int(np.argmax(np.abs(own)))]
        seen = [f"{name} {entry:+.3g}" for name, entry in zip(names, own, strict=True) if abs(entry) > MOVES]
        vectors = f"with the left vector {', '.join(seen)}"
    return (
        f"A second multiplier is 1, to {max(float(apart.min()), 1e-16):.0e}, {vectors}: that is the gradient "
        "of what the motion conserves, such as its energy."
    )

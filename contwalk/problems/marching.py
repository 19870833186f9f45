"""Solutions further and further out along a family, a coordinate held at each while the parameter is found.

Near its limit the parameter is worth less than the errors of a walk's steps, and arclength goes into what
grows. So these solutions are found on steps as fine as rounding allows, and in units of what is left of the
parameter's way.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from contwalk.errors import NotFinite, PluginError, StartError
from contwalk.numerics.laws import EXPONENTIAL, Pair
from contwalk.numerics.linear import EPSILON
from contwalk.problems.problem import Sample, finest
from contwalk.problems.solving import error_holding, newton_on

# Newton's method stagnates at rounding, which may be a large part of what is left of the parameter's way.
STAGNATES = 1e-2
# How many solutions are asked for; each step is longer than the last, or shorter where it failed; so many
# that fail are too many.
MOST, LONGER, SHORTER, LOST = 60, 2.0, 0.25, 2
# The parameter of a solution further out moves by no more than so many times what is left of its way, or what
# it has moved by before: what does is a solution of another family, as an equilibrium is.
ABOUT = 4.0
# A power with which another unknown grows: beyond, it goes straight on.
MOST_POWER = 4.0


@dataclass(frozen=True)
class Coordinate:
    """What is held: its value at a solution z of a problem, and its gradient, both of shape (N + 1,).

    `grows` are the unknowns whose magnitudes grow with it, shape (N + 1,). Solutions that are not found count
    in a row alone while it grows by the factor `surely`: what runs to infinity is followed in ever longer
    steps, a canard's family only in short ones through all its changes of shape.
    """

    value: Callable[[Any, np.ndarray], float]
    gradient: Callable[[Any, np.ndarray], np.ndarray]
    grows: np.ndarray | bool = False
    surely: float = 2.0


def unknown(which: int, grows: np.ndarray | bool = False) -> Coordinate:
    """One of the unknowns; `grows` has the shape (N + 1,)."""
    return Coordinate(lambda _, z: float(z[which]), lambda _, z: np.eye(len(z))[which], grows)


# The period of an orbit.
PERIOD = Coordinate(
    lambda orbit, z: float(orbit.duration(z)), lambda orbit, z: orbit.duration_gradient(z), surely=0.0
)


@dataclass(frozen=True)
class Place:
    """A solution at a value of the coordinate.

    Parameters
    ----------
    problem : Problem
        On the steps that it is solved on.
    at : float
        The coordinate.
    z : ndarray, shape (N + 1,)
    rates : ndarray, shape (N + 1,)
        How it changes with the coordinate.
    error : float
        Of the parameter, by what errors of the equations make of it and what Newton's method has left.
    """

    problem: Any
    at: float
    z: np.ndarray
    rates: np.ndarray
    error: float


def pair_of(a: Place, b: Place) -> Pair:
    """What two solutions tell of the law that the parameter obeys."""
    columns = zip(*((p.at, p.z[-1], p.rates[-1]) for p in (a, b)), strict=True)
    return Pair(*(np.array(column) for column in columns))


def march(
    problem: Any, coordinate: Coordinate, samples: Sequence[Sample], step: float, left: float
) -> Iterator[Place]:
    """The solutions of samples on the finest steps, and those further out than the last while there are any.

    `step` is how far the next one is, `left` what is left of the parameter's way there.
    """
    known = [_held(problem, coordinate, sample.z, sample.weights, left) for sample in samples]
    found = [place for place in known if place is not None]
    if len(found) < len(known):
        return
    yield from found
    place, weights = found[-1], samples[-1].weights
    begun, since, lost, moves = place.at, place.at, 0, abs(left)
    for _ in range(MOST):
        grown = np.where(coordinate.grows, max(_times(place.at + step, begun), 1.0), 1.0)
        further = _held(place.problem, coordinate, _guess(place, step, left), weights * grown, left)
        if further is None or abs(float(further.z[-1] - place.z[-1])) > ABOUT * moves + further.error:
            lost, step = lost + 1, SHORTER * step
            if lost > LOST:
                return
            continue
        pair = pair_of(place, further)
        left = pair.left if pair.falls else left
        moves = max(abs(left), abs(float(pair.values[1] - pair.values[0])))
        if abs(further.at) > coordinate.surely * abs(since):
            lost, since = 0, further.at
        place, step = further, LONGER * step
        yield place


def _guess(place: Place, step: float, left: float) -> np.ndarray:
    """Unknowns a step on, shape (N + 1,): each a power of the coordinate, or straight on; so is what is left
    of the parameter's way, or it falls exponentially.
    """
    z, straight, longer = place.z, place.z + step * place.rates, _times(place.at + step, place.at)
    with np.errstate(all="ignore"):
        powers = place.rates * place.at / z
        steady = np.isfinite(powers) & (np.abs(powers) < MOST_POWER) & (longer > 0.0)
        guess = np.where(steady, z * abs(longer) ** np.where(steady, powers, 0.0), straight)
    rate = float(place.rates[-1]) / left if left else 0.0
    if rate * step <= 0.0:
        guess[-1] = straight[-1]
    else:
        by_power = longer > 0.0 and 0.0 < rate * place.at < EXPONENTIAL
        falls = -rate * (place.at * np.log(longer) if by_power else step)
        guess[-1] = z[-1] - left * float(np.expm1(falls))
    return guess


def _times(x: float, y: float) -> float:
    """x / y, infinite where y is zero."""
    return x / y if y else np.inf


def _held(
    problem: Any, coordinate: Coordinate, guess: np.ndarray, weights: np.ndarray, left: float
) -> Place | None:
    """The solution near a guess with the guess's value of the coordinate, if there is one that the machine
    can be in.

    Guess and weights have the shape (N + 1,).
    """
    sizes = np.maximum(weights, np.abs(guess))
    # Of the parameter, what is left of its way counts.
    units = np.append(sizes[:-1], max(abs(left), EPSILON * float(sizes[-1])))
    try:
        with np.errstate(all="ignore"):  # what overflows is no solution
            there: Any = finest(problem, guess, sizes) or problem
            gradient = coordinate.gradient(there, guess)
            row = gradient / np.linalg.norm(gradient * units)
            z = newton_on(there, guess, units, row, STAGNATES)
            here, error = there.linearize(z), error_holding(there, z, units, row)
            rest = here.bordered(row, units).solve(np.append(here.residual, 0.0))
            if abs(rest[-1]) > error:  # in units of what was left before, it has converged too soon
                z = z - rest
                here = there.linearize(z)
            rates = here.tangent(row, units)
            rates, error = rates / float(gradient @ rates), error + abs(float(rest[-1]))
            exists = there.meshed is None or there.admissible_at(z)
    except (NotFinite, PluginError, StartError, np.linalg.LinAlgError):
        return None
    found = exists and bool(np.all(np.isfinite(rates))) and np.isfinite(error)
    return Place(there, coordinate.value(there, z), z, rates, error) if found else None

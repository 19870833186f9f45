"""Families of orbits that grow without bound while their parameter converges.

As of equilibria (`problems.unbounded`), two neighbouring orbits along which a state grows and the slope
d lambda / dx falls raise the suspicion, and orbits further out decide. These are solved on steps of their
own, as fine as rounding allows: near its limit the parameter is worth less than the errors of a walk's steps,
and an orbit of another size may need other steps. The parameter is followed until what is left of its way is
rounding, or no more than errors of the equations are worth at an orbit of that size.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from contwalk.branch import Outcome
from contwalk.errors import NotFinite, PluginError, StartError
from contwalk.problems.orbit.discretization import FINEST
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.solving import error_holding, newton_on
from contwalk.problems.problem import Sample, equations_at
from contwalk.quantities import AMP

# A state that grows by less in a step may as well converge.
GROWS = 1e-3
# One that is smaller than this part of its variation, against others, is no measure of the orbit's size;
# those that grow like powers of each other have rates that are alike.
LARGE, ALIKE = 0.3, 0.3
# A state that moves to another phase may grow where the orbit does not, whose variation then does not grow at
# least like this power of it.
TOGETHER = 0.5
# The parameter's share of the tangent, in the metric, that leaves it more of its way than is asked about.
STILL = 1e-3
# Orbits further out are asked for where so little of the parameter's way is left, relative to its magnitude,
# and until so little is left, or so many times what errors of the equations are worth.
SUSPECTED, REST, KNOWN = 1e-6, 1e-13, 10.0
# By this factor the way has fallen by then: a family that has come to a turn, or a limit, has not.
FALLEN = 1e-2
# Newton's method stagnates at rounding, which may be a large part of what is left of the parameter's way.
STAGNATES = 1e-2
# How many orbits are asked, the first as far as the step was long, each following one twice as far; one that
# is not found is looked for less far, so many times in a row. So many in all are too many before the orbit
# has grown by this factor: a family that runs to infinity is followed in ever longer steps, a canard's only
# in short ones through all its changes of shape.
PROBES, FURTHER, SHORTER, LOST, GROWN_BY_THEN = 60, 2.0, 0.25, 2, 2.0
# They are asked where a state passes a power of this, and not at every step.
ASKED = 2.0**0.25
# A power with which another unknown grows: beyond, it goes straight on.
MOST_POWER = 4.0
# Orbits must have grown by this factor: the parameter of a canard stands still too, while its size goes from
# one cycle's to another's.
GROWN = 10.0
# They must have gone on so many times as far as where the slope would be zero if it fell in a straight line.
BEYOND = 2.0
# A way that is left like a higher power of the state than this falls exponentially.
EXPONENTIAL = 8.0


@dataclass(frozen=True)
class _Place:
    """An orbit with the direction of its family, and what the parameter is not known to at this size."""

    z: np.ndarray
    tangent: np.ndarray
    error: float


def unbounded(problem: OrbitData, a: Sample, b: Sample) -> Outcome | None:
    """The end where orbits grow without bound, if two neighbouring ones and those further out show it."""
    if abs(b.tangent[-1]) > STILL * b.weights[-1]:
        return None
    which = _growing(problem, b)
    if which is None or not _asked(which, a, b) or not _suspected(problem, which, a, b):
        return None
    found = _limit(problem, which, a, b)
    if found is None:
        return None
    limit, error = found
    limit = 0.0 if abs(limit) <= error else limit
    return Outcome(
        "complete",
        "unbounded",
        f"The orbit grows without bound as {problem.free} tends to {limit:.12g} +- {error:.1e}, by "
        f"extrapolation from {b.parameter:.12g}: {_state_of(problem, which)} is {b.z[which]:.4g} there, the "
        f"period {problem.system.lasting(b.period, '.4g')}. Nothing to do.",
    )


def _growing(problem: OrbitData, b: Sample) -> int | None:
    """Of the states that grow fastest, in units of their own size, the largest; None if there is none.

    One that is small beside its variation is known less well than others that grow with it.
    """
    states = np.array([_state_of(problem, k) is not None for k in range(len(b.z) - 1)])
    shares = np.where(states, np.minimum(np.abs(b.z[:-1]) / b.weights[:-1], 1.0), 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        rates = b.tangent[:-1] / b.z[:-1]
    rates = np.where(shares > LARGE * shares.max(initial=0.0), rates, 0.0)
    which = int(np.argmax(np.where(rates > ALIKE * rates.max(initial=0.0), shares, 0.0)))
    return which if rates[which] > 0.0 else None


def _state_of(problem: OrbitData, which: int) -> str | None:
    """Name of the state that an unknown is a value of, None if it is an angle's or none's."""
    for place, passage in problem.places:
        if place.start <= which < place.stop:
            state = problem.system.states[passage.states[which - place.start]]
            return None if state.period else state.name
    return None


def _asked(which: int, a: Sample, b: Sample) -> bool:
    """Whether a state passes a place at which orbits further out are asked."""
    with np.errstate(divide="ignore"):
        before, now = (np.floor(np.log(abs(s.z[which])) / np.log(ASKED)) for s in (a, b))
    return bool(now > before)


def _suspected(problem: OrbitData, which: int, a: Sample, b: Sample) -> bool:
    """Whether nearly nothing of the parameter's way is left if its slope goes on falling as it does."""
    change = float(b.z[which] - a.z[which])
    if change * b.z[which] <= GROWS * b.z[which] ** 2 or a.tangent[which] * b.tangent[which] <= 0.0:
        return False
    if a.z[which] * b.z[which] <= 0.0:  # it has come from the other side: of no power is that a part
        return False
    if not _falls(which, a, b):
        return False
    if abs(_left(which, a, b)) > SUSPECTED * float(b.weights[-1]):
        return False
    before, now = (problem.observable(f"{AMP}{_state_of(problem, which)}", s.z) for s in (a, b))
    return bool(now >= before * (b.z[which] / a.z[which]) ** TOGETHER)


def _limit(problem: OrbitData, which: int, a: Sample, b: Sample) -> tuple[float, float] | None:
    """Limit of the parameter and its error, None where the family goes on."""
    change, size = float(b.z[which] - a.z[which]), float(b.weights[-1])
    before, first = _slope(which, a), _slope(which, b)
    straight = abs(change * first / (before - first))
    places = _further(problem, which, change, a, b)
    last = next(places, None)
    if last is None:
        return None
    begun, limit, error = last, np.nan, np.inf
    for place in places:
        arrived = np.isfinite(error)
        if arrived and abs(float(place.z[-1]) - limit) > KNOWN * (error + place.error):
            return None
        if place.error > SUSPECTED * size:
            return None  # nothing is known of the parameter there, as of a point that is called an orbit
        if not arrived:
            if not _falls(which, last, place):
                return None
            left = _left(which, last, place)
            if abs(left) <= max(REST * size, KNOWN * place.error):
                limit, error = float(place.z[-1]) + left, abs(left) + place.error
                if abs(left) > FALLEN * SUSPECTED * size:
                    return None
        last = place
        far = abs(float(last.z[which] - begun.z[which])) > BEYOND * straight
        if np.isfinite(error) and far and float(last.z[which] / begun.z[which]) > GROWN:
            # A parameter that has stood still all the way, as where a machine conserves something, has no
            # slope that falls: what it seems to be are errors.
            way = abs(float(begun.z[-1]) - limit)
            return (limit, error) if way > KNOWN * (error + begun.error) else None
    return None


def _slope(which: int, there: Sample | _Place) -> float:
    """d lambda / dx."""
    return float(there.tangent[-1] / there.tangent[which])


def _falls(which: int, a: Sample | _Place, b: Sample | _Place) -> bool:
    """Whether the slope at b is a part of that at a, and the parameter does not stand still."""
    before, after = _slope(which, a), _slope(which, b)
    return before * after > 0.0 and abs(after) < abs(before)


def _left(which: int, a: Sample | _Place, b: Sample | _Place) -> float:
    """What is left of the parameter's way beyond b: it falls as a power of the state, or exponentially."""
    first, last, longer = _slope(which, a), _slope(which, b), float(np.log(b.z[which] / a.z[which]))
    power = float(np.log(first / last)) / longer - 1.0
    if 0.0 < power < EXPONENTIAL:
        return last * float(b.z[which]) / power
    return last * float(b.z[which] - a.z[which]) / float(np.log(first / last))


def _further(problem: OrbitData, which: int, step: float, a: Sample, b: Sample) -> Iterator[_Place]:
    """The orbit of b on fine steps, and orbits further and further out along a state, while there are any."""
    left = _left(which, a, b)
    states = np.array([_state_of(problem, k) is not None for k in range(len(b.z))])
    last = begun = _solved(problem, which, b.z, b.weights, left)
    lost = running = 0
    if last is None or begun is None:
        return
    yield last
    for _ in range(PROBES):
        there = float(last.z[which]) + step
        guess = _guess(last, which, there, left)
        grown = np.where(states, there / float(b.z[which]), 1.0)
        place = _solved(problem, which, guess, b.weights * grown, left)
        if place is None:
            lost, running, step = lost + 1, running + 1, SHORTER * step
            small = float(last.z[which] / begun.z[which]) < GROWN_BY_THEN
            if (lost if small else running) > LOST:
                return
            continue
        if _falls(which, last, place):
            left = _left(which, last, place)
        last, running, step = place, 0, FURTHER * step
        yield place


def _guess(place: _Place, which: int, there: float, left: float) -> np.ndarray:
    """Unknowns where a state has a value: each a power of it, or straight on; so is what is left of the
    parameter's way.
    """
    z, tangent = place.z, place.tangent / place.tangent[which]
    with np.errstate(divide="ignore", invalid="ignore"):
        powers = tangent * z[which] / z
    straight = z + (there - z[which]) * tangent
    steady = np.isfinite(powers) & (np.abs(powers) < MOST_POWER)
    guess = np.where(steady, z * (there / z[which]) ** np.where(steady, powers, 0.0), straight)
    rate = tangent[-1] / left  # at which its logarithm falls
    power, on = rate * z[which], there - z[which]
    with np.errstate(over="ignore"):
        falls = (there / z[which]) ** -power if power < EXPONENTIAL else np.exp(-rate * on)
    guess[-1] = z[-1] + left * (1.0 - falls)
    return guess


def _solved(
    problem: OrbitData, which: int, guess: np.ndarray, weights: np.ndarray, left: float
) -> _Place | None:
    """The orbit near a guess with the same value of a state, if there is one that the machine can move on."""
    sizes = np.maximum(weights, np.abs(guess))
    held = np.zeros(len(guess))
    held[which] = 1.0 / sizes[which]
    units = np.append(sizes[:-1], abs(left))  # of the parameter, what is left of its way counts
    try:
        with np.errstate(all="ignore"):  # what overflows is no orbit
            there = problem.refined(guess, sizes, FINEST)  # in one section, in which the family is a curve
            z = newton_on(there, guess, units, held, STAGNATES)
            tangent = equations_at(there, z)[1].tangent(held, units)
            error = error_holding(there, z, units, held)
            fine = there.admissible_at(z) and np.all(np.isfinite(tangent)) and tangent[which] != 0.0
    except (NotFinite, PluginError, StartError, np.linalg.LinAlgError):
        return None
    return _Place(z, tangent, error) if fine and np.isfinite(error) else None

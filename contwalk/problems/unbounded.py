"""Whether a family runs off to infinity while its parameter converges, and to which value.

Two neighbouring solutions between which the slope d lambda / dx of an unknown x falls raise the suspicion: if
it goes on falling like that, nearly nothing of the parameter's way is left. Whether it does is asked of
solutions further and further along x, until what is left is rounding: power laws, logarithms and exponentials
have them, and a family that turns round, or levels off for a while only, has not.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from contwalk.numerics.laws import LAWFUL, Pair
from contwalk.numerics.linear import EPSILON
from contwalk.problems.marching import Place, march, pair_of, unknown
from contwalk.problems.problem import Sample

# Errors of the equations are worth so much in places where they hide what is left of the parameter's way.
KNOWN = 10.0
# Solutions must have gone on so many times as far as where the slope would be zero if it fell in a straight
# line, which it does towards an edge of the equations' domain.
BEYOND = 2.0


def limit_at_infinity(
    problem: Any,
    which: int,
    a: Sample,
    b: Sample,
    suspected: float,
    fallen: float = 1.0,
    grown: float = 0.0,
    grows: np.ndarray | bool = False,
) -> tuple[float, float] | None:
    """The value that the parameter tends to as an unknown goes on from a to b and further, and its error.

    None where the family goes on: more than a part `suspected` of the parameter's magnitude is left, or the
    law ends before the unknown has grown by the factor `grown`, and the slope has fallen to the part `fallen`
    or is hidden by errors. With it grow the unknowns of `grows`, shape (N + 1,).
    """
    size, before, after = float(b.weights[-1]), a.tangent, b.tangent
    if not before[which] * after[which] > 0.0 or a.z[which] == b.z[which]:
        return None
    slopes = np.array([before[-1] / before[which], after[-1] / after[which]])
    pair = Pair(np.array([a.z[which], b.z[which]]), np.array([a.z[-1], b.z[-1]]), slopes)
    if not (pair.falls and abs(pair.left) <= suspected * size):
        return None
    straight, rate = pair.straight, pair.rate
    begun: Place | None = None
    found: tuple[float, float] | None = None
    for last, place in pairwise(march(problem, unknown(which, grows), (b,), pair.apart, pair.left)):
        begun = begun or last
        pair, known = pair_of(last, place), KNOWN * place.error
        # What is not known to the suspicion itself tells nothing; what is seen has to fall.
        if place.error > suspected * size or (not pair.falls and abs(pair.slopes[1] * pair.apart) > known):
            return None
        left = pair.left if pair.falls else 0.0
        if found is None and abs(left) <= max(EPSILON * size, known):
            found = float(place.z[-1]) + left, abs(left) + place.error
        if found is None:
            continue
        limit, error = found
        if abs(float(place.z[-1]) - limit) > KNOWN * error + known:
            return None
        # What comes to zero runs off to nowhere, as a power of itself does, unless it falls exponentially.
        lawful = abs(pair.rate / rate - 1.0) <= LAWFUL
        away = max(grown * abs(begun.at), 0.0 if lawful else float(b.weights[which]))
        far = abs(place.at - begun.at) > BEYOND * straight and abs(place.at) > away
        if far and (abs(left) <= known or abs(place.rates[-1]) <= fallen * abs(begun.rates[-1])):
            # What has stood still all the way, as where a machine conserves something, has no slope.
            known_before = (a.parameter, a.error * float(a.weights[-1])), (float(begun.z[-1]), begun.error)
            moves = any(abs(value - limit) > KNOWN * (error + off) for value, off in known_before)
            return found if moves else None
    return None

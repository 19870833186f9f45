"""Families of orbits that grow without bound while their parameter converges.

Of the states that grow with the orbit one stands for its size; `problems.unbounded` tells whether it has a
limit. Orbits further out are as dear as steps of a walk: they are asked where that state has grown by a part.
"""

from __future__ import annotations

import numpy as np

from contwalk.branch import Outcome
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.problem import Sample
from contwalk.problems.unbounded import limit_at_infinity
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
# Orbits further out are asked for where so little of the parameter's way is left, relative to its magnitude.
SUSPECTED = 1e-6
# They are asked where a state passes a power of this, and not at every step.
ASKED = 2.0**0.25
# Orbits must have grown by this factor: the parameter of a canard stands still too, while its size goes from
# one cycle's to another's.
GROWN = 10.0


def unbounded(problem: OrbitData, a: Sample, b: Sample) -> Outcome | None:
    """The end where orbits grow without bound, if two neighbouring ones and those further out show it."""
    if abs(b.tangent[-1]) > STILL * b.weights[-1]:
        return None
    which = _growing(problem, b)
    if which is None or not _asked(which, a, b) or not _grows(problem, which, a, b):
        return None
    states = np.array([_state_of(problem, k) is not None for k in range(len(b.z))])
    found = limit_at_infinity(problem, which, a, b, SUSPECTED, grown=GROWN, grows=states)
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


def _grows(problem: OrbitData, which: int, a: Sample, b: Sample) -> bool:
    """Whether a state grows by more than it may as one that converges, and the orbit with it."""
    change = float(b.z[which] - a.z[which])
    if change * b.z[which] <= GROWS * b.z[which] ** 2 or a.z[which] * b.z[which] <= 0.0:
        return False  # what has come from the other side is a part of no power
    before, now = (problem.observable(f"{AMP}{_state_of(problem, which)}", s.z) for s in (a, b))
    return bool(now >= before * (b.z[which] / a.z[which]) ** TOGETHER)

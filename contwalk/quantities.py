"""Names of what an orbit does with a state: `max:X`, `min:X`, `amp:X`, and `X@2` where an event comes again.

`max:X` and `min:X` are the largest and the least value over the whole orbit, and stored with it; `amp:X` is
half their difference. An orbit that meets the event at which its state is reported several times has the
state at each of them: `X` at the first, `X@2` at the second. `period` is the duration of its closure.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

MAX, MIN, AMP = "max:", "min:", "amp:"
VISIT = "@"
PERIOD = "period"
# Of curves of Hopf points the square of the frequency; where it is negative they go on as neutral saddles.
FREQUENCY_SQUARED, NEUTRAL_SADDLE = "frequency_squared", "neutral_saddle"
# Of curves of Neimark-Sacker points (mu + 1/mu) / 2; beyond one in modulus they go on likewise.
COSINE = "cos_theta"


def saddles(observables: Sequence[str], values: np.ndarray) -> np.ndarray:
    """Which points of a curve in two parameters are neutral saddles, shape (k,).

    `observables` are the names of the columns of `values`, shape (k, o).
    """
    names = list(observables)
    if FREQUENCY_SQUARED in names:
        return np.asarray(values[:, names.index(FREQUENCY_SQUARED)] <= 0.0)
    if COSINE in names:
        return np.asarray(np.abs(values[:, names.index(COSINE)]) >= 1.0)
    return np.zeros(len(values), dtype=bool)


def extreme_names(states: Sequence[str]) -> tuple[str, ...]:
    """The names that are stored of orbits: all `max:X`, then all `min:X`."""
    return (*(MAX + name for name in states), *(MIN + name for name in states))


def every_extreme(states: Sequence[str]) -> tuple[str, ...]:
    """All names of extremes that may be asked for."""
    return (*extreme_names(states), *(AMP + name for name in states))


def visit_names(states: Sequence[str], visits: int) -> tuple[str, ...]:
    """Names of states at the second and all later of so many events."""
    return tuple(f"{name}{VISIT}{k}" for k in range(2, visits + 1) for name in states)


def of_orbit(name: str) -> bool:
    """Whether a name is one of those of this module."""
    return ":" in name or VISIT in name


def ends_of(name: str) -> tuple[str, str] | None:
    """The two names that `amp:X` is half the difference of; None for any other name."""
    if not name.startswith(AMP):
        return None
    state = name.removeprefix(AMP)
    return MAX + state, MIN + state


def known(name: str, names: Sequence[str]) -> bool:
    """Whether a quantity is one of the stored ones, or follows from them."""
    ends = ends_of(name)
    return name in names or (ends is not None and ends[0] in names)


def column(name: str, names: Sequence[str], values: np.ndarray) -> np.ndarray | None:
    """A quantity from stored `values`, shape (..., o), in the order of `names`; None of an unknown one."""
    if name in names:
        return np.asarray(values[..., names.index(name)])
    ends = ends_of(name)
    if ends is None or ends[0] not in names:
        return None
    high, low = (values[..., names.index(end)] for end in ends)
    return np.asarray(0.5 * (high - low))

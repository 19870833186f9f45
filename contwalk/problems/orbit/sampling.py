"""Instants of an orbit that samples would miss: where a state is extreme, and where it passes a value."""

from __future__ import annotations

import numpy as np

from contwalk import quantities
from contwalk.errors import measured
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.motion import extremes, motion
from contwalk.problems.orbit.multipliers import Multipliers
from contwalk.problems.passing import Place
from contwalk.system.declarations import ParameterValues

MOST_BISECTIONS = 60


def crossing(
    problem: DiscretizedOrbit, z: np.ndarray, t: np.ndarray, x: np.ndarray, place: Place
) -> np.ndarray:
    """The state at which a sampled motion first passes a value of a state; NaN if it never does.

    z has the shape (N + 1,), t (k,), x (k, n), the state (n,).
    """
    begun = place.begun_at(x)
    if begun is not None:
        return begun
    found = place.passed(x)
    if found is None:
        return np.full(problem.states, np.nan)
    k, turn = found
    stretches = problem.stretches(z)
    piece = k // (len(t) // len(stretches))
    low, high = t[k : k + 2] / problem.duration(z) - piece
    for _ in range(MOST_BISECTIONS):
        middle = 0.5 * (low + high)
        there = stretches[piece].at(np.array([min(middle, 1.0)]))[1][0]
        low, high = (middle, high) if place.beyond(there) < turn else (low, middle)
        if high - low < 1e-15:
            break
    return place.told(there, turn)


def measured_along(orbit: DiscretizedOrbit, z: np.ndarray) -> list[float]:
    """Values of the observables that no multiplier tells, in their order. z has the shape (N + 1,)."""
    values: list[float] = []
    if orbit.system.observables:
        t, x = motion(orbit, z)
        p = ParameterValues(**orbit.values_of(z))
        values = [measured(f"observable '{o.name}'", o.function, t, x, p) for o in orbit.system.observables]
    low, high = extremes(orbit, z)
    return [*values, *high.tolist(), *low.tolist()]


def values(problem: DiscretizedOrbit, z: np.ndarray, found: Multipliers) -> list[float]:
    """Values of `observable_names`. z has the shape (N + 1,)."""
    largest = float(np.abs(found.values[0])) if len(found.values) else float("nan")
    return [*measured_along(problem, z), largest**problem.rounds]


def value(problem: DiscretizedOrbit, name: str, z: np.ndarray) -> float:
    """The value of one observable that is not `max_abs`. z has the shape (N + 1,)."""
    if quantities.of_orbit(name):
        low, high = extremes(problem, z)
        names = quantities.extreme_names(problem.system.state_names)
        value = quantities.column(name, names, np.concatenate([high, low]))
        assert value is not None, name
        return float(value)
    function = next(o.function for o in problem.system.observables if o.name == name)
    t, x = motion(problem, z)
    p = ParameterValues(**problem.values_of(z))
    return measured(f"observable '{name}'", function, t, x, p)


def reported(problem: DiscretizedOrbit, z: np.ndarray) -> np.ndarray:
    """The state at the phase condition's point, or where the run asks for it, shape (n,); NaN if it
    never is.
    """
    place = problem.discretization.report_at
    if place is None:
        return z[: problem.states]
    t, x = motion(problem, z)
    return crossing(problem, z, t, x, Place.of(problem.system, *place))

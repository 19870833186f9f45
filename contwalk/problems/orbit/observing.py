"""What is told of an orbit: its observables, margins, extremes of states, states at events, multipliers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from contwalk import quantities
from contwalk.errors import measured
from contwalk.problems.orbit.motion import extremes, motion
from contwalk.problems.orbit.multipliers import Multipliers
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.reporting import at_event, visited, visits
from contwalk.problems.problem import MAX_ABS
from contwalk.system import Observable
from contwalk.system.declarations import ParameterValues

# Multipliers this small are zero but for errors.
NOTHING = 1e-6


def names(orbit: OrbitData) -> tuple[str, ...]:
    """The system's observables; of orbits that limits bound, margins of what is watched and of conditions,
    and `split`; extremes of states, states at further visits of an event, and `max_abs`.
    """
    system = orbit.system
    own = system.observable_names if orbit.limited is not None else [o.name for o in system.observables]
    later = quantities.visit_names(system.state_names, visits(orbit))
    return (*own, *quantities.extreme_names(system.state_names), *later, MAX_ABS)


def values(orbit: OrbitData, z: np.ndarray, found: Multipliers) -> list[float]:
    """Values of all observables, with the multipliers of z. z has the shape (N + 1,)."""
    largest = float(np.abs(found.values[0])) if len(found.values) else float("nan")
    return [*measured_along(orbit, z, found.values), whole_of(largest, orbit.rounds)]


def whole_of(modulus: float, rounds: int) -> float:
    """The modulus of a multiplier over a full orbit of some closures; infinite beyond 1e308."""
    with np.errstate(over="ignore"):
        return float(np.float64(modulus) ** rounds)


def measured_along(orbit: OrbitData, z: np.ndarray, multipliers: np.ndarray | None = None) -> list[float]:
    """Values of all observables but the last, `max_abs`. z has the shape (N + 1,), multipliers (m,)."""
    there: tuple[Any, np.ndarray] = orbit.explicit(z)
    orbit, z = there
    observables = orbit.system.observables
    own = _measured(orbit, z, observables)
    if orbit.limited is not None and orbit.system.has_events:
        margins, told = there[0].margins(z), {o.name for o in observables}
        own += [margins.least(name) for name in orbit.system.margins if name not in told]
        own.append(np.nan if multipliers is None else split(multipliers))
    low, high = extremes(orbit, z)
    return [*own, *high.tolist(), *low.tolist(), *visited(orbit, z)]


def value(orbit: OrbitData, name: str, z: np.ndarray) -> float:
    """The value of one observable. z has the shape (N + 1,)."""
    own = [o for o in orbit.system.observables if o.name == name]
    if own:
        return _measured(*orbit.explicit(z), own)[0]
    states = orbit.system.state_names
    if name in quantities.every_extreme(states):
        low, high = extremes(*orbit.explicit(z))
        told = quantities.column(name, quantities.extreme_names(states), np.concatenate([high, low]))
    else:
        found = orbit.multipliers(z, orbit.linearize(z).jacobian)
        told = quantities.column(name, names(orbit), np.array(values(orbit, z, found)))
    assert told is not None, name
    return float(told)


def _measured(orbit: OrbitData, z: np.ndarray, observables: Sequence[Observable]) -> list[float]:
    """Values of some of the system's own observables; NaN of one at an event that the orbit does not meet."""
    p = ParameterValues(**orbit.values_of(z))
    whole = motion(orbit, z) if any(o.at is None for o in observables) else None
    result = []
    for o in observables:
        seen: tuple[Any, np.ndarray] | None = whole if o.at is None else at_event(orbit, z, o.at, o.side)
        if seen is None:
            result.append(float("nan"))
        else:
            result.append(measured(f"observable '{o.name}'", o.function, seen[0], seen[1], p))
    return result


def split(multipliers: np.ndarray) -> float:
    """Signed square of the smallest difference of two multipliers: negative of a complex pair.

    It is smooth where two real multipliers meet and become a pair, and passes zero there. Those that are zero
    but for errors, of what a motion forgets, are left out.

    Shape (m,).
    """
    best, finite = np.nan, multipliers[np.isfinite(multipliers) & (np.abs(multipliers) > NOTHING)]
    for k, a in enumerate(finite):
        for b in finite[k + 1 :]:
            with np.errstate(over="ignore"):
                square = (a - b) ** 2
            if (a.imag == 0.0) != (b.imag == 0.0) or (a.imag != 0.0 and b != np.conj(a)):
                continue
            if not abs(square.real) >= abs(best):
                best = float(square.real)
    return best

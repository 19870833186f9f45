"""The period of the forcing as a compiled function of the parameters, with its derivatives."""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.fields.rebind import rebound
from contwalk.fields.trace import Tracer, trace
from contwalk.flow import Field
from contwalk.problems.forcing import positive
from contwalk.problems.orbit.lifts import DIRECTIONS, lifted
from contwalk.problems.tracing import parameter_symbols
from contwalk.system import System

ORDERS = {"plain": 1, "tangent": 2, "jet": 4}
_KNOWN: dict[tuple, tuple[System, Field]] = {}


def period_map(system: System, free: str | None, change: np.ndarray, lift: str) -> Field:
    """period(p) as a map without states, whose only column is the free parameter; lifted, its derivatives
    too.

    Parameters
    ----------
    system : System
    free : str or None
        Name of the free parameter; None on a path, along which the parameters change by `change`.
    lift : str
    """
    moving = tuple(np.flatnonzero(change).tolist())
    key = id(system), free, moving, lift
    if key in _KNOWN:
        return _KNOWN[key][1]
    assert system.period is not None
    period = rebound(system.period)

    def value(tracer: Tracer) -> list[Any]:
        return [period(parameter_symbols(tracer, system.parameter_names, free, moving))]

    count = len(system.parameters)
    groups = {"l": 1, "b": count, "d": count, **dict.fromkeys(DIRECTIONS[lift], 1)}
    program = lifted(trace(value), 0, [("l", 0)], lift)
    found = Field(program, [], groups, [("l", 0)], time=("t", 0), outputs=ORDERS[lift])
    _KNOWN[key] = system, found
    return found


def period_and_slope(
    system: System,
    free: str | None,
    change: np.ndarray,
    value: float,
    given: np.ndarray,
    lift: str = "plain",
) -> tuple[float, float]:
    """The period at a value of the free parameter, and its derivative by it; of a lift, of its last output.

    Parameters
    ----------
    system : System
    free, change, lift
        As of `period_map`.
    value : float
        Of the free parameter.
    given : ndarray
        Parameters at zero, their change along a path, and directions of the lift.

    Raises
    ------
    PluginError
        If it is no positive number there.
    """
    map_ = period_map(system, free, change, lift)
    c = map_.constants(np.concatenate([[value], given]))
    values, slopes = map_(0.0, np.zeros(0), c), map_.jacobian(0.0, np.zeros(0), c)
    positive(system, float(values[0]))
    return float(values[-1]), float(slopes[-1, 0])

"""The period of the forcing as a compiled function of the parameters, with its derivatives."""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.fields.blame import first_switched
from contwalk.fields.rebind import rebound
from contwalk.fields.switching import Inputs, Switching, choices_of
from contwalk.fields.trace import Program, Tracer, trace
from contwalk.flow import Field
from contwalk.memory import memory_of, remembered
from contwalk.problems.forcing import positive
from contwalk.problems.kinks import Course, Place, inputs
from contwalk.problems.orbit.lifts import DIRECTIONS, lifted
from contwalk.problems.parameter_line import ParameterLine
from contwalk.problems.tracing import parameter_symbols
from contwalk.system import System

ORDERS = {"plain": 1, "tangent": 2, "jet": 4}
# Periods of one system, by what moves and how often they are differentiated, that are kept.
_MOST_KNOWN = 16


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

    def made() -> Field:
        groups = {**_groups(system), **dict.fromkeys(DIRECTIONS[lift], 1)}
        program = lifted(_program(system, free, moving), 0, [("l", 0)], lift)
        return Field(program, [], groups, [("l", 0)], time=("t", 0), outputs=ORDERS[lift])

    known = memory_of(system, "period maps")
    found: Field = remembered(known, (free, moving, lift), _MOST_KNOWN, made)
    return found


def _program(system: System, free: str | None, moving: tuple[int, ...]) -> Program:
    assert system.period is not None
    period = rebound(system.period)

    def value(tracer: Tracer) -> list[Any]:
        return [period(parameter_symbols(tracer, system.parameter_names, free, moving))]

    return trace(value)


def _groups(system: System) -> dict[str, int]:
    count = len(system.parameters)
    return {"l": 1, "b": count, "d": count}


def period_course(system: System, line: ParameterLine) -> Course | None:
    """The period as it is looked at for changes along a branch; None where it is smooth, or none."""
    if system.period is None:
        return None
    switching = _switching(system, line)
    if switching is None:
        return None
    period, values = rebound(system.period), np.concatenate([[0.0], line.constants])

    def evaluate(times: np.ndarray, states: np.ndarray) -> Inputs:
        return inputs(_groups(system), values, times, states)

    def where(before: Place, after: Place, /, parameters: Any) -> str:
        def written(t: Any, x: Any, p: Any, out: Any) -> None:
            out[0] = period(p)

        return first_switched(written, (0.0, [0.0]), (0.0, [0.0]), *parameters)

    def still(times: np.ndarray) -> np.ndarray:
        return np.zeros((len(times), 0))

    times = np.zeros(1)
    return Course(switching, evaluate, times, still(times), still, where, of="the period")


def _switching(system: System, line: ParameterLine) -> Switching | None:
    """Where the period is smooth by pieces only along a line; None where it is smooth."""

    def made() -> Switching | None:
        program = _program(system, line.own, line.moving)
        return Switching(program, [("l", 0)], ("t", 0)) if choices_of(program) else None

    known = memory_of(system, "choices of periods")
    found: Switching | None = remembered(known, (line.own, line.moving), _MOST_KNOWN, made)
    return found


def period_and_slope(
    system: System, free: str | None, change: np.ndarray, value: float, given: np.ndarray, lift: str = "plain"
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

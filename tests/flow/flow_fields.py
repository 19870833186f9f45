"""Small fields, compiled; and the flows of some, in closed form."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from contwalk.fields.rebind import rebound
from contwalk.fields.trace import Program, trace
from contwalk.flow import Field


def program_of(function: Callable[..., Any], states: int, parameters: int = 0) -> Program:
    """The program of `function(t, x, p)`, which returns the rates."""
    copy = rebound(function)

    def rates(tracer: Any) -> Sequence[Any]:
        x, p = np.empty(states, dtype=object), np.empty(parameters, dtype=object)
        for array, group in ((x, "x"), (p, "p")):
            for i in range(len(array)):
                array[i] = tracer.symbol(group, i)
        return copy(tracer.symbol("t", 0), x, p)

    return trace(rates)


def compiled(
    function: Callable[..., Any], states: int, parameters: int = 0, columns: Sequence[int] = ()
) -> Field:
    """A field of `function(t, x, p)`; derivatives by the parameters numbered in `columns`."""
    inputs = [("x", i) for i in range(states)]
    program = program_of(function, states, parameters)
    return Field(program, inputs, {"p": parameters}, [("p", i) for i in columns], ("t", 0))


def van_der_pol(t, x, p):
    return [x[1], p[0] * (1.0 - x[0] * x[0]) * x[1] - x[0]]


def lorenz(t, x, p):
    return [p[0] * (x[1] - x[0]), x[0] * (p[1] - x[2]) - x[1], x[0] * x[1] - p[2] * x[2]]


def forced(t, x, p):
    """From 1 at t = 0 the states go like exp(sin t) and 1 / (1 + t^2)."""
    return [x[0] * math.cos(t), -2.0 * t * x[1] * x[1]]


def forced_flow(t):
    return np.stack([np.exp(np.sin(t)), 1.0 / (1.0 + np.square(t))], axis=-1)

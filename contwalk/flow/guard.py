"""A number watched along a motion: its value, its exact rate of change, and what rounding does to it."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.fields.derivative import directional, jacobian
from contwalk.fields.expression import Graph
from contwalk.fields.llvm import Code, code_of
from contwalk.fields.machine_code import function, module
from contwalk.fields.rounding import error_bounds
from contwalk.flow.traced import PARAMETER, STATE, TIME, scalar_program
from contwalk.system import System

EPSILON = float(np.finfo(float).eps)
OUTPUTS = 3
_DIRECTIONS = {"rising": 1, "falling": -1, "both": 0}


class Guard:
    """A function h(t, x, p) with dh/dt along the flow, compiled.

    Parameters
    ----------
    system : System
    name : str
    watched : callable
        `watched(t, x, p)` gives h, as the guard of a transition does.
    direction : str
        `rising`, `falling` or `both`: which crossings of zero count.
    mode : str, optional
        Whose field moves the state; the first mode by default.

    Raises
    ------
    UnsupportedOperation
        If the function cannot be traced; the sentence names the line.
    """

    def __init__(
        self,
        system: System,
        name: str,
        watched: Callable[[Any, Any, Any], Any],
        direction: str = "both",
        mode: str | None = None,
    ) -> None:
        self.name, self.direction = name, _DIRECTIONS[direction]
        self.n, self.m = len(system.states), len(system.parameters)
        program = scalar_program(system, watched, mode)
        self._program = program.transformed(lambda outputs: self._measured(program.graph, outputs))

    def _measured(self, graph: Graph, outputs: tuple[int, ...]) -> list[int]:
        """From h and dx/dt to h, dh/dt, and how far rounding of the state and of h itself can carry h."""
        value, *rates = outputs
        states = [graph.input(STATE, i) for i in range(self.n)]
        moving = {graph.input(TIME, 0): graph.one, **dict(zip(states, rates, strict=True))}
        (rate,) = directional(graph, [value], moving)
        (bound,) = error_bounds(graph, [value])
        for i, partial in jacobian(graph, [value], states)[0].items():
            term = graph.call("abs", graph.mul(partial, states[i]))
            bound = graph.add(bound, term)
        return [value, rate, bound]

    @cached_property
    def _code(self) -> Code:
        graph = self._program.graph
        inputs = {graph.input(STATE, i): ("x", i) for i in range(self.n)}
        inputs |= {graph.input(PARAMETER, k): ("c", k) for k in range(self.m)}
        inputs[graph.input(TIME, 0)] = ("t", 0)
        return code_of(module([function("guard", self._program, ("x", "c"), inputs, time=True)]), ("guard",))

    @property
    def address(self) -> int:
        """Address of ``guard(double t, double* x, double* p, double* out)`` with `out` of length 3."""
        return self._code.addresses["guard"]

    @cached_property
    def _call(self) -> Any:
        pointers = [ctypes.c_void_p] * 3
        return self._code.function("guard", None, ctypes.c_double, *pointers)

    def __call__(self, t: float, x: np.ndarray, p: np.ndarray) -> np.ndarray:
        """h, dh/dt, and the uncertainty of h in units of h; NaN where h does not exist."""
        return self.along(np.array([t]), np.asarray(x)[None], p)[0]

    def along(self, times: np.ndarray, states: np.ndarray, p: np.ndarray) -> np.ndarray:
        """As a call, for many instants: times (k,), states (k, n) -> (k, 3)."""
        times = np.asarray(times, dtype=float)
        states = np.ascontiguousarray(states, dtype=float)
        p = np.ascontiguousarray(p, dtype=float)
        if states.shape != (len(times), self.n) or p.shape != (self.m,):
            raise ValueError(f"states {states.shape} and {p.shape} parameters for {len(times)} times")
        out = np.empty((len(times), OUTPUTS))
        state, result, width, size = states.ctypes.data, out.ctypes.data, 8 * self.n, 8 * OUTPUTS
        for k, t in enumerate(times.tolist()):
            self._call(t, state + k * width, p.ctypes.data, result + k * size)
        out[:, 2] *= EPSILON
        return out

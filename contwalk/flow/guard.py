"""A number watched along a motion: its value, its exact rate of change, and what rounding does to it."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
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
_NOISE = "noise"
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
        Whose field moves the state; the first mode by default. Its states are those that exist in it.

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
        self._states = system.states_of(mode or system.modes[0].name)
        self.n, self.m = len(self._states), len(system.parameters)
        self._traced = scalar_program(system, watched, mode)
        graph = self._traced.graph
        self._program = self._traced.transformed(lambda outputs: self._measured(graph, outputs))

    def _inputs(self, graph: Graph) -> list[int]:
        return [graph.input(STATE, i) for i in self._states]

    def _moving(self, graph: Graph, rates: Sequence[int]) -> dict[int, int]:
        """How fast each input changes along the flow."""
        return {graph.input(TIME, 0): graph.one, **dict(zip(self._inputs(graph), rates, strict=True))}

    def _measured(self, graph: Graph, outputs: tuple[int, ...]) -> list[int]:
        """From h and dx/dt to h, dh/dt, and how far rounding of the state and of h itself can carry h."""
        value, *rates = outputs
        (rate,) = directional(graph, [value], self._moving(graph, rates))
        return [value, rate, _uncertainty(graph, value, self._inputs(graph))]

    def _places(self, graph: Graph) -> dict[int, tuple[str, int]]:
        """Where compiled code finds states, parameters and the time."""
        places = {node: ("x", place) for place, node in enumerate(self._inputs(graph))}
        places |= {graph.input(PARAMETER, k): ("c", k) for k in range(self.m)}
        return places | {graph.input(TIME, 0): ("t", 0)}

    @cached_property
    def _code(self) -> Code:
        inputs = self._places(self._program.graph)
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

    # -- how it leaves zero ------------------------------------------------------------------------------

    @cached_property
    def _departing(self) -> Code:
        graph = self._traced.graph
        inputs = [graph.input(TIME, 0), *self._inputs(graph)]
        noises = [graph.input(_NOISE, place) for place in range(len(inputs))]

        def change(outputs: tuple[int, ...]) -> list[int]:
            value, *rates = outputs
            moving = self._moving(graph, rates)
            (rate,) = directional(graph, [value], moving)
            (bend,) = directional(graph, [rate], moving)
            nodes = [value, rate, bend]
            own = error_bounds(graph, nodes)
            inherited = [_inherited(graph, row, noises) for row in jacobian(graph, nodes, inputs)]
            return [node for triple in zip(nodes, own, inherited, strict=True) for node in triple]

        places = self._places(graph) | {node: ("noise", place) for place, node in enumerate(noises)}
        program, arrays = self._traced.transformed(change), ("x", "c", "noise")
        return code_of(module([function("departure", program, arrays, places, time=True)]), ("departure",))

    @property
    def departure_address(self) -> int:
        """Address of ``departure(t, x, p, noise, out)``, `out` of length 9.

        `noise` are the uncertainties of time and states. For h, its rate and its second derivative `out` has
        the value, the rounding of its own in units of the machine epsilon, and what `noise` makes of it.
        """
        return self._departing.addresses["departure"]

    @cached_property
    def _departs(self) -> Any:
        return self._departing.function("departure", None, ctypes.c_double, *[ctypes.c_void_p] * 4)

    def departure(self, t: float, x: np.ndarray, p: np.ndarray, noise: np.ndarray) -> np.ndarray:
        """h, dh/dt and its second derivative along the flow, each with its uncertainty; (3, 2).

        They tell which way the guard leaves zero. `noise`, shape (n,), are the uncertainties of the states.
        """
        state, given = np.ascontiguousarray(x, dtype=float), np.ascontiguousarray(p, dtype=float)
        known, out = np.concatenate([[EPSILON * abs(t)], noise]), np.empty((3, 3))
        if state.shape != (self.n,) or given.shape != (self.m,) or known.shape != (self.n + 1,):
            raise ValueError(f"a state {state.shape}, {noise.shape} uncertainties, {given.shape} parameters")
        self._departs(t, *(array.ctypes.data for array in (state, given, known, out)))
        return np.stack([out[:, 0], EPSILON * out[:, 1] + out[:, 2]], axis=1)


def _inherited(graph: Graph, slopes: Mapping[int, int], noises: Sequence[int]) -> int:
    """What uncertainties of its inputs make of a number."""
    total = graph.zero
    for i, partial in slopes.items():
        total = graph.add(total, graph.mul(graph.call("abs", partial), noises[i]))
    return total


def _uncertainty(graph: Graph, node: int, inputs: Sequence[int]) -> int:
    """How far rounding of itself and of its inputs carries a number, in units of the machine epsilon."""
    (bound,) = error_bounds(graph, [node])
    for i, partial in jacobian(graph, [node], inputs)[0].items():
        bound = graph.add(bound, graph.call("abs", graph.mul(partial, inputs[i])))
    return bound

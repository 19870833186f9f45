"""What is compiled of a watched function h(t, x, p): its rate along a given velocity, and its slopes.

The velocity f = dx/dt is an input. The field may take thousands of operations and a guard a dozen; whoever
moves the states has f at hand, and what is compiled of a guard serves all modes with the same states and
constants.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any
from weakref import WeakValueDictionary

from contwalk import object_cache
from contwalk.fields.derivative import directional, jacobian
from contwalk.fields.graph import Graph
from contwalk.fields.kept_kernels import generator
from contwalk.fields.llvm import Code, code_of
from contwalk.fields.machine_code import function, module
from contwalk.fields.rebind import rebound
from contwalk.fields.rounding import error_bounds
from contwalk.fields.trace import trace
from contwalk.flow.compiled.traced import PARAMETER, STATE, TIME, arguments
from contwalk.system import System

Watched = Callable[[Any, Any, Any], Any]

OUTPUTS = 3  # of `guard`

_VELOCITY = "f"
_ARRAYS = ("x", "f", "c")

# Code by its text: guards of modes with other states and constants are often the same in what they read.
_KNOWN: WeakValueDictionary[str, Code] = WeakValueDictionary()


class GuardCode:
    """A function h(t, x, p) of the states of a mode, compiled when it is first called.

    Attributes
    ----------
    n, m : int
        Numbers of states and of parameters.
    program : Program
        The function, traced.

    Raises
    ------
    UnsupportedOperation
        If the function cannot be traced; the sentence names the line.
    """

    def __init__(self, system: System, watched: Watched, mode: str) -> None:
        self._states = system.states_of(mode)
        self.n, self.m = len(self._states), len(system.parameters)
        copy = rebound(watched)
        self.program = trace(lambda tracer: [copy(*arguments(tracer, system, mode))])
        graph = self.program.graph
        # What the graph is now decides all that is derived from it; later it grows by what is derived.
        self._size = len(graph.nodes), len(graph.tables)

    @cached_property
    def of_time_alone(self) -> bool:
        """Whether it reads the time and no state."""
        return self.program.reads(TIME) and not self.program.reads(STATE)

    @property
    def address(self) -> int:
        """Address of ``guard(double t, double* x, double* f, double* p, double* out)``.

        `out`, of length 3: h, h_t + h_x f, and how far rounding of the state and of h itself can carry h, in
        units of the machine epsilon.
        """
        return self.guard.addresses["guard"]

    @property
    def slopes_address(self) -> int:
        """Address of ``slopes(t, x, f, p, out)``.

        `out`, of length 2 + 2 (1 + n): h; its own rounding in units of the machine epsilon; the derivatives
        of h by time and states; how fast these change as time and states do, at the rates 1 and f.
        """
        return self.slopes.addresses["slopes"]

    @cached_property
    def guard(self) -> Code:
        """The function `guard`."""
        graph = self.program.graph
        moving = self._moving(graph)

        def measured(outputs: tuple[int, ...]) -> list[int]:
            (rate,) = directional(graph, outputs, moving)
            return [outputs[0], rate, _uncertainty(graph, outputs[0], self._inputs(graph)[1:])]

        return self._compiled("guard", measured)

    @cached_property
    def slopes(self) -> Code:
        """The function `slopes`."""
        graph = self.program.graph
        inputs, moving = self._inputs(graph), self._moving(graph)

        def sloping(outputs: tuple[int, ...]) -> list[int]:
            (row,) = jacobian(graph, outputs, inputs)
            gradient = [row.get(i, graph.zero) for i in range(len(inputs))]
            return [*outputs, *error_bounds(graph, outputs), *gradient, *directional(graph, gradient, moving)]

        return self._compiled("slopes", sloping)

    def _inputs(self, graph: Graph) -> list[int]:
        """Time, then the states."""
        return [graph.input(TIME, 0), *(graph.input(STATE, i) for i in self._states)]

    def _moving(self, graph: Graph) -> dict[int, int]:
        """How fast each input changes along the flow."""
        rates = [graph.one, *(graph.input(_VELOCITY, place) for place in range(self.n))]
        return dict(zip(self._inputs(graph), rates, strict=True))

    def _compiled(self, name: str, change: Callable[[tuple[int, ...]], Sequence[int]]) -> Code:
        text = self._kept_text(name, lambda: self._text(name, change))
        code = _KNOWN.get(text)
        if code is None:
            code = _KNOWN[text] = code_of(text, (name,))
        return code

    def _kept_text(self, name: str, derive: Callable[[], str]) -> str:
        """The text of a function, from an earlier process if one has derived it from the same graph."""
        graph, (nodes, tables) = self.program.graph, self._size
        described = graph.nodes[:nodes], graph.tables[:tables], self.program.tree, self._states, self.m
        key = object_cache.key("guard", name, sys.version, generator(__name__), repr(described))
        kept = object_cache.load_values(key)
        if kept is not None and len(kept) == 1 and isinstance(kept[0], str):
            return kept[0]
        text = derive()
        object_cache.store_values(key, [text])
        return text

    def _text(self, name: str, change: Callable[[tuple[int, ...]], Sequence[int]]) -> str:
        """LLVM IR of a function whose outputs are those that `change` makes of the guard."""
        program = self.program.transformed(change)
        time, *states = self._inputs(program.graph)
        places = {time: ("t", 0), **{node: ("x", place) for place, node in enumerate(states)}}
        places |= {program.graph.input(_VELOCITY, place): ("f", place) for place in range(self.n)}
        places |= {program.graph.input(PARAMETER, k): ("c", k) for k in range(self.m)}
        return module([function(name, program, _ARRAYS, places, time=True)])


class GuardCodes:
    """The guards of a system, each function once for all modes of the same states and constants."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._known: dict[tuple[object, ...], GuardCode] = {}

    def __call__(self, watched: Watched, mode: str) -> GuardCode:
        """The code of a function of the system."""
        # The system keeps its functions, and so their ids.
        constants = tuple(self._system.mode(mode).constants.items())
        key = id(watched), tuple(self._system.states_of(mode)), constants
        if key not in self._known:
            self._known[key] = GuardCode(self._system, watched, mode)
        return self._known[key]


def _uncertainty(graph: Graph, node: int, states: Sequence[int]) -> int:
    """How far rounding of itself and of the states carries a number, in units of the machine epsilon."""
    (bound,) = error_bounds(graph, [node])
    for i, partial in jacobian(graph, [node], states)[0].items():
        bound = graph.add(bound, graph.call("abs", graph.mul(partial, states[i])))
    return bound

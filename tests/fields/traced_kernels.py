"""From a function of a few numbers to kernels of its value and its derivatives."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from contwalk.fields.derivative import directional
from contwalk.fields.kernel import Kernel
from contwalk.fields.rebind import rebound
from contwalk.fields.rounding import error_bounds
from contwalk.fields.trace import Program, trace


def program_of(function: Callable[..., Any], inputs: int) -> Program:
    """The program of `function(x)`, x an array of `inputs` symbols; it returns a number or a sequence."""
    copy = rebound(function)

    def results(tracer: Any) -> list[Any]:
        x = np.empty(inputs, dtype=object)
        for i in range(inputs):
            x[i] = tracer.symbol("u", i)
        found = copy(x)
        return list(found) if hasattr(found, "__len__") else [found]

    return trace(results)


def kernel_of(function: Callable[..., Any], inputs: int) -> Kernel:
    return Kernel(program_of(function, inputs), ("u",))


def derivative_of(function: Callable[..., Any], inputs: int, orders: tuple[int, ...]) -> Kernel:
    """The mixed partial derivative by the inputs numbered in `orders`, one after the other."""
    program = program_of(function, inputs)
    graph = program.graph
    nodes = [graph.input("u", i) for i in range(inputs)]

    def change(outputs: tuple[int, ...]) -> list[int]:
        found = list(outputs)
        for i in orders:
            found = directional(graph, found, {nodes[i]: graph.one})
        return found

    return Kernel(program.transformed(change), ("u",))


def bounds_of(function: Callable[..., Any], inputs: int) -> Kernel:
    """Rounding error bounds of the outputs, in units of the machine epsilon."""
    program = program_of(function, inputs)
    return Kernel(program.transformed(lambda o: error_bounds(program.graph, o)), ("u",))

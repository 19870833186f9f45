"""Derivatives of a guard by time along the motion, of any order: h, L h, L L h, .. with L = d/dt + f d/dx.

They are asked for where a guard, its rate and its second derivative are zero, as where a mass that sticks is
released: its speed and its acceleration are zero then by definition. Each is a graph of its own, larger than
the one before, and is evaluated as generated Python, with a running bound of its rounding.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from contwalk.fields.derivative import directional, jacobian
from contwalk.fields.kernel import Kernel
from contwalk.fields.rebind import rebound
from contwalk.fields.rounding import error_bounds
from contwalk.fields.trace import trace
from contwalk.flow.compiled.traced import PARAMETER, STATE, TIME, arguments, rates
from contwalk.system import System

EPSILON = float(np.finfo(float).eps)
# Beyond this order, or where a graph is larger, a guard that is zero so far is taken to stay zero.
MOST_ORDER, MOST_NODES = 8, 200_000


class Derivatives:
    """Those of a function h(t, x, p) in one mode of a system, made when they are asked for.

    Parameters
    ----------
    system : System
    guard : callable
    mode : str
    """

    def __init__(self, system: System, guard: Callable[..., Any], mode: str) -> None:
        own, field = rebound(guard), rebound(system.mode(mode).field)
        self._states = system.states_of(mode)
        self._program = trace(
            lambda tracer: [own(*arguments(tracer, system, mode)), *rates(tracer, system, field, mode)]
        )
        self._kernels: dict[int, Kernel] = {}

    def side_from_third(
        self, t: float, x: np.ndarray, p: np.ndarray, noise: np.ndarray, factor: float
    ) -> int:
        """The sign of the first derivative from the third on that is not zero; 0 if there is none.

        Parameters
        ----------
        t, x
            Time, and a full-length state.
        p : ndarray
        noise : ndarray, shape (1 + n,)
            Uncertainties of the time and of the states of the mode.
        factor : float
            What is not more than so many of its uncertainties is zero.
        """
        for value, off in self._from_third(t, x, p, noise):
            if abs(value) > factor * off:
                return 1 if value > 0.0 else -1
        return 0

    def _from_third(
        self, t: float, x: np.ndarray, p: np.ndarray, noise: np.ndarray
    ) -> Iterator[tuple[float, float]]:
        """The third derivative, the fourth, .., each with its uncertainty."""
        for order in range(3, MOST_ORDER + 1):
            if len(self._program.graph.nodes) > MOST_NODES:
                return
            value, rounding, *slopes = self._kernel(order)([t], x, p)
            inherited = float(np.abs(slopes) @ noise)
            yield float(value), EPSILON * float(rounding) + inherited

    def _kernel(self, order: int) -> Kernel:
        """Of the derivative of an order: itself, its rounding in units of the machine epsilon, its slopes."""
        if order not in self._kernels:
            graph = self._program.graph
            inputs = [graph.input(TIME, 0), *(graph.input(STATE, i) for i in self._states)]

            def derivative(outputs: tuple[int, ...]) -> list[int]:
                value, *field = outputs
                moving = dict(zip(inputs, [graph.one, *field], strict=True))
                for _ in range(order):
                    (value,) = directional(graph, [value], moving)
                (row,) = jacobian(graph, [value], inputs)
                slopes = [row.get(k, graph.zero) for k in range(len(inputs))]
                return [value, *error_bounds(graph, [value]), *slopes]

            program = self._program.transformed(derivative)
            self._kernels[order] = Kernel(program, (TIME, STATE, PARAMETER), shape=(2 + len(inputs),))
        return self._kernels[order]

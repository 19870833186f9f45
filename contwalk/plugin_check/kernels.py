"""Values, derivatives and rounding errors of a program, each made callable when it is first asked for."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from contwalk.errors import PluginError
from contwalk.fields.derivative import jacobian
from contwalk.fields.kernel import Kernel
from contwalk.fields.rounding import error_bounds
from contwalk.fields.trace import Program

# The time, the states, the parameters, and the constants of a mode where they are inputs.
GROUPS = ("t", "x", "p", "m")


class Kernels:
    """A program in t, x, p and a mode's constants.

    Parameters
    ----------
    program : Program
        With m outputs.
    outputs, states : int
        m and n.
    """

    def __init__(self, program: Program, outputs: int, states: int) -> None:
        self._program, self._outputs, self._states = program, outputs, states

    def values(
        self, t: float, x: np.ndarray, parameters: Sequence[float], constants: Sequence[float]
    ) -> np.ndarray:
        """Outputs, shape (m,); NaN where there are none."""
        return _evaluated(self._value, t, x, parameters, constants)

    def slopes(
        self, t: float, x: np.ndarray, parameters: Sequence[float], constants: Sequence[float]
    ) -> np.ndarray:
        """Their exact derivatives by t (column 0) and the states, shape (m, n + 1)."""
        return _evaluated(self._slope, t, x, parameters, constants)

    def roundings(
        self, t: float, x: np.ndarray, parameters: Sequence[float], constants: Sequence[float]
    ) -> np.ndarray:
        """Bounds of their rounding errors, in units of the machine epsilon, shape (m,)."""
        return _evaluated(self._rounding, t, x, parameters, constants)

    @cached_property
    def _value(self) -> Kernel:
        return Kernel(self._program, GROUPS, (self._outputs,))

    @cached_property
    def _rounding(self) -> Kernel:
        graph = self._program.graph
        program = self._program.transformed(lambda outputs: error_bounds(graph, outputs))
        return Kernel(program, GROUPS, (self._outputs,))

    @cached_property
    def _slope(self) -> Kernel:
        graph = self._program.graph
        inputs = [graph.input("t", 0), *(graph.input("x", i) for i in range(self._states))]

        def change(outputs: tuple[int, ...]) -> list[int]:
            rows = jacobian(graph, outputs, inputs)
            return [row.get(k, graph.zero) for row in rows for k in range(len(inputs))]

        return Kernel(self._program.transformed(change), GROUPS, (self._outputs, len(inputs)))


def _evaluated(
    kernel: Kernel, t: float, x: np.ndarray, parameters: Sequence[float], constants: Sequence[float]
) -> np.ndarray:
    try:
        return np.asarray(kernel([float(t)], x.tolist(), parameters, constants), dtype=float)
    except PluginError:
        return np.full(kernel.shape or (), np.nan)

"""The plugin's functions with their derivatives by the time, the states and the free parameters."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from contwalk.branch import BranchInfo
from contwalk.fields.rebind import rebound
from contwalk.fields.trace import Outputs, Tracer, trace
from contwalk.flow.compiled.field import Field
from contwalk.flow.compiled.traced import PARAMETER, STATE, TIME, arguments, rates
from contwalk.memory import memory_of, remembered
from contwalk.system import Neutral, System, Transition

# rhs_jac(t, x, c, out): see `CompiledField`; the time is the first input here.
_CALL = ctypes.CFUNCTYPE(None, ctypes.c_double, *[ctypes.c_void_p] * 3)
# What is kept of one system: a function of each kind, mode and transition, for each set of free parameters.
_MOST_KEPT = 256


class Parameters:
    """All parameters as an affine function of the free ones.

    Parameters
    ----------
    system : System
    info : BranchInfo
        Of a path `free` is the coordinate along it.
    """

    def __init__(self, system: System, info: BranchInfo) -> None:
        self.names, self.free = system.parameter_names, info.free
        base = np.array([float(info.parameters[name]) for name in self.names])
        path = info.settings.get("path")
        self.slopes = np.zeros((len(self.names), len(self.free)))
        if path is None:
            places = [self.names.index(name) for name in self.free]
            base[places], self.slopes[places, range(len(places))] = 0.0, 1.0
        else:
            begin, end = (np.array([float(ends[name]) for name in self.names]) for ends in path)
            base, self.slopes[:, 0] = begin, np.nan_to_num(end - begin)
        self.base = base
        self.moving = tuple(np.flatnonzero(self.slopes.any(axis=1)).tolist())

    def at(self, free: np.ndarray) -> np.ndarray:
        """All parameters, shape (p,), where the free ones, (k,), have these values."""
        return self.base + self.slopes @ free

    def by_name(self, free: np.ndarray) -> dict[str, float]:
        """All parameters by name, where the free ones, (k,), have these values."""
        return dict(zip(self.names, self.at(free).tolist(), strict=True))


class Function:
    """A function of time, states and parameters, of shape (m,), with exact derivatives.

    The derivatives, shape (m, 1 + n + k), are by the time, the n states of a mode, and the k free parameters.
    """

    def __init__(self, field: Field, parameters: Parameters) -> None:
        self.m, self.n = field.m, field.n - 1
        self._field, self._slopes = field, parameters.slopes[list(parameters.moving)]
        self._plain = np.array_equal(self._slopes, np.eye(len(self._slopes)))
        self._call = _CALL(field.rhs_jac_address)
        self._given, self._constants = b"", np.empty(0)
        self._inputs, self._outputs = np.zeros(1 + self.n), np.zeros(field.m + len(field.col))
        self._matrix = np.zeros(field.m * (field.n + field.k))
        rows = np.repeat(np.arange(field.m), np.diff(field.row_ptr))
        self._entries = rows * (field.n + field.k) + field.col
        self._addresses = self._inputs.ctypes.data, self._outputs.ctypes.data

    def at(self, p: np.ndarray) -> None:
        """Take parameters, shape (p,), for what is asked from here on."""
        if p.tobytes() != self._given:
            self._given, self._constants = p.tobytes(), self._field.constants(p)

    def linear(self, t: float, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Value and derivatives at a time and states (n,), in memory that the next call overwrites."""
        self._inputs[0], self._inputs[1:] = t, x
        self._call(0.0, self._addresses[0], self._constants.ctypes.data, self._addresses[1])
        self._matrix[self._entries] = self._outputs[self.m :]
        moved = self._matrix.reshape(self.m, -1)
        if not self._plain:
            moved = np.hstack([moved[:, : 1 + self.n], moved[:, 1 + self.n :] @ self._slopes])
        return self._outputs[: self.m], moved

    def __call__(self, t: float, x: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Value and derivatives at a time, states (n,) and parameters (p,)."""
        self.at(p)
        value, moved = self.linear(t, x)
        return value.copy(), moved.copy()


class Functions:
    """Those of one system, compiled when they are first asked for."""

    def __init__(self, system: System, parameters: Parameters) -> None:
        self.system, self.parameters = system, parameters
        # Of the motion that took most right-hand sides: these, its duration and its tolerance.
        self.taken: tuple[int, float, float] | None = None
        self.switches = 0  # changes of modes
        self._known: dict[tuple, Function] = {}

    def field(self, mode: str) -> Function:
        """The vector field of a mode, in the states that exist there."""
        own = self.system.mode(mode).field
        return self._made(("field",), mode, lambda tracer: rates(tracer, self.system, rebound(own), mode))

    def number(self, key: tuple[str, ...], mode: str, function: Callable[..., Any]) -> Function:
        """A number of the plugin at a state of a mode, shape (1,); `key` tells it from others."""
        return self._made(
            key, mode, lambda tracer: [rebound(function)(*arguments(tracer, self.system, mode))]
        )

    def guard(self, transition: Transition) -> Function:
        """The guard of a transition, shape (1,), in the states of its source."""
        return self.number(("guard", transition.name), transition.source, transition.guard)

    def jump(self, transition: Transition | None, mode: str, target: str, image: str, power: int) -> Function:
        """What a leg's end becomes: reset, relabelling, and the image where the closure ends.

        Without a transition it stays as it is.
        """
        reset, relabel = (None, None) if transition is None else (transition.reset, transition.relabel)
        maps = [reset, self._symmetry(relabel), *[self._symmetry(image)] * power]

        def after(tracer: Tracer) -> list[Any]:
            t, x, p = arguments(tracer, self.system, mode)
            for each in maps:
                x = x if each is None else _written(rebound(each), t, x, p)
            return [x[i] for i in self.system.states_of(target)]

        name = "" if transition is None else transition.name
        return self._made(("jump", name, target, image, power), mode, after)

    def generator(self, neutral: Neutral, mode: str) -> Function:
        """A neutral direction at a state of a mode, shape (n,)."""

        def along(tracer: Tracer) -> list[Any]:
            v = _written(rebound(neutral.generator), *arguments(tracer, self.system, mode))
            return [v[i] for i in self.system.states_of(mode)]

        return self._made(("generator", neutral.name), mode, along)

    def _symmetry(self, name: str | None) -> Callable[..., None] | None:
        return self.system.symmetry(name).map if name else None

    def _made(self, key: tuple, mode: str, made: Callable[[Tracer], Sequence[Any]]) -> Function:
        whole = (*key, mode, self.parameters.moving)

        def compiled() -> Field:
            program, system = trace(made), self.system
            inputs = [(TIME, 0), *((STATE, i) for i in system.states_of(mode))]
            columns = [(PARAMETER, k) for k in self.parameters.moving]
            count = next(len(leaf.nodes) for leaf in program.leaves() if isinstance(leaf, Outputs))
            return Field(program, inputs, {PARAMETER: len(self.parameters.names)}, columns, outputs=count)

        if whole not in self._known:
            kept = memory_of(self.system, "verified functions")
            self._known[whole] = Function(remembered(kept, whole, _MOST_KEPT, compiled), self.parameters)
        return self._known[whole]


def _written(function: Callable[..., None], t: Any, x: np.ndarray, p: Any) -> np.ndarray:
    """What a map of the states writes; what it does not write is zero."""
    result = np.full(len(x), 0.0, dtype=object)
    function(t, x, p, result)
    return result

"""A number watched along a motion: its value, its exact rate of change, and what rounding does to it."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.flow.compiled.compiled_field import CompiledField
from contwalk.flow.compiled.traced import field_of
from contwalk.flow.events.guard_code import OUTPUTS, GuardCode
from contwalk.system import System

EPSILON = float(np.finfo(float).eps)
# Roundings of the time within which a sawtooth of it may begin anew: where a motion begins, what follows
# counts.
JUST_AFTER = 4.0
_DIRECTIONS = {"rising": 1, "falling": -1, "both": 0}


@dataclass(frozen=True, eq=False)
class Slopes:
    """A guard at an instant, with its derivatives.

    Parameters
    ----------
    value : float
    rounding : float
        How far its own operations can carry the value.
    gradient : ndarray, shape (1 + n,)
        Derivatives by time and states.
    change : ndarray, shape (1 + n,)
        How fast these change along the motion.
    """

    value: float
    rounding: float
    gradient: np.ndarray
    change: np.ndarray


def just_after(t: float) -> float:
    """The instant at which guards are asked where a motion begins."""
    return t + JUST_AFTER * EPSILON * abs(t)


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
    code, field : optional
        The function as compiled for the mode, and the mode's field, if these are there already.

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
        *,
        code: GuardCode | None = None,
        field: CompiledField | None = None,
    ) -> None:
        self.name, self.direction = name, _DIRECTIONS[direction]
        self._system, self._mode = system, mode or system.modes[0].name
        self.code = code or GuardCode(system, watched, self._mode)
        self.n, self.m, self._given = self.code.n, self.code.m, field

    @cached_property
    def field(self) -> CompiledField:
        """What moves the states."""
        return self._given or field_of(self._system, self._mode)

    @property
    def address(self) -> int:
        """Address of the compiled function; see `GuardCode`."""
        return self.code.address

    @property
    def slopes_address(self) -> int:
        """Address of what gives its derivatives too; see `GuardCode`."""
        return self.code.slopes_address

    @cached_property
    def _call(self) -> Any:
        return self.code.guard.function("guard", None, ctypes.c_double, *[ctypes.c_void_p] * 4)

    @cached_property
    def _call_slopes(self) -> Any:
        return self.code.slopes.function("slopes", None, ctypes.c_double, *[ctypes.c_void_p] * 4)

    def __call__(self, t: float, x: np.ndarray, p: np.ndarray) -> np.ndarray:
        """h, dh/dt, and the uncertainty of h in units of h; NaN where h does not exist."""
        return self.along(np.array([t]), np.asarray(x)[None], p)[0]

    def along(
        self, times: np.ndarray, states: np.ndarray, p: np.ndarray, velocities: np.ndarray | None = None
    ) -> np.ndarray:
        """As a call, for many instants: times (k,), states (k, n) -> (k, 3).

        `velocities`, shape (k, n), are those of the states, where the caller knows them.
        """
        times = np.asarray(times, dtype=float)
        states = np.ascontiguousarray(states, dtype=float)
        p = np.ascontiguousarray(p, dtype=float)
        if states.shape != (len(times), self.n) or p.shape != (self.m,):
            raise ValueError(f"states {states.shape} and {p.shape} parameters for {len(times)} times")
        if velocities is None:
            velocities = self.field.along(times, states, self.field.constants(p))
        speeds = np.ascontiguousarray(velocities, dtype=float)
        if speeds.shape != states.shape:
            raise ValueError(f"velocities {speeds.shape} of states {states.shape}")
        out = np.empty((len(times), OUTPUTS))
        state, speed, result = states.ctypes.data, speeds.ctypes.data, out.ctypes.data
        given, width, size = p.ctypes.data, 8 * self.n, 8 * OUTPUTS
        for k, t in enumerate(times.tolist()):
            self._call(t, state + k * width, speed + k * width, given, result + k * size)
        out[:, 2] *= EPSILON
        return out

    def slopes(self, t: float, x: np.ndarray, p: np.ndarray, velocity: np.ndarray) -> Slopes:
        """It with its derivatives, at a state, shape (n,), that moves with this velocity, shape (n,)."""
        arrays = [np.ascontiguousarray(array, dtype=float) for array in (x, velocity, p)]
        if [array.shape for array in arrays] != [(self.n,), (self.n,), (self.m,)]:
            shapes = ", ".join(str(array.shape) for array in arrays)
            raise ValueError(f"a state, a velocity and parameters of shapes {shapes}")
        out = np.empty(2 + 2 * (1 + self.n))
        self._call_slopes(t, *(array.ctypes.data for array in (*arrays, out)))
        gradient, change = out[2:].reshape(2, 1 + self.n)
        return Slopes(float(out[0]), EPSILON * float(out[1]), gradient, change)

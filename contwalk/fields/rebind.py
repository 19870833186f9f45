"""Calling a plugin's function with stand-ins for numbers.

`math.cos` refuses anything but floats. So the function is copied, and in the copy the names `math`, `numpy`,
their functions, and `min`, `max`, `float`, `abs` mean versions that understand `Number`; helper functions
that it calls are copied in the same way. The plugin itself is left as it is.
"""

from __future__ import annotations

import builtins
import functools
import math
import types
from collections.abc import Callable
from typing import Any

import numpy as np

from contwalk.errors import UnsupportedOperation
from contwalk.fields.functions import FUNCTIONS, Number
from contwalk.python_functions import PlainModule, copied, original


def dispatch(name: str, arguments: tuple[Any, ...]) -> Any:
    """A function of `FUNCTIONS` for numbers, stand-ins, or arrays of them."""
    for argument in arguments:
        if isinstance(argument, Number):
            return argument.apply(name, arguments)
    if any(isinstance(a, np.ndarray | list | tuple) for a in arguments):
        arrays = np.broadcast_arrays(*[np.asarray(a, dtype=object) for a in arguments])
        result = np.empty(arrays[0].shape, dtype=object)
        for index in np.ndindex(result.shape):
            result[index] = dispatch(name, tuple(a[index] for a in arrays))
        return result
    return FUNCTIONS[name].of_float(*arguments)


def _function(name: str) -> Callable[..., Any]:
    return lambda *arguments: dispatch(name, arguments)


def _log(x: Any, base: Any = None) -> Any:
    natural = dispatch("log", (x,))
    return natural if base is None else natural / dispatch("log", (base,))


def _extreme(name: str) -> Callable[..., Any]:
    def extreme(*arguments: Any, **options: Any) -> Any:
        values = list(arguments[0]) if len(arguments) == 1 else list(arguments)
        if options or not any(isinstance(v, Number) for v in values):
            return getattr(builtins, name)(*arguments, **options)
        return functools.reduce(lambda a, b: dispatch(name, (a, b)), values)

    return extreme


def _hypot(*arguments: Any) -> Any:
    return functools.reduce(lambda a, b: dispatch("hypot", (a, b)), arguments)


def _float(value: Any = 0.0) -> Any:
    return value if isinstance(value, Number) else float(value)


def _degrees(x: Any) -> Any:
    return x * (180.0 / math.pi)


def _radians(x: Any) -> Any:
    return x * (math.pi / 180.0)


def _copysign(x: Any, y: Any) -> Any:
    return dispatch("abs", (x,)) * dispatch("sign", (y,))


def _where(condition: Any, a: Any, b: Any) -> Any:
    if isinstance(condition, Number):
        return condition.select(a, b)  # type: ignore[attr-defined]
    if np.ndim(condition) == 0:
        return a if condition else b
    conditions, first, second = np.broadcast_arrays(
        np.asarray(condition, dtype=object), np.asarray(a, dtype=object), np.asarray(b, dtype=object)
    )
    result = np.empty(conditions.shape, dtype=object)
    for index in np.ndindex(result.shape):
        result[index] = _where(conditions[index], first[index], second[index])
    return result


def _filled(value: float) -> Callable[..., np.ndarray]:
    def filled(shape: Any, *_: Any, **__: Any) -> np.ndarray:
        return np.full(shape, value, dtype=object)

    return filled


def _like(value: float) -> Callable[..., np.ndarray]:
    return lambda array, *_, **__: np.full(np.shape(array), value, dtype=object)


def _array(values: Any, *_: Any, **__: Any) -> np.ndarray:
    return np.array(values, dtype=object)


_MATH = {name: _function(name) for name in FUNCTIONS if hasattr(math, name)}
_MATH |= {
    "log": _log,
    "fabs": _function("abs"),
    "hypot": _hypot,
    "degrees": _degrees,
    "radians": _radians,
    "copysign": _copysign,
}
_NUMPY = {name: _function(name) for name in FUNCTIONS if isinstance(getattr(np, name, None), np.ufunc)}
_NUMPY |= {
    "arcsin": _function("asin"),
    "arccos": _function("acos"),
    "arctan": _function("atan"),
    "arctan2": _function("atan2"),
    "arcsinh": _function("asinh"),
    "arccosh": _function("acosh"),
    "arctanh": _function("atanh"),
    "power": _function("pow"),
    "abs": _function("abs"),
    "absolute": _function("abs"),
    "fabs": _function("abs"),
    "minimum": _function("min"),
    "maximum": _function("max"),
    "copysign": _copysign,
    "degrees": _degrees,
    "rad2deg": _degrees,
    "radians": _radians,
    "deg2rad": _radians,
    "where": _where,
    "logical_and": lambda a, b: (a != 0) & (b != 0),
    "logical_or": lambda a, b: (a != 0) | (b != 0),
    "logical_not": lambda a: a == 0,
    "zeros": _filled(0.0),
    "empty": _filled(0.0),
    "ones": _filled(1.0),
    "zeros_like": _like(0.0),
    "empty_like": _like(0.0),
    "ones_like": _like(1.0),
    "array": _array,
    "asarray": _array,
}
_BUILTINS = {"min": _extreme("min"), "max": _extreme("max"), "float": _float}


class _Module(PlainModule):
    """A module whose functions understand stand-ins for numbers."""

    def __init__(self, module: types.ModuleType, replaced: dict[str, Any], memo: dict[int, Any]) -> None:
        super().__init__(module, _stand_in, memo)
        self._replaced = replaced

    def __getattr__(self, name: str) -> Any:
        return self._replaced[name] if name in self._replaced else super().__getattr__(name)


def _unsupported_ufunc(ufunc: np.ufunc) -> Callable[..., Any]:
    def call(*arguments: Any, **options: Any) -> Any:
        if any(isinstance(a, Number) for a in arguments):
            raise UnsupportedOperation(
                f"numpy.{ufunc.__name__} cannot be differentiated here.",
                f"Use arithmetic or one of: {', '.join(sorted(FUNCTIONS))}.",
            )
        return ufunc(*arguments, **options)

    return call


def _stand_in(value: Any, memo: dict[int, Any]) -> Any:
    """What a name of the plugin means in the copy."""
    if isinstance(value, types.ModuleType):
        if value is math:
            return _Module(value, _MATH, memo)
        if value is np:
            return _Module(value, _NUMPY, memo)
        return _Module(value, {}, memo) if hasattr(value, "__file__") else value
    value = original(value)
    if isinstance(value, types.FunctionType):
        return _symbolic(value, memo)
    if isinstance(value, functools.partial):
        return functools.partial(_stand_in(value.func, memo), *value.args, **value.keywords)
    name = getattr(value, "__name__", None)
    if isinstance(value, np.ufunc):
        return _NUMPY.get(str(name)) or _unsupported_ufunc(value)
    if isinstance(value, types.BuiltinFunctionType) and getattr(value, "__module__", "") == "math":
        return _MATH.get(str(name), value)
    return value


def rebound(function: Callable[..., Any]) -> Callable[..., Any]:
    """A copy of `function` that understands stand-ins for numbers.

    Time and state, its first two arguments, are handed over as copies: what it changes in them is its own.

    Parameters
    ----------
    function : callable
        A plain Python function, a closure, a lambda, a `functools.partial` or a numba function.
    """
    copy = _stand_in(function, {})

    def call(*arguments: Any) -> Any:
        own = [a.copy() if isinstance(a, np.ndarray) else a for a in arguments[:2]]
        return copy(*own, *arguments[2:])

    return call


def _symbolic(function: types.FunctionType, memo: dict[int, Any]) -> Callable[..., Any]:
    if (getattr(function, "__module__", None) or "").split(".")[0] == "numpy":
        return function  # numpy's own Python functions work on arrays of stand-ins as they are
    return copied(function, _stand_in, memo, _BUILTINS)

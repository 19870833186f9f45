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


class _Module:
    """A module whose functions understand stand-ins for numbers."""

    def __init__(self, module: types.ModuleType, replaced: dict[str, Any], memo: dict[int, Any]) -> None:
        self._module, self._replaced, self._memo = module, replaced, memo

    def __getattr__(self, name: str) -> Any:
        if name in self._replaced:
            return self._replaced[name]
        return _stand_in(getattr(self._module, name), self._memo)


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
    value = getattr(value, "py_func", value)  # a numba function: its Python original
    if isinstance(value, types.FunctionType):
        return rebound(value, memo)
    if isinstance(value, functools.partial):
        return functools.partial(_stand_in(value.func, memo), *value.args, **value.keywords)
    name = getattr(value, "__name__", None)
    if isinstance(value, np.ufunc):
        return _NUMPY.get(str(name)) or _unsupported_ufunc(value)
    if isinstance(value, types.BuiltinFunctionType) and getattr(value, "__module__", "") == "math":
        return _MATH.get(str(name), value)
    return value


def rebound(function: Callable[..., Any], memo: dict[int, Any] | None = None) -> Callable[..., Any]:
    """A copy of `function` that understands stand-ins for numbers.

    Parameters
    ----------
    function : callable
        A plain Python function, a closure, a lambda, a `functools.partial` or a numba function.
    """
    memo = {} if memo is None else memo
    function = getattr(function, "py_func", function)
    if not isinstance(function, types.FunctionType):
        return _stand_in(function, memo) if isinstance(function, functools.partial) else function
    if id(function) in memo:
        return memo[id(function)]
    if (getattr(function, "__module__", None) or "").split(".")[0] == "numpy":
        return function  # numpy's own Python functions work on arrays of stand-ins as they are
    names = {**function.__globals__, "__builtins__": {**vars(builtins), **_BUILTINS}}
    cells = tuple(types.CellType() for _ in function.__closure__ or ())
    copy = types.FunctionType(function.__code__, names, function.__name__, function.__defaults__, cells)
    copy.__kwdefaults__ = function.__kwdefaults__
    memo[id(function)] = copy
    for name in _names_used(function.__code__):
        if name in function.__globals__:
            names[name] = _stand_in(function.__globals__[name], memo)
    for cell, original in zip(cells, function.__closure__ or (), strict=True):
        cell.cell_contents = _stand_in(original.cell_contents, memo)
    return copy


def _names_used(code: types.CodeType) -> set[str]:
    used = set(code.co_names)
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            used |= _names_used(constant)
    return used

"""Calling a plugin's function with stand-ins for numbers.

`math.cos` refuses anything but floats. So the function is copied, and in the copy the names `math`, `numpy`,
their functions, and `min`, `max`, `float`, `abs` mean versions that understand `Number`; helper functions
that it calls are copied in the same way. The plugin itself is left as it is.
"""

from __future__ import annotations

import builtins
import functools
import math
import operator
import sys
import types
from collections.abc import Callable
from typing import Any

import numpy as np

from contwalk.errors import UnsupportedOperation
from contwalk.fields.array_functions import (
    angles,
    clip,
    conjugate,
    expit,
    heaviside,
    imag,
    logaddexp,
    real,
    rounded_up,
    sinc,
)
from contwalk.fields.complex_numbers import made
from contwalk.fields.dispatch import dispatch, symbolic, where
from contwalk.fields.functions import FUNCTIONS, IMAGINARY_PART, Number
from contwalk.fields.linear_algebra import det, inv, solve, solve_by_scipy
from contwalk.fields.refusals import LINEAR_ALGEBRA, ROUNDED, refusal, refusals
from contwalk.fields.tables import Spline, interp, is_spline
from contwalk.python_functions import PlainModule, copied, names_used, original


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


def _whole(dtype: Any) -> bool:
    """Whether an array of this type cuts what is written into it."""
    return dtype is not None and np.dtype(dtype).kind in "iub"


def _filled(value: float) -> Callable[..., np.ndarray]:
    def filled(shape: Any, dtype: Any = None, *_: Any, **__: Any) -> np.ndarray:
        return np.full(shape, value, dtype=dtype if _whole(dtype) else object)

    return filled


def _like(value: float) -> Callable[..., np.ndarray]:
    def filled(array: Any, dtype: Any = None, *_: Any, **__: Any) -> np.ndarray:
        own = dtype if dtype is not None else getattr(array, "dtype", np.asarray(array).dtype)
        return np.full(np.shape(array), value, dtype=own if _whole(own) else object)

    return filled


def _array(values: Any, dtype: Any = None, *_: Any, **__: Any) -> np.ndarray:
    if _whole(dtype) or (dtype is None and not symbolic(values) and np.asarray(values).dtype.kind in "iub"):
        return np.array(values, dtype=dtype)
    return np.array(values, dtype=object)


_MATH = {name: _function(name) for name in FUNCTIONS if hasattr(math, name)}
_MATH |= {
    "log": _log,
    "fabs": _function("abs"),
    "hypot": _hypot,
    "degrees": _degrees,
    "radians": _radians,
    "copysign": _copysign,
    "ceil": rounded_up,
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
    "exp2": lambda x: dispatch("pow", (2.0, x)),
    "logaddexp": logaddexp,
    "fmax": _function("max"),
    "fmin": _function("min"),
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
    "where": where,
    "interp": interp,
    "sinc": sinc,
    "real": real,
    "imag": imag,
    "angle": angles,
    "conj": conjugate,
    "conjugate": conjugate,
    "heaviside": heaviside,
    "clip": clip,
    "ceil": rounded_up,
    "square": lambda x: x * x,
    "reciprocal": lambda x: 1.0 / x,
    "negative": operator.neg,
    "positive": operator.pos,
    "add": operator.add,
    "subtract": operator.sub,
    "multiply": operator.mul,
    "divide": operator.truediv,
    "true_divide": operator.truediv,
    "floor_divide": operator.floordiv,
    "mod": operator.mod,
    "remainder": operator.mod,
    "float64": _float,
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
_CMATH = {name: _MATH[name] for name in ("exp", "sin", "cos", "tan", "sinh", "cosh", "tanh", "sqrt", "log")}
_CMATH |= {
    "phase": angles,
    "polar": lambda z: (dispatch("abs", (z,)), angles(z)),
    "rect": lambda size, turned: size * dispatch("exp", (turned * 1j,)),
}
_LINALG = {"solve": solve, "inv": inv, "det": det}
_SCIPY_LINALG = {"solve": solve_by_scipy, "inv": lambda a, **_: inv(a), "det": lambda a, **_: det(a)}
_LINALG |= refusals(np.linalg, LINEAR_ALGEBRA)
_NUMPY |= refusals(np, ROUNDED)
# Functions of SciPy, by the names of its ufuncs.
_SCIPY = {name: _function(name) for name in ("erf", "erfc", "gamma", "cbrt", "expm1", "log1p")}
_SCIPY |= {"gammaln": _function("lgamma"), "psi": lambda x: dispatch("polygamma", (0.0, x)), "expit": expit}
_BUILTINS = {"min": _extreme("min"), "max": _extreme("max"), "float": _float, "complex": made}
_MODULES: dict[str, dict[str, Any]] = {
    "math": _MATH,
    "cmath": _CMATH,
    "numpy": _NUMPY,
    "numpy.linalg": _LINALG,
    "scipy.linalg": _SCIPY_LINALG,
}


class _Module(PlainModule):
    """A module whose functions understand stand-ins for numbers."""

    def __init__(self, module: types.ModuleType, replaced: dict[str, Any], memo: dict[int, Any]) -> None:
        super().__init__(module, _stand_in, memo)
        self._replaced = replaced

    def __getattr__(self, name: str) -> Any:
        name = "imag" if name == IMAGINARY_PART else name
        return self._replaced[name] if name in self._replaced else super().__getattr__(name)


class _Object:
    """A plugin's object as its own methods see it: with stand-ins for functions and splines that it keeps."""

    def __init__(self, own: Any, memo: dict[int, Any]) -> None:
        vars(self).update(_own=own, _memo=memo)

    def __getattr__(self, name: str) -> Any:
        return _stand_in(getattr(self._own, name), self._memo)

    def __setattr__(self, name: str, value: Any) -> None:
        setattr(self._own, name, value)

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        return _stand_in(self._own.__call__.__func__, self._memo)(self, *arguments, **options)


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
        if value.__name__ in _MODULES:
            return _Module(value, _MODULES[value.__name__], memo)
        return _Module(value, {}, memo) if hasattr(value, "__file__") else value
    value = original(value)
    name = str(getattr(value, "__name__", None))
    for module, replaced in _MODULES.items():  # from numpy import where
        if name in replaced and getattr(sys.modules.get(module), name, None) is value:
            return replaced[name]
    if value is complex:
        return made
    if is_spline(value):
        return Spline(value)
    if type(value).__module__.startswith("scipy.interpolate") and not isinstance(value, type):
        return refusal(
            f"scipy.interpolate.{type(value).__name__}",
            value,
            "Use CubicSpline(x, y), or make_interp_spline(x, y, k=1) for straight lines.",
        )
    if isinstance(value, types.FunctionType):
        return _symbolic(value, memo)
    if isinstance(value, dict | list | tuple) and _holds_functions(value):
        return _container(value, memo)
    if isinstance(value, functools.partial):
        return functools.partial(_stand_in(value.func, memo), *value.args, **value.keywords)
    method = _method_of(value)
    if method is not None:
        seen = _seen(method, memo)
        called = not isinstance(value, types.MethodType)
        return (
            seen
            if called and isinstance(seen, _Object)
            else functools.partial(_stand_in(method.__func__, memo), seen)
        )
    if isinstance(value, np.ufunc):
        return _NUMPY.get(name) or _SCIPY.get(name) or _unsupported_ufunc(value)
    return value


def _holds_functions(value: Any) -> bool:
    """Whether a container of a plain type holds functions that have to be copied, so deep that it is seen."""
    if type(value) not in (dict, list, tuple):
        return False
    entries = value.values() if isinstance(value, dict) else value
    return any(
        isinstance(original(e), types.FunctionType) or is_spline(e) or _holds_functions(e) for e in entries
    )


def _container(value: Any, memo: dict[int, Any]) -> Any:
    """A table of functions, with what they mean in the copy."""
    if id(value) not in memo:
        if isinstance(value, dict):
            memo[id(value)] = {key: _stand_in(entry, memo) for key, entry in value.items()}
        else:
            memo[id(value)] = type(value)(_stand_in(entry, memo) for entry in value)
    return memo[id(value)]


def _method_of(value: Any) -> types.MethodType | None:
    """A method written in Python, bound to its object; also that of an object that is called itself."""
    if not isinstance(value, types.MethodType):
        called = None if isinstance(value, type) else getattr(value, "__call__", None)  # noqa: B004
        value = called if isinstance(called, types.MethodType) else None
    return value if value is not None and isinstance(value.__func__, types.FunctionType) else None


# What Python looks up in the class: an object that has it is handed over as it is.
_OF_CLASS = (
    "__getitem__",
    "__len__",
    "__iter__",
    "__contains__",
    "__add__",
    "__mul__",
    "__sub__",
    "__getattr__",
)


def _seen(method: types.MethodType, memo: dict[int, Any]) -> Any:
    """The object of a method: with stand-ins for what it keeps, where nothing depends on what it is."""
    owner, names = method.__self__, names_used(method.__func__.__code__)
    by_class = any(hasattr(type(owner), name) for name in _OF_CLASS)
    if by_class or isinstance(owner, type) or names & {"super", "isinstance", "type", "__class__"}:
        return owner
    return _Object(owner, memo)


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
        try:
            return copy(*own, *arguments[2:])
        except AttributeError as error:
            if error.name != IMAGINARY_PART:
                raise
            refusal = UnsupportedOperation(
                "The imaginary part of something that is no single number is taken here.",
                "Write numpy.imag(...), which is for arrays and plain numbers, too.",
            )
            raise refusal.with_traceback(error.__traceback__) from error

    return call


def _symbolic(function: types.FunctionType, memo: dict[int, Any]) -> Callable[..., Any]:
    module = getattr(function, "__module__", None) or ""
    if module.split(".")[0] == "numpy" or module.startswith(__package__):
        return function  # these work on stand-ins, and on arrays of them, as they are
    known = id(function) in memo
    copy = copied(function, _stand_in, memo, _BUILTINS)
    if not known and "imag" not in copy.__globals__:
        copy.__code__ = _with_own_imaginary_part(copy.__code__)
    return copy


def _with_own_imaginary_part(code: types.CodeType) -> types.CodeType:
    """Code that asks for `IMAGINARY_PART` where it says `imag`.

    NumPy says that an array of objects has an imaginary part of zero, whatever is in it.
    """
    names = tuple(IMAGINARY_PART if name == "imag" else name for name in code.co_names)
    inner = tuple(_with_own_imaginary_part(c) if isinstance(c, types.CodeType) else c for c in code.co_consts)
    return code.replace(co_names=names, co_consts=inner)

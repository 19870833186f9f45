"""A plugin's functions as plain Python: where they stand, and without what numba made of them.

Functions compiled with `@numba.njit` take arrays and numbers, and no parameters by name; they are used by way
of their Python originals, those of their helpers included.
"""

from __future__ import annotations

import builtins
import functools
import sys
import types
import weakref
from collections.abc import Callable, Iterator, Mapping
from typing import Any

_OWN = ("contwalk", "numpy", "scipy", "mpmath")

Replace = Callable[[Any, dict[int, Any]], Any]


def original(function: Any) -> Any:
    """What numba compiled, where it is one of its functions; else the same thing."""
    dispatcher = getattr(function, "_dispatcher", function)  # of numba.vectorize
    return getattr(dispatcher, "py_func", function)


def place_of(function: Any) -> tuple[str | None, int | None]:
    """File and line at which a function begins, as far as it has one."""
    while isinstance(function, functools.partial):
        function = function.func
    code = getattr(original(function), "__code__", None)
    return (None, None) if code is None else (code.co_filename, code.co_firstlineno)


def line_of(function: Any) -> str:
    """`file, line n: ` at which a function begins, to put before a sentence; empty where it is not known."""
    file, line = place_of(function)
    return "" if file is None else f"{file}, line {line}: "


def line_aside(function: Any) -> str:
    """The same behind what it is of, ` (file, line n)`; empty where it is not known."""
    line = line_of(function).removesuffix(": ")
    return f" ({line})" if line else ""


def copied(
    function: types.FunctionType,
    replace: Replace,
    memo: dict[int, Any],
    more_builtins: Mapping[str, Any] | None = None,
) -> types.FunctionType:
    """A copy of a function in which every global and enclosed name means `replace(value, memo)`.

    The function itself is left as it is.
    """
    if id(function) in memo:
        return memo[id(function)]
    known = {**function.__globals__, "__builtins__": {**vars(builtins), **(more_builtins or {})}}
    cells = tuple(types.CellType() for _ in function.__closure__ or ())
    copy = types.FunctionType(function.__code__, known, function.__name__, function.__defaults__, cells)
    copy.__kwdefaults__ = function.__kwdefaults__
    memo[id(function)] = copy
    for name in names_used(function.__code__):
        if name in function.__globals__:
            known[name] = replace(function.__globals__[name], memo)
    for cell, enclosed in zip(cells, _enclosed(function), strict=True):
        if enclosed:
            cell.cell_contents = replace(enclosed[0], memo)
    return copy


def _enclosed(function: types.FunctionType) -> Iterator[tuple[Any, ...]]:
    """Contents of a closure's cells; nothing of one that is not filled yet."""
    for cell in function.__closure__ or ():
        try:
            yield (cell.cell_contents,)
        except ValueError:
            yield ()


def names_used(code: types.CodeType) -> set[str]:
    """Names that a function may look up, those of functions within it included."""
    used = set(code.co_names)
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            used |= names_used(constant)
    return used


def values_used(function: types.FunctionType) -> Iterator[tuple[str, Any]]:
    """Names and values that a function may look up: global, enclosed, and in modules of the plugin."""
    used = sorted(names_used(function.__code__))
    found = [(name, function.__globals__[name]) for name in used if name in function.__globals__]
    enclosed = zip(function.__code__.co_freevars, _enclosed(function), strict=True)
    found += [(name, content) for name, cell in enclosed for content in cell]
    yield from found
    for _, value in found:
        if isinstance(value, types.ModuleType) and is_plugins(value):
            yield from ((name, vars(value)[name]) for name in used if name in vars(value))


_KNOWN: weakref.WeakKeyDictionary[Any, Any] = weakref.WeakKeyDictionary()
_UNKNOWN = object()


def plain(function: Any) -> Any:
    """The function as it is called with numbers: the same where numba has no part in it, else a copy.

    Whether it has is looked at when the function is first called, since helpers may be defined after it.
    """
    if type(function) is types.FunctionType and not function.__dict__:
        known = _KNOWN.get(function, _UNKNOWN)  # asked for at every point of a branch
        if known is not _UNKNOWN:
            return known or function
    if isinstance(function, functools.partial):
        inner = plain(function.func)
        same = inner is function.func
        return function if same else functools.partial(inner, *function.args, **function.keywords)
    python = original(function)
    if not isinstance(python, types.FunctionType):
        return function
    known = _KNOWN.get(python, _UNKNOWN)
    if known is _UNKNOWN:
        if is_own(python):
            return function
        known = _KNOWN[python] = copied(python, _plain_value, {}) if _meets_numba(python, set()) else None
    return known or python


def is_own(function: types.FunctionType) -> bool:
    """Whether a function is of a package that is known here, and no plugin's."""
    return (getattr(function, "__module__", None) or "").split(".")[0] in _OWN


def _meets_numba(function: types.FunctionType, seen: set[int]) -> bool:
    """Whether a name that it uses, or that its helpers use, is a function of numba."""
    if id(function) in seen or is_own(function):
        return False
    seen.add(id(function))
    for _, value in values_used(function):
        python = original(value)
        if python is not value:
            return True
        if isinstance(python, types.FunctionType) and _meets_numba(python, seen):
            return True
    return False


def is_plugins(module: types.ModuleType) -> bool:
    """Whether a module may be the plugin's own: of no package that is known here, nor of Python itself."""
    package = module.__name__.split(".")[0]
    return package not in _OWN and package not in sys.stdlib_module_names


def _plain_value(value: Any, memo: dict[int, Any]) -> Any:
    python = original(value)
    if isinstance(python, types.FunctionType):
        return python if is_own(python) else copied(python, _plain_value, memo)
    if isinstance(value, types.ModuleType) and is_plugins(value):
        return PlainModule(value, _plain_value, memo)
    return value


class PlainModule:
    """A module whose contents are replaced when they are looked up."""

    def __init__(self, module: types.ModuleType, replace: Replace, memo: dict[int, Any]) -> None:
        self._module, self._replace, self._memo = module, replace, memo

    def __getattr__(self, name: str) -> Any:
        return self._replace(getattr(self._module, name), self._memo)

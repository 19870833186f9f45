"""Running a traced program: in floats, or in as many digits as wanted."""

from __future__ import annotations

import bisect
import marshal
import math
import operator
import sys
from collections.abc import Callable, Sequence
from functools import cache
from types import CodeType
from typing import Any

import numpy as np

from contwalk import object_cache
from contwalk.errors import PluginError
from contwalk.fields import elimination
from contwalk.fields.codegen import source
from contwalk.fields.exact_functions import maximum, minimum
from contwalk.fields.functions import FUNCTIONS
from contwalk.fields.trace import Outputs, Program, Raises
from contwalk.numerics import noise


class PluginRaised(Exception):
    """The plugin's function raised on the path that was taken."""


def _total(function: Callable[..., Any]) -> Callable[..., Any]:
    """A function that is NaN where it has no value."""

    def call(*arguments: Any) -> Any:
        if any(a != a for a in arguments):
            return math.nan
        try:
            return function(*arguments)
        except (ArithmeticError, ValueError):
            return math.nan

    return call


def _with_total(names: dict[str, Callable[..., Any]]) -> dict[str, Any]:
    """Names of the functions, each with its total twin, as `codegen` writes them."""
    own = {f"{name}_": function for name, function in names.items()}
    total = {f"total_{name}_": _total(function) for name, function in names.items()}
    return {**own, **total, "total_div_": _total(operator.truediv), "NAN_": math.nan, "noisy_": noise.noisy}


@cache
def _float_names() -> dict[str, Any]:
    functions = {name: function.of_float for name, function in FUNCTIONS.items()}
    return {**_with_total(functions | elimination.names()), "number_": float}


def _real(function: Callable[..., Any]) -> Callable[..., Any]:
    """A function of mpmath that is NaN where its value is complex."""
    import mpmath

    def call(*arguments: Any) -> Any:
        value = function(*arguments)
        real = not isinstance(value, mpmath.mpc) or any(isinstance(a, mpmath.mpc) for a in arguments)
        return value if real else mpmath.nan

    return call


@cache
def _mp_names() -> dict[str, Any]:
    import mpmath

    functions: dict[str, Callable[..., Any]] = {}
    for name in FUNCTIONS:
        if hasattr(mpmath.mp, name):
            functions[name] = _real(getattr(mpmath.mp, name))
    functions |= {
        "abs": abs,
        "min": minimum,
        "max": maximum,
        "pow": _real(lambda a, b: mpmath.mpf(a) ** b),
        "cbrt": lambda a: mpmath.mp.cbrt(a) if a >= 0 else -mpmath.mp.cbrt(-a),
        "fmod": lambda a, b: a - b * mpmath.mp.floor(a / b) if a / b >= 0 else a - b * mpmath.mp.ceil(a / b),
        "trunc": lambda a: mpmath.mp.floor(a) if a >= 0 else mpmath.mp.ceil(a),
        "log2": _real(lambda a: mpmath.mp.log(a, 2)),
        "lgamma": lambda a: mpmath.mp.log(abs(mpmath.mp.gamma(a))),
        "polygamma": lambda n, a: mpmath.mp.psi(int(n), a),
    }
    return {**_with_total(functions | elimination.names(lambda: mpmath.mp.eps)), "number_": mpmath.mpf}


def _of_tables(tables: Sequence[tuple[float, ...]]) -> dict[str, Callable[..., Any]]:
    """What looks up numbers: `tables` of the program's graph, by their place among them."""
    return {
        "piece": lambda x, table: bisect.bisect_right(tables[int(table)], x),
        "entry": lambda place, table: tables[int(table)][place],
    }


# Python takes milliseconds to compile longer texts; shorter ones are not worth a file each.
_LONG = 8000


def _compiled(text: str) -> CodeType:
    """A text's code; of a long one it is kept on disk, under the text itself and the version of Python."""
    if len(text) < _LONG:
        return compile(text, "<traced plugin>", "exec")
    name = object_cache.key("python", sys.implementation.name, sys.version, text)
    kept = object_cache.load(name)
    if kept is not None:
        code: CodeType = marshal.loads(kept)
        return code
    code = compile(text, "<traced plugin>", "exec")
    object_cache.store(name, marshal.dumps(code))
    return code


class Kernel:
    """A program made callable.

    Parameters
    ----------
    program : Program
    groups : sequence of str
        Names of the input arrays, in the order of the arguments.
    shape : tuple of int, optional
        Shape of the result; by default a vector of the outputs, shape (k,).
    where : sequence of int, optional
        Flat positions of the outputs in the result, for a sparse result; the rest is zero.
    """

    def __init__(
        self,
        program: Program,
        groups: Sequence[str],
        shape: tuple[int, ...] | None = None,
        where: Sequence[int] | None = None,
    ) -> None:
        if shape is None and where is None:
            shape = next(((len(leaf.nodes),) for leaf in program.leaves() if isinstance(leaf, Outputs)), None)
        self._take(source(program, groups), program.graph.tables, shape, where)

    @classmethod
    def of_text(
        cls,
        text: str,
        tables: Sequence[tuple[float, ...]],
        shape: tuple[int, ...] | None,
        where: Sequence[int] | None,
    ) -> Kernel:
        """The kernel whose `text` and `tables` another one has had, with the same shape and places."""
        kernel = cls.__new__(cls)
        kernel._take(text, tables, shape, where)
        return kernel

    def _take(
        self,
        text: str,
        tables: Sequence[tuple[float, ...]],
        shape: tuple[int, ...] | None,
        where: Sequence[int] | None,
    ) -> None:
        self.text, self.tables, self.shape = text, tables, shape
        self.where = None if where is None else np.asarray(where, dtype=int)
        self._size = math.prod(shape or ())
        self._functions: dict[str, Callable[..., list[Any]]] = {}

    def _function(self, arithmetic: str) -> Callable[..., list[Any]]:
        if arithmetic not in self._functions:
            names = _float_names() if arithmetic == "float" else _mp_names()
            names = {**names, "PluginRaised": PluginRaised, **_with_total(_of_tables(self.tables))}
            exec(_compiled(self.text), names)
            self._functions[arithmetic] = names["evaluate"]
        return self._functions[arithmetic]

    def __call__(self, *arrays: Sequence[Any] | np.ndarray) -> np.ndarray:
        """The outputs in floats (complex where a direction is); NaN throughout where one does not exist.

        Raises
        ------
        PluginError
            If the plugin raises; the sentence names the line.
        """
        lists = [a.tolist() if isinstance(a, np.ndarray) else a for a in arrays]
        try:
            values: Any = self._function("float")(*lists)
        except PluginRaised as error:
            raise plugin_error(str(error)) from error
        except (ArithmeticError, ValueError):
            return np.full(self.shape if self.shape is not None else 1, np.nan)
        result = np.array(values)
        if self.where is not None:
            full = np.zeros(self._size, dtype=result.dtype)
            full[self.where] = result
            result = full
        return result if self.shape is None else result.reshape(self.shape)

    def exactly(self, *arrays: Sequence[Any]) -> list[Any]:
        """The outputs in `mpmath` numbers, at the working precision that is set; nonzero ones if sparse."""
        try:
            return self._function("mp")(*arrays)
        except PluginRaised as error:
            raise plugin_error(str(error)) from error


def refuse_raising(program: Program) -> None:
    """Raise what a function raises that does so on each of its paths."""
    leaves = program.leaves()
    if all(isinstance(leaf, Raises) for leaf in leaves):
        raise plugin_error(leaves[0].message)  # type: ignore[union-attr]


def plugin_error(message: str) -> PluginError:
    """The plugin raised; `message` names file, line and exception."""
    return PluginError(
        f"The plugin raised an exception at {message}.", "Mend the plugin, or keep the run away from there."
    )

"""The functions that plugins may use, and the base of all stand-ins for numbers.

One table: each function's name, its value for floats and its partial derivatives as graph nodes. To support
one more function, add one row.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from contwalk.errors import UnsupportedOperation
from contwalk.fields.exact_functions import EXACT
from contwalk.fields.graph import Graph
from contwalk.fields.special_functions import gamma, lgamma, polygamma

Partials = Callable[[Graph, int, tuple[int, ...]], tuple[int | None, ...]]


@dataclass(frozen=True)
class Function:
    """`of_float(*values)`, and `partials(graph, node, arguments)`: for each argument a node, or None."""

    of_float: Callable[..., float]
    partials: Partials


def _reciprocal(g: Graph, node: int) -> int:
    return g.div(g.one, node)


def _square(g: Graph, node: int) -> int:
    return g.mul(node, node)


def _half_over(g: Graph, node: int) -> int:
    return g.div(g.constant(0.5), node)


def _one_plus_square(g: Graph, node: int) -> int:
    return g.add(g.one, _square(g, node))


def _one_minus_square(g: Graph, node: int) -> int:
    return g.sub(g.one, _square(g, node))


def _over_root(g: Graph, radicand: int) -> int:
    return _reciprocal(g, g.call("sqrt", radicand))


def _pow_partials(g: Graph, r: int, a: tuple[int, ...]) -> tuple[int | None, ...]:
    by_base = g.mul(a[1], g.power(a[0], g.sub(a[1], g.one)))
    if g.value(a[1]) is not None:
        return by_base, None
    return by_base, g.mul(r, g.call("log", a[0]))


def _atan2_partials(g: Graph, r: int, a: tuple[int, ...]) -> tuple[int | None, ...]:
    square = g.add(_square(g, a[0]), _square(g, a[1]))
    return g.div(a[1], square), g.neg(g.div(a[0], square))


def _min_partials(g: Graph, r: int, a: tuple[int, ...]) -> tuple[int | None, ...]:
    first = g.compare("le", a[0], a[1])
    return g.select(first, g.one, g.zero), g.select(first, g.zero, g.one)


def _max_partials(g: Graph, r: int, a: tuple[int, ...]) -> tuple[int | None, ...]:
    first = g.compare("le", a[1], a[0])
    return g.select(first, g.one, g.zero), g.select(first, g.zero, g.one)


def _erf_partials(g: Graph, r: int, a: tuple[int, ...]) -> tuple[int | None, ...]:
    bell = g.call("exp", g.neg(_square(g, a[0])))
    root_of_pi = g.call("sqrt", g.mul(g.constant(4.0), g.call("atan", g.one)))
    return (g.div(g.mul(g.constant(2.0), bell), root_of_pi),)


def _erfc_partials(g: Graph, r: int, a: tuple[int, ...]) -> tuple[int | None, ...]:
    (bell,) = _erf_partials(g, r, a)
    assert bell is not None
    return (g.neg(bell),)


def _gamma_partials(g: Graph, r: int, a: tuple[int, ...]) -> tuple[int | None, ...]:
    return (g.mul(r, g.call("polygamma", g.zero, a[0])),)


def _polygamma_partials(g: Graph, r: int, a: tuple[int, ...]) -> tuple[int | None, ...]:
    if g.value(a[0]) is None:
        raise UnsupportedOperation(
            "The order of a polygamma function depends on the state or a parameter.", "Give a whole number."
        )
    return None, g.call("polygamma", g.add(a[0], g.one), a[1])


def _logarithm_partials(base: float) -> Partials:
    return lambda g, r, a: (g.div(g.one, g.mul(a[0], g.call("log", g.constant(base)))),)


FUNCTIONS: dict[str, Function] = {
    "sin": Function(math.sin, lambda g, r, a: (g.call("cos", a[0]),)),
    "cos": Function(math.cos, lambda g, r, a: (g.neg(g.call("sin", a[0])),)),
    "tan": Function(math.tan, lambda g, r, a: (_one_plus_square(g, r),)),
    "asin": Function(math.asin, lambda g, r, a: (_over_root(g, _one_minus_square(g, a[0])),)),
    "acos": Function(math.acos, lambda g, r, a: (g.neg(_over_root(g, _one_minus_square(g, a[0]))),)),
    "atan": Function(math.atan, lambda g, r, a: (_reciprocal(g, _one_plus_square(g, a[0])),)),
    "atan2": Function(math.atan2, _atan2_partials),
    "sinh": Function(math.sinh, lambda g, r, a: (g.call("cosh", a[0]),)),
    "cosh": Function(math.cosh, lambda g, r, a: (g.call("sinh", a[0]),)),
    "tanh": Function(math.tanh, lambda g, r, a: (_one_minus_square(g, r),)),
    "asinh": Function(math.asinh, lambda g, r, a: (_over_root(g, _one_plus_square(g, a[0])),)),
    "acosh": Function(math.acosh, lambda g, r, a: (_over_root(g, g.sub(_square(g, a[0]), g.one)),)),
    "atanh": Function(math.atanh, lambda g, r, a: (_reciprocal(g, _one_minus_square(g, a[0])),)),
    "exp": Function(math.exp, lambda g, r, a: (r,)),
    "expm1": Function(math.expm1, lambda g, r, a: (g.call("exp", a[0]),)),
    "log": Function(math.log, lambda g, r, a: (_reciprocal(g, a[0]),)),
    "log1p": Function(math.log1p, lambda g, r, a: (_reciprocal(g, g.add(g.one, a[0])),)),
    "log2": Function(math.log2, _logarithm_partials(2.0)),
    "log10": Function(math.log10, _logarithm_partials(10.0)),
    "sqrt": Function(math.sqrt, lambda g, r, a: (_half_over(g, r),)),
    "cbrt": Function(math.cbrt, lambda g, r, a: (_reciprocal(g, g.mul(g.constant(3.0), _square(g, r))),)),
    "pow": Function(math.pow, _pow_partials),
    "hypot": Function(math.hypot, lambda g, r, a: (g.div(a[0], r), g.div(a[1], r))),
    "erf": Function(math.erf, _erf_partials),
    "erfc": Function(math.erfc, _erfc_partials),
    "gamma": Function(gamma, _gamma_partials),
    "lgamma": Function(lgamma, lambda g, r, a: (g.call("polygamma", g.zero, a[0]),)),
    "polygamma": Function(polygamma, _polygamma_partials),
    "abs": Function(EXACT["abs"], lambda g, r, a: (g.call("sign", a[0]),)),
    "sign": Function(EXACT["sign"], lambda g, r, a: (None,)),
    "floor": Function(EXACT["floor"], lambda g, r, a: (None,)),
    "fmod": Function(math.fmod, lambda g, r, a: (g.one, g.neg(g.call("trunc", g.div(a[0], a[1]))))),
    "trunc": Function(EXACT["trunc"], lambda g, r, a: (None,)),
    "min": Function(EXACT["min"], _min_partials),
    "max": Function(EXACT["max"], _max_partials),
}


# What rebound functions call `imag`: NumPy's arrays of objects have none by this name.
IMAGINARY_PART = "contwalk_imag"


def _operator(name: str) -> tuple[Callable[[Any, Any], Any], Callable[[Any, Any], Any]]:
    """An operator of Python and its reflection, which apply a function to both sides."""

    def left(self: Any, other: Any) -> Any:
        return self.apply(name, (self, other)) if _is_scalar(other) else NotImplemented

    def right(self: Any, other: Any) -> Any:
        return self.apply(name, (other, self)) if _is_scalar(other) else NotImplemented

    return left, right


class Number:
    """A stand-in for a number. Subclasses say what an operation means: `apply`, `compare`."""

    __slots__ = ()

    def apply(self, name: str, arguments: tuple[Any, ...]) -> Any:
        """The result of the named operation."""
        raise NotImplementedError

    def compare(self, relation: str, a: Any, b: Any) -> Any:
        """The result of a comparison (`lt`, `le`, `eq`)."""
        raise NotImplementedError

    def solution(self, matrix: list[list[Any]], columns: list[list[Any]]) -> list[list[Any]]:
        """Solutions of one linear system, regular or not, for several right-hand sides."""
        raise NotImplementedError

    def piece(self, breaks: tuple[float, ...]) -> Any:
        """How many of these rising numbers it has reached."""
        raise NotImplementedError

    def entry(self, values: tuple[float, ...]) -> Any:
        """The value at this place, a whole number."""
        raise NotImplementedError

    @property
    def real(self) -> Any:
        """The number itself."""
        return self

    @property
    def imag(self) -> Any:
        """Of a real number, zero."""
        return 0.0

    @property
    def contwalk_imag(self) -> Any:
        """The same, as rebound functions ask for it; see `IMAGINARY_PART`."""
        return self.imag

    def __round__(self, digits: Any = None) -> Any:
        raise UnsupportedOperation(
            "A number that depends on the state or a parameter is rounded here.",
            "A step at the halves is math.floor(x + 0.5).",
        )

    def is_zero(self) -> bool:
        """Whether it is zero whatever the state and the parameters are."""
        return False

    def determinant_of(self, matrix: list[list[Any]]) -> Any:
        """The determinant of a matrix."""
        raise NotImplementedError

    __add__, __radd__ = _operator("add")
    __sub__, __rsub__ = _operator("sub")
    __mul__, __rmul__ = _operator("mul")
    __truediv__, __rtruediv__ = _operator("div")
    __pow__, __rpow__ = _operator("pow")

    # NumPy's own functions of arrays ask their entries for `conjugate`, `sqrt` and the like; see below.

    def conjugate(self) -> Any:
        """The same number: it is real."""
        return self

    def select(self, a: Any, b: Any) -> Any:
        """`a` where this holds, or is not zero, else `b`."""
        raise NotImplementedError

    def __neg__(self) -> Any:
        return self.apply("neg", (self,))

    def __pos__(self) -> Any:
        return self

    def __abs__(self) -> Any:
        return self.apply("abs", (self,))

    def __mod__(self, other: Any) -> Any:
        quotient = self.apply("floor", (self.apply("div", (self, other)),))
        return self - quotient * other

    def __floordiv__(self, other: Any) -> Any:
        return self.apply("floor", (self.apply("div", (self, other)),))

    def __rfloordiv__(self, other: Any) -> Any:
        return self.apply("floor", (self.apply("div", (other, self)),))

    def __rmod__(self, other: Any) -> Any:
        return other - (other // self) * self

    def __lt__(self, other: Any) -> Any:
        return self.compare("lt", self, other)

    def __le__(self, other: Any) -> Any:
        return self.compare("le", self, other)

    def __gt__(self, other: Any) -> Any:
        return self.compare("lt", other, self)

    def __ge__(self, other: Any) -> Any:
        return self.compare("le", other, self)

    def __eq__(self, other: Any) -> Any:
        return self.compare("eq", self, other)

    def __ne__(self, other: Any) -> Any:
        same = self.compare("eq", self, other)
        return not same if isinstance(same, bool) else ~same

    __hash__ = object.__hash__


def _method(name: str) -> Callable[..., Any]:
    return lambda *arguments: arguments[0].apply(name, arguments)


# By NumPy's names: its functions of arrays ask the entries.
for _name in sorted(set(FUNCTIONS) - {"min", "max"}):
    setattr(Number, f"arc{_name[1:]}" if _name.startswith("a") and _name != "abs" else _name, _method(_name))


def _is_scalar(other: Any) -> bool:
    """Arrays combine entry by entry: their own operators take over."""
    return not hasattr(other, "__len__")

"""Complex numbers on the way to real results: pairs of stand-ins, or of a stand-in and a float."""

from __future__ import annotations

import builtins
from collections.abc import Callable
from typing import Any

from contwalk.errors import UnsupportedOperation
from contwalk.fields.functions import FUNCTIONS, Number

Pair = tuple[Any, Any]


class Complex(Number):
    """re + i im. Its parts are stand-ins for real numbers, or floats."""

    __slots__ = ("im", "re")

    def __init__(self, re: Any, im: Any) -> None:
        self.re, self.im = re, im

    @property
    def real(self) -> Any:
        """The real part."""
        return self.re

    @property
    def imag(self) -> Any:
        """The imaginary part."""
        return self.im

    def conjugate(self) -> Complex:
        """re - i im."""
        return Complex(self.re, -self.im)

    def apply(self, name: str, arguments: tuple[Any, ...]) -> Any:
        """An operation, part by part."""
        return applied(name, arguments)

    def compare(self, relation: str, a: Any, b: Any) -> Any:
        """Whether two are equal; there is no order among them."""
        if relation != "eq":
            raise UnsupportedOperation(
                "Complex numbers are compared here.", "Compare their real parts, or their absolute values."
            )
        (re, im), (other_re, other_im) = _parts(a), _parts(b)
        distance = _real("abs", re - other_re) + _real("abs", im - other_im)
        return distance == 0.0

    def __bool__(self) -> bool:
        return bool(self != 0.0)

    def __float__(self) -> float:
        raise UnsupportedOperation("A complex number stands where a real one is needed.", REMEDY)

    __int__ = __index__ = __float__

    def is_zero(self) -> bool:
        """Whether both parts are zero whatever the state is."""
        return all(part.is_zero() if isinstance(part, Number) else part == 0.0 for part in (self.re, self.im))


REMEDY = "Take abs(z), z.real or z.imag of it."


def is_complex(value: Any) -> bool:
    """Whether it is a complex number, plain or not."""
    return isinstance(value, Complex | complex)


def applied(name: str, arguments: tuple[Any, ...]) -> Any:
    """A function of `FUNCTIONS`, or an operation, of complex numbers.

    Raises
    ------
    UnsupportedOperation
        If there is none here.
    """
    function = _FUNCTIONS.get(name)
    if function is None:
        raise UnsupportedOperation(
            f"'{name}' gets a complex number.", f"Of those there are {', '.join(sorted(_FUNCTIONS))} here."
        )
    found = function(*(_parts(argument) for argument in arguments))
    return Complex(*found) if isinstance(found, tuple) else found


def made(re: Any = 0.0, im: Any = None) -> Any:
    """`complex(re, im)`."""
    if not isinstance(re, Number) and not isinstance(im, Number):
        return builtins.complex(re) if im is None else builtins.complex(re, im)
    return re + (0.0 if im is None else im) * 1j


def _parts(value: Any) -> Pair:
    if isinstance(value, Complex):
        return value.re, value.im
    if isinstance(value, complex):
        return value.real, value.imag
    return value, 0.0


def _real(name: str, *arguments: Any) -> Any:
    """A function of real numbers."""
    number = next((a for a in arguments if isinstance(a, Number)), None)
    return FUNCTIONS[name].of_float(*arguments) if number is None else number.apply(name, arguments)


def _mul(a: Pair, b: Pair) -> Pair:
    return a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]


def _div(a: Pair, b: Pair) -> Pair:
    square = b[0] * b[0] + b[1] * b[1]
    re, im = _mul(a, (b[0], -b[1]))
    return re / square, im / square


def _abs(a: Pair) -> Any:
    return _real("hypot", *a)


def angle(a: Any) -> Any:
    """The angle of a number in the complex plane."""
    re, im = _parts(a)
    return _real("atan2", im, re)


def _exp(a: Pair) -> Pair:
    size = _real("exp", a[0])
    return size * _real("cos", a[1]), size * _real("sin", a[1])


def _log(a: Pair) -> Pair:
    return 0.5 * _real("log", a[0] * a[0] + a[1] * a[1]), _real("atan2", a[1], a[0])


def _pow(a: Pair, b: Pair) -> Pair:
    exponent = b[0]
    plain = not isinstance(exponent, Number) and not isinstance(b[1], Number) and b[1] == 0.0
    if plain and exponent == int(exponent) and abs(exponent) <= 16:
        result: Pair = (1.0, 0.0)
        for _ in range(abs(int(exponent))):
            result = _mul(result, a)
        return result if exponent >= 0 else _div((1.0, 0.0), result)
    return _exp(_mul(b, _log(a)))


def _sin(a: Pair) -> Pair:
    return (_real("sin", a[0]) * _real("cosh", a[1]), _real("cos", a[0]) * _real("sinh", a[1]))


def _cos(a: Pair) -> Pair:
    return (_real("cos", a[0]) * _real("cosh", a[1]), -(_real("sin", a[0]) * _real("sinh", a[1])))


def _sinh(a: Pair) -> Pair:
    re, im = _sin((-a[1], a[0]))  # sinh z = -i sin(i z)
    return im, -re


def _cosh(a: Pair) -> Pair:
    return _cos((-a[1], a[0]))


_FUNCTIONS: dict[str, Callable[..., Any]] = {
    "add": lambda a, b: (a[0] + b[0], a[1] + b[1]),
    "sub": lambda a, b: (a[0] - b[0], a[1] - b[1]),
    "neg": lambda a: (-a[0], -a[1]),
    "mul": _mul,
    "div": _div,
    "abs": _abs,
    "exp": _exp,
    "log": _log,
    "pow": _pow,
    "sqrt": lambda a: _pow(a, (0.5, 0.0)),
    "sin": _sin,
    "cos": _cos,
    "tan": lambda a: _div(_sin(a), _cos(a)),
    "sinh": _sinh,
    "cosh": _cosh,
    "tanh": lambda a: _div(_sinh(a), _cosh(a)),
}

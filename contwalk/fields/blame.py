"""Finding the line of a plugin at which a NaN or an infinity first arises."""

from __future__ import annotations

import bisect
import math
import operator
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from contwalk.errors import NO_LINE, calling_line, plugin_line
from contwalk.fields.complex_numbers import applied, is_complex
from contwalk.fields.elimination import Factored, eliminated, solved
from contwalk.fields.functions import FUNCTIONS, Number
from contwalk.fields.rebind import rebound
from contwalk.python_functions import line_of
from contwalk.system.declarations import ParameterValues


class _FoundNotFinite(Exception):
    """An operation on finite numbers gave something that is not finite."""


def _value(argument: Any) -> float:
    return argument.value if isinstance(argument, Probe) else float(argument)


# What counts as rounding where a matrix is asked whether it is nearly singular.
NEARLY = 1e-4


# A root of less than this below zero is one of zero but for rounding.
ROUNDED = 1e-9


def _negative_by_rounding(name: str, value: float) -> str:
    """What to write for an argument that is zero, where its event has just happened, but for rounding."""
    if name not in ("pow", "sqrt") or not -ROUNDED < value < 0.0:
        return ""
    return (
        ", which is zero but for rounding: write max(..., 1e-12) around it (with max(..., 0) second "
        "derivatives have no value there, and special points are not located)"
    )


class Probe(Number):
    """A float that raises as soon as an operation gives NaN or infinity."""

    __slots__ = ("value",)
    resolution = sys.float_info.epsilon
    singular = "the matrix of {} rows is singular, as far as rounding can tell"

    def __init__(self, value: float) -> None:
        self.value = value

    def apply(self, name: str, arguments: tuple[Any, ...]) -> Any:
        """The operation in floats, checked."""
        if any(is_complex(a) for a in arguments):
            return applied(name, arguments)
        values = [_value(a) for a in arguments]
        function: Callable[..., float]
        if name in ("add", "sub", "mul", "neg"):
            function = getattr(operator, name)
        elif name == "div":
            function = operator.truediv
        else:
            function = FUNCTIONS[name].of_float
        try:
            result = function(*values)
        except (ArithmeticError, ValueError) as error:
            what = f"{name} of {', '.join(f'{v:g}' for v in values)}"
            raise _FoundNotFinite(what + _negative_by_rounding(name, values[0])) from error
        if not math.isfinite(result):
            raise _FoundNotFinite(f"{name} of {', '.join(f'{v:g}' for v in values)} is {result}")
        return type(self)(result)

    def compare(self, relation: str, a: Any, b: Any) -> bool:
        """The comparison in floats."""
        first = a.value if isinstance(a, Probe) else a
        second = b.value if isinstance(b, Probe) else b
        return bool(getattr(operator, relation)(first, second))

    def solution(self, matrix: list[list[Any]], columns: list[list[Any]]) -> list[list[Any]]:
        """Solutions in floats; a singular matrix is told of."""
        factor = self._factored(matrix)
        if factor.singular:
            raise _FoundNotFinite(self.singular.format(len(matrix)))
        return [[type(self)(v) for v in solved(factor, [_value(b) for b in column])] for column in columns]

    def _factored(self, matrix: list[list[Any]]) -> Factored:
        return eliminated([_value(entry) for row in matrix for entry in row], self.resolution)

    def piece(self, breaks: tuple[float, ...]) -> Any:
        """How many of these rising numbers it has reached."""
        return type(self)(float(bisect.bisect_right(breaks, self.value)))

    def entry(self, values: tuple[float, ...]) -> Any:
        """The value at this place."""
        return type(self)(values[int(self.value)])

    def determinant_of(self, matrix: list[list[Any]]) -> Any:
        """The determinant in floats."""
        return type(self)(self._factored(matrix).determinant)

    def select(self, a: Any, b: Any) -> Any:
        """`a` where this is not zero, else `b`."""
        return a if self.value else b

    def __bool__(self) -> bool:
        return bool(self.value)

    def __float__(self) -> float:
        return float(self.value)


class _Near(Probe):
    """A float to which a matrix is singular long before it is."""

    __slots__ = ()
    resolution = NEARLY
    singular = "the matrix of {} rows is nearly singular"


# Operations that choose a smooth piece, as a plugin writes them.
_WORDS = {"lt": "a comparison", "le": "a comparison", "piece": "a table", "fmod": "math.fmod"}
_CHOOSING = ("abs", "sign", "min", "max", "floor", "trunc", "fmod")


class _Choosing(Probe):
    """A float that remembers what has been chosen by it: which operation, at which line, and what."""

    __slots__ = ()
    met: ClassVar[list[tuple[str, str, float]]] = []

    def _note(self, name: str, choice: float) -> None:
        self.met.append((name, calling_line(), choice))

    def apply(self, name: str, arguments: tuple[Any, ...]) -> Any:
        """The operation, remembered where it chooses."""
        result = super().apply(name, arguments)
        if name in _CHOOSING:
            given = [_value(a) for a in arguments]
            sign = math.copysign(1.0, given[0]) if given[0] else 0.0
            choices = {"abs": sign, "min": given[0] > given[-1], "max": given[0] < given[-1]}
            own = math.trunc(given[0] / given[-1]) if name == "fmod" else result.value
            self._note(name, float(choices.get(name, own)))
        return result

    def compare(self, relation: str, a: Any, b: Any) -> bool:
        """The comparison, remembered."""
        outcome = super().compare(relation, a, b)
        if relation != "eq":
            self._note(relation, float(outcome))
        return outcome

    def piece(self, breaks: tuple[float, ...]) -> Any:
        """The piece, remembered."""
        result = super().piece(breaks)
        self._note("piece", result.value)
        return result


# What counts as nothing of what it was along a motion, and how the operations are told that have no value, or
# no derivative, at nothing.
NOTHING = 1e-3
_OF_NOTHING = {"log": "a logarithm", "sqrt": "a square root", "pow": "a power"}


class _Sizing(Probe):
    """A float that remembers of what quotients, logarithms and roots have been taken, and at which line."""

    __slots__ = ()
    met: ClassVar[list[tuple[str, str, tuple[float, ...]]]] = []

    def apply(self, name: str, arguments: tuple[Any, ...]) -> Any:
        """The operation, remembered where it has no value, or no derivative, at nothing."""
        if (name == "div" or name in _OF_NOTHING) and not any(is_complex(a) for a in arguments):
            values = tuple(abs(_value(a)) for a in arguments)
            if name != "pow" or values[1] < 1.0:  # others have a derivative
                self.met.append((name, calling_line(), values))
        return super().apply(name, arguments)


def first_vanishing(
    function: Callable[..., Any],
    places: Sequence[tuple[float, Sequence[float]]],
    parameters: dict[str, float],
) -> str | None:
    """`file, line n: what` of the first quotient that comes to 0/0, or by zero, at the last of some places.

    The same of logarithms, roots and powers of nothing; None if there is none.

    Parameters
    ----------
    function : callable
        `field(t, x, p, dx)` or a function of the same form.
    places : sequence of (float, sequence of float)
        Times and states along a motion.
    parameters : dict
        Values by name.
    """
    seen = []
    for t, x in places:
        number = type("_Sizing", (_Sizing,), {"met": [], "__slots__": ()})
        first_not_finite(function, t, x, parameters, number)
        seen.append(number.met)  # type: ignore[attr-defined]
    for k, (name, line, last) in enumerate(seen[-1]):
        alike = [met[k][2] for met in seen if len(met) > k and met[k][:2] == (name, line)]
        most = [max(along) for along in zip(*alike, strict=True)]
        small = [own <= NOTHING * largest for own, largest in zip(last, most, strict=True)]
        if name == "div" and small[1] and most[1] > 0.0:
            what = "a quotient comes to 0/0" if small[0] else "the denominator of a quotient comes to zero"
            return f"{line}: {what} there ({last[0]:.1e}/{last[1]:.1e})"
        if name != "div" and small[0] and most[0] > 0.0:
            return f"{line}: what {_OF_NOTHING[name]} is of comes to zero there ({last[0]:.1e})"
    return None


def first_switched(
    function: Callable[..., Any],
    before: tuple[float, Sequence[float]],
    after: tuple[float, Sequence[float]],
    parameters: Mapping[str, float],
    then: Mapping[str, float] | None = None,
) -> str:
    """`file, line n (abs)` of the first choice that is not the same at two times and states; `the plugin` if
    it is not found.

    Parameters
    ----------
    function : callable
        `field(t, x, p, dx)` or a function of the same form.
    before, after : (float, sequence of float)
    parameters, then : mapping
        Values by name; those at the second place, if they are others.
    """
    seen = []
    for (t, x), given in ((before, parameters), (after, then or parameters)):
        number = type("_Choosing", (_Choosing,), {"met": [], "__slots__": ()})
        first_not_finite(function, t, x, dict(given), number)
        seen.append(number.met)  # type: ignore[attr-defined]
    for (name, line, choice), (other, place, chosen) in zip(*seen, strict=False):
        if (name, line) == (other, place) and choice != chosen:
            return f"{line} ({_WORDS.get(name, name)})"
    return NO_LINE


def first_nearly_singular(
    function: Callable[..., Any], t: float, x: Sequence[float], parameters: dict[str, float]
) -> str | None:
    """As `first_not_finite`, of a function that has a value: where a matrix is about to become singular."""
    return first_not_finite(function, t, x, parameters, _Near)


def first_not_finite(
    function: Callable[..., Any],
    t: float,
    x: Sequence[float],
    parameters: dict[str, float],
    number: type[Probe] = Probe,
    named: Callable[..., Any] | None = None,
) -> str | None:
    """Where the function first gives something that is not finite: `file, line n: what`; None if nowhere.

    Parameters
    ----------
    function : callable
        `field(t, x, p, dx)` or a function of the same form.
    t : float
        Time, s.
    x : sequence of float, length n
    parameters : dict
        Values by name.
    number : type
        What stands in for numbers.
    named : callable, optional
        Whose line is told where no operation gives it, but a constant: by default that of the function.
    """
    states = np.array([number(float(v)) for v in x], dtype=object)
    p = ParameterValues(**{name: number(float(value)) for name, value in parameters.items()})
    out = np.empty(len(states), dtype=object)
    try:
        rebound(function)(number(t), states, p, out)
        if not all(entry is None or math.isfinite(_value(entry)) for entry in out):
            return f"{line_of(named or function)}the result is not finite"
    except _FoundNotFinite as error:
        return f"{plugin_line(error)}: {error}"
    except (Exception, SystemExit) as error:
        return f"{plugin_line(error)}: {type(error).__name__}: {error}"
    return None

"""The number that an expression of numbers alone has."""

from __future__ import annotations

import math
from collections.abc import Callable

from contwalk.equations.functions import CONSTANTS, FUNCTIONS
from contwalk.equations.nodes import ModelError, Node, calls_in, names_in


def is_constant(root: Node) -> bool:
    """Whether an expression is made of numbers, known constants and known functions alone."""
    return names_in(root) <= set(CONSTANTS) and calls_in(root) <= set(FUNCTIONS)


def value_of(root: Node) -> float:
    """The value of such an expression.

    Raises
    ------
    ModelError
        If it has none.
    """
    try:
        found = float(_value(root))
    except (ArithmeticError, ValueError, TypeError) as error:
        raise ModelError(f"The number cannot be computed: {error}.", "Write one that exists.") from None
    if not math.isfinite(found):
        raise ModelError("The number is not finite.", "Write one that floats can hold.")
    return found


def _value(root: Node) -> float:
    parts = root.parts
    if root.kind == "number":
        return float(root.value)
    if root.kind == "name":
        return CONSTANTS[str(root.value)]
    if root.kind == "if":
        return _value(parts[1] if _value(parts[0]) else parts[2])
    if root.kind == "call":
        known = FUNCTIONS[str(root.value)]
        if len(parts) not in known.arguments:
            raise TypeError(f"{root.value} takes {' or '.join(map(str, known.arguments))} arguments")
        return known.of_float(*map(_value, parts))
    values = [_value(part) for part in parts]
    return float(_COMPUTED[root.kind](*values))


def _power(a: float, b: float) -> float:
    found = a**b
    if isinstance(found, complex):
        raise ValueError(f"{a:g} to the power {b:g} is no real number")
    return float(found)


_COMPUTED: dict[str, Callable[..., float]] = {
    "negative": lambda a: -a,
    "not": lambda a: not a,
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": lambda a, b: a / b,
    "^": _power,
    "<": lambda a, b: a < b,
    "<=": lambda a, b: a <= b,
    ">": lambda a, b: a > b,
    ">=": lambda a, b: a >= b,
    "==": lambda a, b: a == b,
    "!=": lambda a, b: a != b,
    "and": lambda a, b: bool(a) and bool(b),
    "or": lambda a, b: bool(a) or bool(b),
}

"""Functions of numbers, of stand-ins for numbers, and of arrays of them."""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.errors import UnsupportedOperation
from contwalk.fields.complex_numbers import applied
from contwalk.fields.functions import FUNCTIONS, Number


def dispatch(name: str, arguments: tuple[Any, ...]) -> Any:
    """A function of `FUNCTIONS` for numbers, stand-ins, or arrays of them."""
    for argument in arguments:
        if isinstance(argument, Number):
            return argument.apply(name, arguments)
        if isinstance(argument, complex):
            return applied(name, arguments)
    if any(isinstance(a, np.ndarray | list | tuple) for a in arguments):
        arrays = np.broadcast_arrays(*[np.asarray(a, dtype=object) for a in arguments])
        result = np.empty(arrays[0].shape, dtype=object)
        for index in np.ndindex(result.shape):
            result[index] = dispatch(name, tuple(a[index] for a in arrays))
        return result
    return FUNCTIONS[name].of_float(*arguments)


def where(condition: Any, *sides: Any) -> Any:
    """`numpy.where(condition, a, b)` without a branch."""
    if len(sides) != 2:
        raise UnsupportedOperation(
            "numpy.where gives positions here, which depend on the state.",
            "Give it both values: numpy.where(condition, a, b).",
        )
    a, b = sides
    if isinstance(condition, Number):
        if np.ndim(a) or np.ndim(b):
            condition = np.array(condition, dtype=object)
        else:
            return condition.select(a, b)
    elif np.ndim(condition) == 0 and not (np.ndim(a) or np.ndim(b)):
        return a if condition else b
    conditions, first, second = np.broadcast_arrays(
        np.asarray(condition, dtype=object), np.asarray(a, dtype=object), np.asarray(b, dtype=object)
    )
    result = np.empty(conditions.shape, dtype=object)
    for index in np.ndindex(result.shape):
        result[index] = where(conditions[index], first[index], second[index])
    return result


def symbolic(*values: Any) -> bool:
    """Whether there is a stand-in among numbers or arrays."""
    return any(
        isinstance(entry, Number) for value in values for entry in np.ravel(np.asarray(value, dtype=object))
    )

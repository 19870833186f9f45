"""Calling a plugin's functions with symbols: what equilibria and orbits share of it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from typing import Any

import numpy as np

from contwalk.fields.trace import Tracer
from contwalk.system.declarations import ParameterValues


def parameter_symbols(
    tracer: Tracer, names: Sequence[str], free: str | None, moving: Collection[int]
) -> ParameterValues:
    """Symbols of the parameters by name: `l` for the free one, `b + l d` for those that move along a path."""
    values: dict[str, Any] = {}
    for k, name in enumerate(names):
        if name == free:
            values[name] = tracer.symbol("l", 0)
        elif k in moving:
            values[name] = tracer.symbol("b", k) + tracer.symbol("l", 0) * tracer.symbol("d", k)
        else:
            values[name] = tracer.symbol("b", k)
    return ParameterValues(**values)


def state_symbols(tracer: Tracer, number: int) -> np.ndarray:
    """Symbols `u` of the states, shape (n,)."""
    x = np.empty(number, dtype=object)
    for i in range(number):
        x[i] = tracer.symbol("u", i)
    return x


def written(function: Callable[..., Any], name: str, t: Any, x: np.ndarray, p: ParameterValues) -> list[Any]:
    """What a function of the form `f(t, x, p, out)` writes into `out`, as long as x; every entry of it.

    Raises
    ------
    ValueError
        Naming the first entry that is not written.
    """
    out = np.full(len(x), None, dtype=object)
    function(t, x, p, out)
    for i, entry in enumerate(out):
        if entry is None:
            raise ValueError(f"'{name}' does not write entry {i} of its last argument")
    return list(out)

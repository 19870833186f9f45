"""Calling a plugin's functions with symbols: what equilibria and orbits share of it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np

from contwalk.errors import SystemDefinitionError
from contwalk.fields.rebind import rebound
from contwalk.fields.trace import Tracer, trace
from contwalk.python_functions import line_of
from contwalk.system import System
from contwalk.system.declarations import ParameterValues


def parameter_symbols(
    tracer: Tracer,
    names: Sequence[str],
    free: str | None,
    moving: Collection[int],
    unknown: Mapping[str, int] = MappingProxyType({}),
) -> ParameterValues:
    """Symbols of the parameters by name: `l` for the free one, `b + l d` for those that move along a path.

    `unknown` names those that are unknowns themselves, with their places in `u`.
    """
    values: dict[str, Any] = {}
    for k, name in enumerate(names):
        if name in unknown:
            values[name] = tracer.symbol("u", unknown[name])
        elif name == free:
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


def refuse_time(system: System, mode: str, function: Callable[..., Any], what: str) -> None:
    """Refuse a function of the form `f(t, x, p, out)` that depends on time in a system that has no period.

    Raises
    ------
    SystemDefinitionError
        With the line at which the function begins.
    """
    copy, names = rebound(function), system.parameter_names

    def values(tracer: Tracer) -> list[Any]:
        p = ParameterValues(
            **{name: tracer.symbol("b", k) for k, name in enumerate(names)}, **system.mode(mode).constants
        )
        out = np.full(len(system.states), 0.0, dtype=object)
        copy(tracer.symbol("t", 0), state_symbols(tracer, len(system.states)), p, out)
        return list(out)

    if trace(values).reads("t"):
        raise time_refused(system, function, what)


def refuse_time_of(system: System, mode: str, function: Callable[..., Any], what: str) -> None:
    """As `refuse_time`, of a function of the form `f(t, x, p)` that returns a number.

    Raises
    ------
    SystemDefinitionError
        With the line at which the function begins.
    """
    copy, names, constants = rebound(function), system.parameter_names, system.mode(mode).constants

    def value(tracer: Tracer) -> list[Any]:
        p = {name: tracer.symbol("b", k) for k, name in enumerate(names)}
        x = state_symbols(tracer, len(system.states))
        return [copy(tracer.symbol("t", 0), x, ParameterValues(**p, **constants))]

    if trace(value).reads("t"):
        raise time_refused(system, function, what)


def time_refused(system: System, function: Callable[..., Any], what: str) -> SystemDefinitionError:
    """That a function depends on time in a system that has no period."""
    return SystemDefinitionError(
        f"{line_of(function)}the {what} depends on the time t, but '{system.name}' declares no period.",
        "Declare period=function of p, in seconds, after which the equations repeat themselves, such as "
        "period=lambda p: 2 * math.pi / p.omega, or write them without t. Only single motions (`simulate`, "
        "`sample`) may depend on time in any way.",
    )


def written(function: Callable[..., Any], name: str, t: Any, x: np.ndarray, p: ParameterValues) -> list[Any]:
    """What a function of the form `f(t, x, p, out)` writes into `out`, as long as x; every entry of it.

    Raises
    ------
    SystemDefinitionError
        Naming the first entry that is not written.
    """
    out = np.full(len(x), None, dtype=object)
    function(t, x, p, out)
    for i, entry in enumerate(out):
        if entry is None:
            raise SystemDefinitionError(
                f"'{name}' does not write entry {i} of its last argument.", "Every entry must be written."
            )
    return list(out)

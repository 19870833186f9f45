"""`cw.system_from_sympy`: equations that were derived with SymPy as a system."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from contwalk.equations.sympy_text import text_of_sympy
from contwalk.plugin_check.at_load import system_from_text
from contwalk.system import System


def system_from_sympy(
    states: Sequence[Any],
    equations: Sequence[Any] | Mapping[Any, Any],
    parameters: Mapping[Any, float],
    *,
    start: Mapping[Any, float] | None = None,
    period: Any = None,
    map: bool = False,
) -> System:
    """Make a system of expressions of SymPy.

    Parameters
    ----------
    states : sequence
        Symbols, or functions of the time, `x(t)`.
    equations : sequence or mapping
        The rate of each state, in their order or by state; or `Eq(Derivative(x(t), t), ...)`.
    parameters : mapping
        Symbols with their defaults.
    start : mapping, optional
        Values of states where motions may begin.
    period : expression, optional
        Of a forced system; the time is the symbol `t`.
    map : bool
        Whether the equations give the next state, and not the rates.

    Raises
    ------
    SystemDefinitionError
        For what cannot be translated, and symbols that have no value.
    """
    return system_from_text(text_of_sympy(states, equations, parameters, start or {}, period, map))

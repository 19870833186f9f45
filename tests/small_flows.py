"""Fields of a few states for the tests of the flow."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from contwalk.fields.rebind import rebound
from contwalk.fields.trace import trace
from contwalk.flow.compiled.field import Field


def field_of(
    function: Callable[..., Any], states: int, parameters: int, columns: Sequence[int] = ()
) -> Field:
    """The field of ``function(t, x, p)``, which returns the rates; `columns` are numbers of parameters."""
    copy = rebound(function)

    def results(tracer: Any) -> list[Any]:
        x, p = np.empty(states, dtype=object), np.empty(parameters, dtype=object)
        for group, array in (("x", x), ("p", p)):
            for i in range(len(array)):
                array[i] = tracer.symbol(group, i)
        return list(copy(tracer.symbol("t", 0), x, p))

    return Field(
        trace(results),
        [("x", i) for i in range(states)],
        {"p": parameters},
        [("p", i) for i in columns],
        ("t", 0),
    )

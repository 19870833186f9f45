"""The functions of a plugin that a motion asks, and the first of them that has no value at a state."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from contwalk.fields.blame import first_not_finite
from contwalk.fields.rebind import rebound
from contwalk.system import System


def line_without_value(
    system: System,
    mode: str,
    functions: Mapping[str, Callable[..., Any]],
    t: float,
    x: np.ndarray,
    parameters: Mapping[str, float],
) -> str:
    """` The NAME: file, line n: what.` of the first function that raises or is not finite; empty if none is.

    Parameters
    ----------
    system : System
    mode : str
        Whose constants the functions read.
    functions : mapping
        Of the form `f(t, x, p, out)`, by their names in words.
    t, x
        Time, and state of full length.
    parameters : mapping
    """
    known = {**parameters, **system.mode(mode).constants}
    for name, function in functions.items():
        named = getattr(function, "guard", None)
        found = first_not_finite(function, t, np.asarray(x, dtype=float).tolist(), known, named=named)
        if found is not None:
            return f" The {name}: {found}."
    return ""


def functions_of(system: System, mode: str) -> dict[str, Callable[..., Any]]:
    """The field of a mode and the guards out of it, each in the form of a field, by their names in words."""
    functions: dict[str, Callable[..., Any]] = {f"field of mode '{mode}'": system.mode(mode).field}
    for each in system.leaving(mode):
        functions[f"guard of transition '{each.name}'"] = _AsField(each.guard)
    return functions


class _AsField:
    """A guard in the form of a field."""

    def __init__(self, guard: Callable[..., Any]) -> None:
        self.guard = guard
        self._function = rebound(guard)

    def __call__(self, t: Any, x: Any, p: Any, out: Any) -> None:
        out[0] = self._function(t, x, p)

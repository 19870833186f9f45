"""The line of a plugin at which a motion ceases to exist."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from contwalk.fields.blame import first_not_finite
from contwalk.flow.hybrid_machine import HybridMachine
from contwalk.system import System, Transition


def told(
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
        found = first_not_finite(function, t, np.asarray(x, dtype=float).tolist(), known)
        if found is not None:
            return f" The {name}: {found}."
    return ""


def why_not_finite(
    machine: HybridMachine,
    mode: str,
    t: float,
    x: np.ndarray,
    landing: tuple[Transition, np.ndarray] | None = None,
) -> str:
    """As `told`, of what moves the machine at a state: its field, and guards that act.

    Where a transition has just led there, from the state that comes with it, its reset is asked first.
    """
    system = machine.system
    if landing is not None and landing[0].reset is not None:
        transition, before = landing
        reset: Mapping[str, Any] = {f"reset of transition '{transition.name}'": transition.reset}
        found = told(system, transition.source, reset, t, before, machine.parameters)
        if found:
            return found
    functions: dict[str, Callable[..., Any]] = {f"field of mode '{mode}'": system.mode(mode).field}
    for each in system.leaving(mode):
        functions[f"guard of transition '{each.name}'"] = _as_field(each.guard)
    return told(system, mode, functions, t, x, machine.parameters) if np.isfinite(x).all() else ""


def _as_field(guard: Callable[..., Any]) -> Callable[..., None]:
    def form(t: Any, x: Any, p: Any, out: Any) -> None:
        out[0] = guard(t, x, p)

    return form

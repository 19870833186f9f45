"""What figures show along a motion: states, and signals of the system."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from contwalk.errors import ContwalkError, PluginError, called
from contwalk.python_functions import plain
from contwalk.system import System
from contwalk.system.declarations import ParameterValues, nearest


def values_along(
    system: System,
    names: Sequence[str],
    times: np.ndarray,
    states: np.ndarray,
    parameters: Mapping[str, float],
) -> np.ndarray:
    """States and signals by name, shape (k, m), of a motion with times (k,) and states (k, n).

    Raises
    ------
    ContwalkError
        For a name that is neither, or a signal that does not return an array of shape (k,).
    """
    check_names(system, names)
    p, columns = ParameterValues(**parameters), []
    for name in names:
        if name in system.state_names:
            columns.append(states[:, system.state_names.index(name)])
            continue
        signal = next(signal for signal in system.signals if signal.name == name)
        with np.errstate(divide="ignore", invalid="ignore"):
            found = called(
                f"signal '{name}'",
                lambda function: np.asarray(function(times.copy(), states.copy(), p), dtype=float),
                plain(signal.function),
            )
        if found.shape != times.shape:
            raise PluginError(
                f"Signal '{name}' returns an array of shape {found.shape} for {len(times)} instants.",
                "Return one number for each instant: an array as long as t.",
            )
        columns.append(found)
    return np.array(columns).T


def listed(names: str | Sequence[str] | None) -> list[str]:
    """Names that are given as one, as several, or not at all."""
    return [names] if isinstance(names, str) else list(names or ())


def check_names(system: System, names: Sequence[str]) -> None:
    """Refuse what is neither a state nor a signal.

    Raises
    ------
    ContwalkError
    """
    known = (*system.state_names, *system.signal_names)
    for name in names:
        if name not in known:
            what = "neither a state nor a signal" if system.signals else "not a state"
            raise ContwalkError(
                f"'{name}' is {what} of '{system.name}'.",
                f"{nearest(name, known)} Known: {', '.join(known)}.".strip(),
            )

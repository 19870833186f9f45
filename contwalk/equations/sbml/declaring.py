"""Parameters and states with numbers that can be computed with."""

from __future__ import annotations

from contwalk.equations.model import Defined, Model, Value


def add_parameter(model: Model, own: str, value: float | None, line: int, about: str) -> None:
    """Declare a parameter.

    Raises
    ------
    ModelError
        If it has no finite value.
    """
    if value is None or not _is_finite(value):
        raise model.wrong(line, f"'{own}' has no finite value.", "Give it one.")
    about = " ".join(about.split())
    model.parameters[own] = Value(value, line, "" if about == own else about)


def add_state(model: Model, own: str, rate: Defined, value: float | None) -> None:
    """Declare a state with its rate, and where it begins if that is known.

    Raises
    ------
    ModelError
        If that is no finite number.
    """
    if value is not None and not _is_finite(value):
        raise model.wrong(rate.line, f"'{own}' begins with no finite number.", "Give one.")
    model.rates[own] = rate
    if value is not None:
        model.starts[own] = Value(value, rate.line)


def _is_finite(value: float) -> bool:
    """Whether it is a number, and not one that is nearly too large to be one."""
    return abs(value) <= 1e300

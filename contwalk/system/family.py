"""Model choices: one plugin, several machines.

A `Family` builds a `System` from choices such as the number of masses. What is not chosen does not exist
in the built system: a machine with two masses carries nothing of one with three.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from contwalk.errors import SystemDefinitionError
from contwalk.system.declarations import System, nearest


@dataclass(frozen=True)
class Choice:
    """One model choice.

    Parameters
    ----------
    name : str
    default : int, float, bool or str
    allowed : tuple, optional
        The values to choose from.
    minimum : int, optional
        For a whole number: the least value.
    about : str
    """

    name: str
    default: Any
    allowed: tuple[Any, ...] | None = None
    minimum: int | None = None
    about: str = ""

    def words(self) -> str:
        """What is allowed, in words."""
        if self.allowed is not None:
            return "one of " + ", ".join(str(value) for value in self.allowed)
        if self.minimum is not None:
            return f"a whole number from {self.minimum} up"
        return f"a {type(self.default).__name__}"

    def accepts(self, value: Any) -> bool:
        """Whether `value` may be chosen."""
        if self.allowed is not None:
            return value in self.allowed and isinstance(value, bool) == isinstance(self.default, bool)
        if self.minimum is not None:
            return isinstance(value, int) and not isinstance(value, bool) and value >= self.minimum
        return isinstance(value, type(self.default))


@dataclass(frozen=True)
class Family:
    """Machines that differ by model choices; `build(**choices)` returns the `System`."""

    name: str
    choices: tuple[Choice, ...]
    build: Callable[..., System]
    about: str = ""

    def with_model(self, model: Mapping[str, Any]) -> System:
        """The system of these choices; defaults fill in what is not given.

        Raises
        ------
        SystemDefinitionError
            For an unknown choice or a value that is not allowed.
        """
        chosen = {choice.name: choice.default for choice in self.choices}
        by_name = {choice.name: choice for choice in self.choices}
        for name, value in model.items():
            if name not in by_name:
                raise SystemDefinitionError(
                    f"'{name}' is not a model choice of '{self.name}'.",
                    f"Choices: {', '.join(by_name)}. {nearest(name, list(by_name))}".strip(),
                )
            if not by_name[name].accepts(value):
                raise SystemDefinitionError(
                    f"Model choice '{name}' of '{self.name}' is {value!r}.",
                    f"It must be {by_name[name].words()}.",
                )
            chosen[name] = value
        return replace(self.build(**chosen), model=chosen)

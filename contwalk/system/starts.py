"""Where a study may begin: named equilibria, and a study that is worth a run file."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from dataclasses import field as attribute
from typing import Any

from contwalk.errors import SystemDefinitionError
from contwalk.system.names import require_callable, require_name


@dataclass(frozen=True)
class Study:
    """What `contwalk init` writes into a run file: a parameter along which something happens, and a start.

    `start` is as in a run file; without it `init` finds one. `parameters` go on top of the defaults, `events`
    of the run file say what happens at limits.
    """

    parameter: str
    range: tuple[float, float]
    start: Mapping[str, Any] | None = None
    parameters: Mapping[str, float] = attribute(default_factory=dict)
    events: Mapping[str, str] = attribute(default_factory=dict)

    def __post_init__(self) -> None:
        require_name("A study", self.parameter)
        low, high = self.range
        if not low < high:
            raise SystemDefinitionError(
                f"The range of the study over '{self.parameter}' is ({low:g}, {high:g}).",
                "Give the lower end first.",
            )


@dataclass(frozen=True)
class Start:
    """A named equilibrium known in closed form.

    `states(p)` returns a list of states (each of length n); an empty list where none exists. `exists` says in
    words when it exists, for the error message.
    """

    name: str
    states: Callable[..., Sequence[Sequence[float]]]
    about: str = ""
    exists: str = ""

    def __post_init__(self) -> None:
        require_name("A start", self.name)
        require_callable(f"The states of start '{self.name}'", self.states)

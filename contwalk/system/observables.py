"""What is measured of a motion: observables and signals."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from contwalk.system.names import require_callable, require_name, require_side, require_texts


@dataclass(frozen=True)
class Observable:
    """A number computed from a motion: `function(t, x, p)` with `t` of shape (k,) and `x` of shape (k, n).

    An equilibrium is handed over as a motion of one instant (k = 1). A motion through events has two
    instants at each: before and after. With `at` the number belongs to an event instead: `t` is its time and
    `x`, shape (n,), the state before or after it (`side`), where it happens for the first time in a period.
    """

    name: str
    function: Callable[..., float]
    unit: str = "1"
    about: str = ""
    at: str | None = None
    side: str = "before"

    def __post_init__(self) -> None:
        require_name("An observable", self.name)
        require_texts(f"Observable '{self.name}'", self, "unit", "about")
        require_callable(f"The function of observable '{self.name}'", self.function)
        require_side(f"Observable '{self.name}'", self.side)


@dataclass(frozen=True)
class Signal:
    """A quantity that figures show along a motion: `function(t, x, p)`, of the shapes that observables take.

    It returns an array of shape (k,), NaN where the quantity does not exist: the height of a foot, the force
    on it. Nothing is computed with it.
    """

    name: str
    function: Callable[..., Any]
    unit: str = "1"
    about: str = ""

    def __post_init__(self) -> None:
        require_name("A signal", self.name)
        require_callable(f"The function of signal '{self.name}'", self.function)

"""What a machine's numbers are: states and parameters."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from contwalk.errors import SystemDefinitionError
from contwalk.system.names import is_number, require_name, require_texts


@dataclass(frozen=True)
class State:
    """One state variable.

    Parameters
    ----------
    name : str
    unit : str
        Unit as text, `"1"` where dimensionless.
    scale : float, optional
        A typical magnitude. It only weighs the state in step lengths; without it one is estimated.
    about : str
        One line of meaning.
    period : float, optional
        For an angle, its period (`2 * math.pi`): states that differ by it are the same motion.
    start : float, optional
        Its value where motions may begin: with those of the other states, what `contwalk init` writes.
    latex : str
        How figures write its name, `\\beta_1`; by default the name.
    """

    name: str
    unit: str = "1"
    scale: float | None = None
    about: str = ""
    period: float | None = None
    start: float | None = None
    latex: str = ""

    def __post_init__(self) -> None:
        require_name("A state", self.name)
        require_texts(f"State '{self.name}'", self, "unit", "about", "latex")
        for what, value in (("scale", self.scale), ("period", self.period)):
            if value is not None and not (is_number(value) and 0 < value < math.inf):
                raise SystemDefinitionError(
                    f"State '{self.name}' has {what} {value!r}.", f"A {what} is a positive number."
                )
        if self.start is not None and not (is_number(self.start) and math.isfinite(self.start)):
            raise SystemDefinitionError(
                f"State '{self.name}' has start {self.start!r}.", "A start is a finite number."
            )


def declared_scales(states: Sequence[State]) -> np.ndarray:
    """The scale of each of n states, NaN where none is declared, shape (n,)."""
    return np.array([np.nan if state.scale is None else state.scale for state in states])


@dataclass(frozen=True)
class Parameter:
    """One parameter, with its default, unit, bounds (`None` where unbounded) and one line of meaning.

    `latex` is how figures write its name, as of a `State`.
    """

    name: str
    default: float
    unit: str = "1"
    bounds: tuple[float | None, float | None] = (None, None)
    about: str = ""
    latex: str = ""
    # Whether it is the value of a conserved quantity.
    conserved: ClassVar[bool] = False

    def __post_init__(self) -> None:
        require_name("A parameter", self.name)
        require_texts(f"Parameter '{self.name}'", self, "unit", "about", "latex")
        if not is_number(self.default):
            raise SystemDefinitionError(
                f"Parameter '{self.name}' has the default {self.default!r}.", "A default is a number."
            )
        if not (isinstance(self.bounds, tuple | list) and len(self.bounds) == 2) or not all(
            bound is None or (is_number(bound) and not math.isnan(bound)) for bound in self.bounds
        ):
            raise SystemDefinitionError(
                f"Parameter '{self.name}' has bounds {self.bounds!r}.",
                "Bounds are a pair of numbers, None where it is unbounded: (0.0, None).",
            )
        low, high = self.bounds
        if low is not None and high is not None and low > high:
            raise SystemDefinitionError(
                f"Parameter '{self.name}' has bounds {self.bounds}.", "The lower bound comes first."
            )
        if not self.allows(self.default) and not (self.conserved and math.isnan(self.default)):
            raise SystemDefinitionError(
                f"Parameter '{self.name}' has the default {self.default}, outside its bounds "
                f"{self.interval()}.",
                "A default is a finite number within the bounds.",
            )

    def allows(self, value: float) -> bool:
        """Whether `value` lies within the bounds."""
        low, high = self.bounds
        return bool(np.isfinite(value)) and (low is None or value >= low) and (high is None or value <= high)

    def interval(self) -> str:
        """The bounds as text: `[0, inf)`."""
        low, high = self.bounds
        left = "(-inf" if low is None else f"[{low:g}"
        right = "inf)" if high is None else f"{high:g}]"
        return f"{left}, {right}"


class ConservedValue(Parameter):
    """The value of a conserved quantity: its default may be NaN, for what the start has of it."""

    conserved = True

"""A special point that has been solved for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

# What a point's vectors have where another curve crosses: the equations are singular there.
CROSSING = "crossing"
# What they have where the parameter's own turn tells a fold, and multipliers do not.
TURNED = "turned"


@dataclass(frozen=True)
class Located:
    """A special point that a defining system has been solved for.

    Parameters
    ----------
    z : ndarray, shape (N + 1,)
    error : float
        Estimated absolute error of the free parameter.
    vectors : mapping
        Null vectors and the like that normal forms and switching need.
    refined : bool
        Whether the point is known to more digits than floats hold.
    refine : callable
        The same point refined in extended precision; None where it turns out not to be one.
    problem : Problem
        The discretisation that it was found on, where there is more than one.
    """

    z: np.ndarray
    error: float
    vectors: Mapping[str, Any] = field(default_factory=dict)
    refined: bool = False
    refine: Callable[[], Located | None] | None = None
    problem: Any = None

    def settled(self) -> Located | None:
        """The refined point, if there is a way to refine it."""
        return self if self.refine is None else self.refine()

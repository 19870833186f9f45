"""A special point that has been solved for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

import numpy as np

Data = TypeVar("Data")
AnyLimit = TypeVar("AnyLimit")


@dataclass(frozen=True)
class Located(Generic[Data]):
    """A special point that a defining system has been solved for.

    Parameters
    ----------
    z : ndarray, shape (N + 1,)
    error : float
        Estimated absolute error of the free parameter.
    data : optional
        What its equations have found beside z, for the normal form: the kind of point knows what that is.
    refined : bool
        Whether the point is known to more digits than floats hold.
    refine : callable
        The same point refined in extended precision; None where it turns out not to be one.
    problem : Problem
        The discretisation that it was found on, where there is more than one.
    errors : mapping of str to float
        Estimated errors by parameter, where several are free.
    which : int, optional
        Number of the stability measure that passes zero.
    multiplicity : int
        How many eigenvalues vanish together.
    critical : ndarray, shape (k,), optional
        The null vector of F_u at a fold, of the first k unknowns.
    turns : bool
        Whether the parameter turns as well, at a fold that is not told apart.
    limit : int, optional
        Number of the limit that passes zero.
    vanishing : tuple of int
        Where legs vanish, the limits that pass zero with them.
    crossing : sequence of ndarray, shape (N + 1,), optional
        Where another curve crosses, and equations are singular: tangents of both, as far as these are known.
    returned_to_parent : bool
        Whether the branch is its parent's again.
    """

    z: np.ndarray
    error: float
    data: Data = None  # type: ignore[assignment]
    refined: bool = False
    refine: Callable[[], Located[Data] | None] | None = None
    problem: Any = None
    errors: Mapping[str, float] = field(default_factory=dict)
    which: int | None = None
    multiplicity: int = 1
    critical: np.ndarray | None = None
    turns: bool = False
    limit: int | None = None
    vanishing: tuple[int, ...] = ()
    crossing: Sequence[np.ndarray] | None = None
    returned_to_parent: bool = False

    def settled(self) -> Located[Data] | None:
        """The refined point, if there is a way to refine it."""
        return self if self.refine is None else self.refine()

    def among(self, limits: Sequence[AnyLimit]) -> AnyLimit:
        """Of the limits of a problem the one that passes zero."""
        assert self.limit is not None
        return limits[self.limit]

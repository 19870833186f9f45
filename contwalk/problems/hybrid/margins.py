"""What must stay positive along an orbit for it to be the machine's, and its values on one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contwalk.memory import computed_once
from contwalk.problems.orbit.points.catalogue import LIMIT_TYPES
from contwalk.problems.problem import LimitType
from contwalk.problems.sample import within
from contwalk.system import Transition

KINDS: dict[str, LimitType] = {kind.label: kind for kind in LIMIT_TYPES}
# Limits whose numbers are not the guard's own: margins tell them under names of their own.
DERIVED = ("rate", "duration", "leaving", "past")
# Tests of curves of grazings: the instant of the touch comes to the event before its leg, or after it.
TOUCH_STARTS, TOUCH_ENDS = "touch_starts", "touch_ends"


@dataclass(frozen=True)
class Limit:
    """One number that must stay positive; `acts` says whether something happens where it is not.

    `test` says what the number is: a guard's value where it is least inside the leg (`dip`), at its `start`
    or at its `end`; how fast the own guard arrives (`rate`); how a guard that its own event leaves without
    rate goes on (`leaving`: its second derivative); the leg's `duration`; a `condition`; how
    far past zero the guard of a collapsed leg is where it begins (`past`).
    """

    label: str
    kind: str | None
    name: str
    leg: int
    test: str
    acts: bool = True

    @property
    def type(self) -> LimitType:
        """The kind of special point where it passes zero."""
        return KINDS[self.label]

    @property
    def rank(self) -> int:
        """A duration that vanishes tells more than a guard that is zero at the leg's end."""
        return {"duration": 0, "rate": 0, "past": 0, "start": 2, "end": 2}.get(self.test, 1)


@dataclass(frozen=True, eq=False)
class Guarded:
    """A guard on a leg, whatever the solution."""

    transition: Transition
    place: int  # among those out of the mode
    falls: bool | None  # it is told by the leg
    own: bool
    opens: bool  # its guards go on from the leg before, through a soft transition or none
    closes: bool  # they go on in the leg after it
    known: bool  # the leg before has the guard, too
    clock: bool  # a guard of time alone
    passed: bool  # its event has led here, and is an edge
    edges: bool  # passing zero downwards is all that matters: it may be below zero where the leg begins


@dataclass(frozen=True, eq=False)
class Margins:
    """Values of all limits of an orbit.

    Parameters
    ----------
    limits : tuple of Limit
    values, scales : ndarray, shape (k,)
        In physical units, and what they are compared with; infinite where there is no such instant.
    places : ndarray, shape (k,)
        Where on its leg, 0..1.
    """

    limits: tuple[Limit, ...]
    values: np.ndarray
    scales: np.ndarray
    places: np.ndarray

    @property
    def relative(self) -> np.ndarray:
        """Values in units of their scales, at most one in modulus. Shape (l,)."""
        return np.clip(self.values / self.scales, -1.0, 1.0)

    @property
    def admissible(self) -> bool:
        """Whether none is negative."""
        return within(self.relative)

    @computed_once
    def by_name(self) -> dict[str, float]:
        """The smallest value under each name, where there is one."""
        found: dict[str, float] = {}
        for limit, value in zip(self.limits, self.values.tolist(), strict=True):
            key = limit.name if limit.test not in DERIVED else f"{limit.name}_{limit.test}"
            if np.isfinite(value):
                found[key] = min(found.get(key, np.inf), value)
        return found

    def least(self, name: str) -> float:
        """The smallest value under a name; NaN where there is none."""
        return self.by_name.get(name, float("nan"))

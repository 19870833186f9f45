"""The first steps of a branch, looked at before it is decided whether the branch is walked."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from contwalk.continuation.allowance import Allowance
from contwalk.continuation.marks import Observer
from contwalk.continuation.pseudo_arclength import End, Point, walk
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState
from contwalk.diagram.opening import Opening
from contwalk.problems.problem import Problem

# A problem, and where on one of its branches a walk sets out.
Place = tuple[Problem, ContinuationState]


class FirstSteps:
    """A walk that has been begun: what it has found so far is found once.

    Parameters
    ----------
    place : Place
        Where it sets out; the other parameters are those of `walk`.
    """

    def __init__(
        self, place: Place, settings: Settings, observer: Observer, sign: float, points: int
    ) -> None:
        self.place, self.points, self.allowance = place, points, Allowance()
        self._events = walk(*place, settings, observer, sign, points, allowance=self.allowance)
        self._seen: list[Point | End] = []

    def first(self) -> Point | End:
        """The first solution that is no special point, or the end before it."""
        for event in self._events:
            self._seen.append(event)
            if isinstance(event, End) or event.special is None:
                break
        return self._seen[-1]

    def whole(self) -> Iterator[Point | End]:
        """All that the walk finds, from its first step on; to be asked for once."""
        yield from self._seen
        yield from self._events


@dataclass
class Beginning:
    """A branch that is not walked yet: its first row, shape (1,), and the first steps by their signs."""

    opening: Opening
    row: np.ndarray
    steps: dict[float, FirstSteps] = field(default_factory=dict)

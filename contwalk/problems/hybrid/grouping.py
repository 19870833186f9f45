"""Which legs of an explicit itinerary are pieces of one leg between hard transitions; their unknowns. Where
there are no hard ones that leg is the whole closure.

Unknowns that are left: the state at the start of each group, its whole duration, and what belongs to no leg.
Eliminated: the states at the starts of the other pieces, and the durations of all pieces but a group's last.
"""

from __future__ import annotations

import numpy as np

from contwalk.problems.orbit.itinerary import Itinerary
from contwalk.problems.orbit.layout import Layout

# A little time, in parts of the closure's.
NO_TIME = 1e-6


class Grouping:
    """The groups of an itinerary that does not end with a soft transition.

    Attributes
    ----------
    groups : list of list of int
        Numbers of the legs of each group.
    hard_rows, soft_rows : ndarray of int
        Equations that are left, in the order of their own layout, and those that are eliminated.
    """

    def __init__(self, itinerary: Itinerary, layout: Layout) -> None:
        self.layout = layout
        self.groups: list[list[int]] = [[]]
        for i, leg in enumerate(itinerary.legs):
            self.groups[-1].append(i)
            if not leg.soft:
                self.groups.append([])
        if self.groups.pop():
            raise ValueError("the itinerary ends with a soft transition")
        first, last = [group[0] for group in self.groups], [group[-1] for group in self.groups]
        inner = [i for group in self.groups for i in group[:-1]]
        later = [i for group in self.groups for i in group[1:]]
        durations = layout.durations.start
        rest = np.arange(layout.durations.stop, layout.size + 1)
        self._first = _joined([layout.states[i] for i in first])
        self._later = _joined([layout.states[i] for i in later])
        self._inner = np.array([durations + i for i in inner], dtype=int)
        self._last = np.array([durations + i for i in last], dtype=int)
        self._last_of = np.array(
            [durations + group[-1] for group in self.groups for _ in group[:-1]], dtype=int
        )
        self._group_of = np.array([k for k, group in enumerate(self.groups) for _ in group[:-1]], dtype=int)
        self._rest = rest
        guards = layout.guards
        self.hard_rows = np.concatenate(
            [
                _joined([layout.matches[i] for i in last]),
                guards + np.array(last, dtype=int),
                np.arange(guards + layout.legs, layout.size),
            ]
        )
        soft = [_joined([layout.matches[i] for i in inner]), guards + np.array(inner, dtype=int)]
        self.soft_rows = np.concatenate(soft).astype(int)

    def split(self, unknowns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What is left of unknowns, or of a direction, and what is eliminated.

        Unknowns have the shape (N + 1,) of the explicit orbit.
        """
        lasting = unknowns[self._last].copy()
        np.add.at(lasting, self._group_of, unknowns[self._inner])
        own = np.concatenate([unknowns[self._first], lasting, unknowns[self._rest]])
        return own, np.concatenate([unknowns[self._later], unknowns[self._inner]])

    def joined(self, own: np.ndarray, soft: np.ndarray) -> np.ndarray:
        """Explicit unknowns, or a direction of them, of both parts.

        The result has the shape (N + 1,) of the explicit orbit.
        """
        result = np.zeros(self.layout.size + 1)
        states, groups, inner = len(self._first), len(self.groups), len(self._later)
        result[self._first], result[self._rest] = own[:states], own[states + groups :]
        result[self._later], result[self._inner] = soft[:inner], soft[inner:]
        lasting = own[states : states + groups].copy()
        np.subtract.at(lasting, self._group_of, soft[inner:])
        result[self._last] = lasting
        return result

    def columns(self, jacobian: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives by what is left and by what is eliminated, of those by the explicit unknowns.

        The jacobian has the shape (N, N + 1) of the explicit orbit.
        """
        own = np.hstack([jacobian[:, self._first], jacobian[:, self._last], jacobian[:, self._rest]])
        by_inner = jacobian[:, self._inner] - jacobian[:, self._last_of]
        return own, np.hstack([jacobian[:, self._later], by_inner])

    def backward(self, lasting: np.ndarray) -> bool:
        """Whether a piece beside a soft transition lasts less than no time, of the durations of all legs.

        A little less does no harm: the equations are smooth there, and what the field does meanwhile is not
        felt.

        `lasting` has the shape (m,).
        """
        least = -NO_TIME * float(np.abs(lasting).sum())
        return any(bool(np.any(lasting[group] < least)) for group in self.groups if len(group) > 1)


def _joined(slices: list[slice]) -> np.ndarray:
    found = [np.arange(place.start, place.stop) for place in slices]
    return np.concatenate(found).astype(int) if found else np.zeros(0, dtype=int)

"""Branches walked ahead of their turn: what others are asked, what they tell, and how it is taken over.

A branch follows from its start alone, wherever and however often it is walked. So the diagram takes the
branches in the order of its queue, from whoever has walked them, and stores the same bits.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from contwalk.branch import Outcome, SpecialPoint
from contwalk.continuation.allowance import UNBOUNDED, Allowance, Bound
from contwalk.diagram.branch_in_progress import BranchInProgress, Start
from contwalk.diagram.branch_walk import BranchWalk
from contwalk.diagram.effort import REASON
from contwalk.diagram.events import Began, Event, Found, Noted
from contwalk.labels import END

# Stands in texts for the name of a branch that is not known yet.
NAMELESS = "\ue000"


@dataclass(frozen=True)
class Task:
    """A branch to walk: data that any process understands.

    Parameters
    ----------
    number : tuple of int
        Which start of the run, counted from 0; then which of the branches that leave that start's branch; and
        so on.
    side : float, optional
        The direction that is walked; both of them, if they are not independent.
    ancestors : tuple of tuples of SpecialPoint
        Of each branch on the way, the first one's first, its special points.
    allowed : Bound
        What both directions may cost at most, as far as that is known.
    """

    number: tuple[int, ...]
    side: float | None = None
    ancestors: tuple[tuple[SpecialPoint, ...], ...] = field(default=(), compare=False)
    allowed: Bound = field(default=UNBOUNDED, compare=False)

    @property
    def turn(self) -> tuple[int, int, tuple[int, ...], float]:
        """Tasks in this order are in that of the queue: each start with all that grows out of it."""
        return self.number[0], len(self.number), self.number, -(self.side or 0.0)


@dataclass(frozen=True)
class Point:
    """A row of the branch, shape (1,), a special point, or one with its row."""

    row: np.ndarray | None
    special: SpecialPoint | None


@dataclass(frozen=True)
class Note:
    """A note on the branch, under a key."""

    key: str
    text: str


@dataclass(frozen=True)
class Beginning:
    """The branch begins."""


@dataclass(frozen=True)
class Ends:
    """How each direction has ended, by its sign, and whether by an error: what is told last."""

    outcomes: tuple[tuple[float, Outcome], ...]
    broken: bool


Message = Beginning | Point | Note | Ends


class Ahead(Protocol):
    """Who walks branches ahead of their turn."""

    def expect(self, tasks: Sequence[Task]) -> None:
        """These branches are likely to be asked for, in the order of their turns."""

    def drop(self, task: Task) -> None:
        """This one will not be asked for."""

    def messages(self, task: Task) -> Iterator[Message]:
        """What is told of a branch whose turn has come, up to its `Ends`."""


class UpTo:
    """What is told of a side of a branch, up to where a direction has cost what it may.

    Where whoever walks it was not told how much that is, or may have more, its further steps are not taken
    over.

    Attributes
    ----------
    cut : bool
        Whether something is left out, or told of another bound.
    """

    def __init__(self, messages: Iterator[Message], allowed: Bound, begins: float) -> None:
        self._messages, self._allowed, self._begins = messages, allowed, begins
        self.cut = False

    def __iter__(self) -> Iterator[Message]:
        sides: dict[float, Allowance] = {}
        used_up = False
        for message in self._messages:
            special = message.special if isinstance(message, Point) else None
            ends = isinstance(message, Ends) or (special is not None and special.label == END)
            if (used_up and not ends) or (special is not None and special.kind == REASON):
                self.cut = True
                return
            yield message
            if isinstance(message, Point) and message.row is not None:
                sign = float(np.sign(message.row["s"][0]))
                side = sides.setdefault(sign, Allowance(self._allowed, 0, self._begins, self._begins))
                side.tell(message.row["free"][0, 0], int(message.row["rhs"][0]))
                used_up = special is None and sign != 0.0 and side.used_up


def messages_of(
    walk: BranchWalk, start: Start, side: float | None, allowed: Bound = UNBOUNDED
) -> Iterator[Message]:
    """All that is to be told of a side of the branch of a start, walked here, whatever its name will be."""
    if isinstance(start.opening, Outcome):
        return
    work = BranchInProgress(walk.info(start, NAMELESS))
    for event in walk.events(start, start.opening, work, None, side, allowed):
        if isinstance(event, Began):
            yield Beginning()
        elif isinstance(event, Found):
            yield Point(event.row, event.special)
        elif isinstance(event, Noted):
            yield Note(event.key, event.text)
    yield Ends(tuple(work.outcomes), work.broken)


def taken_over(messages: Iterable[Message], work: BranchInProgress) -> Iterator[Event]:
    """The events of a branch that was walked elsewhere; `work` is told of them."""
    name, begun = work.info.name, bool(work.rows)
    for message in messages:
        if isinstance(message, Beginning):
            begun = True
            yield Began(work.info)
        elif isinstance(message, Note):
            key = _named(message.key, name)
            if key not in work.noted:  # by the other side
                work.noted.add(key)
                yield Noted(key, _named(message.text, name))
        elif isinstance(message, Point):
            special = None if message.special is None else _with_name(message.special, name)
            if message.row is not None:
                work.rows.append(message.row)
            if special is not None:
                work.special_points.append(special)
            yield Found(work.info, message.row, special)
        else:
            if not begun:  # whoever walked it has come to nothing
                yield Began(work.info)
            work.broken = message.broken
            work.outcomes += [
                (sign, replace(outcome, message=_named(outcome.message, name)))
                for sign, outcome in message.outcomes
            ]


def _named(text: str, name: str) -> str:
    return text.replace(NAMELESS, name)


def _with_name(point: SpecialPoint, name: str) -> SpecialPoint:
    if point.note is None or NAMELESS not in point.note:
        return point
    return replace(point, note=_named(point.note, name))

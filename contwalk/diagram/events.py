"""What a diagram covers, and what happens while it is computed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contwalk.branch import Branch, BranchInfo, Outcome
from contwalk.continuation.settings import Settings
from contwalk.diagram.opening import Opening
from contwalk.labels import FOLLOWED
from contwalk.problems.problem import Problem
from contwalk.special_point import SpecialPoint


@dataclass(frozen=True)
class Plan:
    """What a diagram covers: the labels that are followed, how deep, and the directions from a start.

    `parent` begins the branch that one without a known parent has returned to at a point; None where there is
    no such. `by_generation`: all starts are walked before anything that grows out of them, so that each
    branch is found in the least generation that it has, whichever points begin it; else each start is
    followed by all that grows out of it. `effort`: how many times what the first branch of a problem did
    another one may cost; `command`: what goes on with a run that has left some for later.
    """

    settings: Settings
    follow: frozenset[str] = FOLLOWED
    depth: int = 5
    directions: tuple[float, ...] = (1.0, -1.0)
    parent: Callable[[Problem, SpecialPoint, Settings], Opening | Outcome | None] = lambda *_: None
    by_generation: bool = False
    effort: float = math.inf
    command: str = ""


@dataclass(frozen=True)
class Began:
    """A branch begins."""

    info: BranchInfo


@dataclass(frozen=True)
class Found:
    """A point of the current branch, with its row, shape (1,); `special` where it is a special point.

    An end point has no row of its own (`row` is None): it is the last point's.
    """

    info: BranchInfo
    row: np.ndarray | None
    special: SpecialPoint | None


@dataclass(frozen=True)
class Cut:
    """A branch that is stored goes on: keep so many rows, and the special points of these numbers."""

    info: BranchInfo
    rows: int
    special_points: tuple[int, ...]


@dataclass(frozen=True)
class Ended:
    """The current branch ended."""

    branch: Branch


@dataclass(frozen=True)
class Dropped:
    """A branch that is stored is no branch of its own: another one has gone on to where it is.

    `known` is the other one's name.
    """

    name: str
    known: str


@dataclass(frozen=True)
class Noted:
    """Something about the diagram as a whole, under a key."""

    key: str
    text: str


Event = Began | Found | Cut | Ended | Dropped | Noted

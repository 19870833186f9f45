"""Branches cut off where a run may be killed, and whether what goes on from there has the same bits."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from contwalk.branch import Branch, SpecialPoint
from contwalk.diagram.branch_in_progress import Stored
from contwalk.diagram.events import Event, Found


def bits(branch: Branch) -> bytes:
    """All that is stored of a branch's points but the time that they took."""
    rows = branch.points.copy()
    rows["seconds"] = 0.0
    return rows.tobytes()


def assert_same(ours: Branch, theirs: Branch, told: object = None) -> None:
    """Two branches have the same bits, special points and outcome."""
    assert bits(ours) == bits(theirs), told
    assert ours.special_points == theirs.special_points, told
    assert ours.outcome == theirs.outcome, told


def kept(branch: Branch) -> Stored:
    """A branch that is stored whole: its rows in the order in which they were walked."""
    order = branch.points[np.argsort(branch.points["s"] < 0.0, kind="stable")]
    return Stored(order, list(branch.special_points), branch.outcome)


@dataclass
class Appended:
    """What was appended of a branch, event by event: any number of rows and special points may be there."""

    rows: list[np.ndarray] = field(default_factory=list)
    points: list[SpecialPoint] = field(default_factory=list)
    sizes: list[tuple[int, int]] = field(default_factory=list)

    @classmethod
    def of(cls, events: Iterable[Event], name: str) -> Appended:
        """The branch of a name."""
        found = cls()
        for event in events:
            if isinstance(event, Found) and event.info.name == name:
                found.rows += [] if event.row is None else [event.row]
                found.points += [] if event.special is None else [event.special]
                found.sizes.append((len(found.rows), len(found.points)))
        return found

    @property
    def images(self) -> list[int]:
        """The events that are of the half towards negative s."""
        return [k for k, (n, _) in enumerate(self.sizes) if self.rows[n - 1]["s"][0] < 0.0]

    def cut(self, k: int) -> Stored:
        """What is stored where a run is killed after an event."""
        n, m = self.sizes[k]
        return Stored(np.concatenate(self.rows[:n]), self.points[:m], None)

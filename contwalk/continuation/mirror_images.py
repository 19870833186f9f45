"""The half of a branch that is the image of the other one: known, and not walked.

What a walk of one half stored is taken over step by step through the symmetry, in the order of the walk. Each
solution is checked by its own equations; where one does not satisfy them, the walk goes on from the last that
does.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from contwalk.branch import BranchInfo, Outcome, SpecialPoint
from contwalk.continuation.settings import Settings
from contwalk.problems.images import in_words
from contwalk.problems.problem import Mirror

# Columns that tell of the computation and differ from one to the next.
TIMED = ("seconds",)
# Ends whose sentences are true of both halves as they stand.
ALIKE = ("bound", "max_points")
# A marked observable is the same on both halves if it differs by no more than this part of itself.
SAME = 1e-9

Entry = tuple[np.ndarray, SpecialPoint | None]


@dataclass(frozen=True)
class Half:
    """What the walk of one half stored: the rows of each step, special points before where it arrived."""

    steps: list[list[Entry]]
    end: SpecialPoint

    @classmethod
    def of(cls, rows: list[np.ndarray], points: list[SpecialPoint], sign: float) -> Half | None:
        """The half of a branch on one side of its start; None where it has no solution, or no end."""
        records = iter([p for p in points if p.s * sign > 0.0 and p.label != "EP"])
        ends = [p for p in points if p.s * sign > 0.0 and p.label == "EP"]
        steps: list[list[Entry]] = [[]]
        for row in rows:
            if not row["s"][0] * sign > 0.0:
                continue
            special = bool(row["special"][0])
            steps[-1].append((row, next(records) if special else None))
            if not special:
                steps.append([])
        if not (ends and steps[0] and any(point is None for _, point in steps[0])):
            return None
        return cls([step for step in steps if step], ends[-1])

    def entries(self) -> Iterator[Entry]:
        """All rows in the order in which they were walked."""
        for step in self.steps:
            yield from step

    def after(self, count: int) -> Iterator[list[Entry]]:
        """The steps that follow so many rows."""
        for step in self.steps:
            if count <= 0:
                yield step
            count -= len(step)


def watched(settings: Settings, free: str, names: tuple[str, ...]) -> list[int]:
    """Numbers of the observables whose values are looked for along a branch."""
    asked = {mark.name for mark in settings.sought} - {free}
    return [number for number, name in enumerate(names) if name in asked]


def differing(mirror: Mirror, half: Half, numbers: list[int]) -> int | None:
    """Number of the first of some observables that is another on the image of a half; None if there is none.

    Its values are met elsewhere on the image, and have to be looked for.
    """
    if not numbers:
        return None
    pairs = [(row, image) for row, _ in half.entries() if (image := mirror.row(row[0])) is not None]
    for number in numbers:
        here, there = (
            np.array([own["observables"][0, number] for own in side]) for side in zip(*pairs, strict=True)
        )
        largest = float(np.max(np.abs(here), initial=0.0, where=np.isfinite(here)))
        if not np.allclose(here, there, rtol=SAME, atol=SAME * largest, equal_nan=True):
            return number
    return None


def continues(mirror: Mirror, half: Half, done: list[np.ndarray]) -> bool:
    """Whether the rows that are there already are images of a half's first ones, and not walked."""
    if not done:
        return True
    before = [row for row, _ in half.entries()][: len(done)]
    image = mirror.row(before[-1][0]) if len(before) == len(done) else None
    return image is not None and same_rows(image, done[-1])


def imaged(mirror: Mirror, step: list[Entry]) -> list[Entry] | None:
    """The image of what a step stored; None where a solution does not satisfy the equations."""
    found: list[Entry] = []
    for row, point in step:
        image = mirror.row(row[0])
        if image is None:
            return None
        found.append((image, None if point is None else mirror.special_point(point)))
    return found


def same_rows(a: np.ndarray, b: np.ndarray) -> bool:
    """Whether two rows are the same to the last bit, but for the time that they took."""
    a, b = a.copy(), b.copy()
    for column in TIMED:
        a[column] = b[column] = 0.0
    return a.tobytes() == b.tobytes()


def end_of_image(mirror: Mirror, end: SpecialPoint, outcome: Outcome) -> tuple[Outcome, SpecialPoint]:
    """How the image of a half ends, with the record of its end."""
    message = outcome.message
    if outcome.reason not in ALIKE:
        message = f"As the other half, of which it is the image under {in_words(mirror.names)}: {message}"
    return replace(outcome, message=message), replace(mirror.special_point(end), note=message)


def told(info: BranchInfo, mirror: Mirror, count: int) -> str:
    """That a half is the image of the other one, and what was done."""
    return (
        f"{info.name}: its half towards negative s is the image of the other one under "
        f"{in_words(mirror.names)}. It was not walked: its {count} points are images, each checked by the "
        "equations."
    )


def told_walked(info: BranchInfo, mirror: Mirror, why: str) -> str:
    """That a half is walked although it is the image of the other one."""
    return (
        f"{info.name}: its half towards negative s should be the image of the other one under "
        f"{in_words(mirror.names)}, but {why}. It was walked."
    )

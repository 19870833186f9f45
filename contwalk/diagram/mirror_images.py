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
from contwalk.labels import END
from contwalk.problems.images import in_words
from contwalk.problems.problem import Mirror

# Columns that tell of the computation and differ from one to the next.
TIMED = ("seconds",)
# Ends whose sentences are true of both halves as they stand.
ALIKE = ("bound", "max_points", "effort")
# A marked observable is the same on both halves if it differs by no more than this part of itself.
SAME = 1e-6


@dataclass(frozen=True)
class Entry:
    """A stored row, the regular one from which the walk stepped to it, and the special point that it is.

    Rows have the shape (1,).
    """

    row: np.ndarray
    before: np.ndarray
    point: SpecialPoint | None

    def image(self, mirror: Mirror, last: np.ndarray) -> np.ndarray | None:
        """The row's image, one record of shape (1,); None where it does not satisfy the equations.

        `last` is that of the row before, shape (1,).
        """
        return mirror.row(self.row[0], self.before[0], last[0])


@dataclass(frozen=True)
class Half:
    """What the walk of one half stored: the rows of each step, special points before where it arrived.

    The start has the shape (1,).
    """

    steps: list[list[Entry]]
    end: SpecialPoint
    start: np.ndarray

    @classmethod
    def of(cls, rows: list[np.ndarray], points: list[SpecialPoint], sign: float) -> Half | None:
        """The half of a branch on one side of its start; None where it has no solution, or no end.

        `rows` are all stored ones, the start first, of shape (1,) each.
        """
        records = iter([p for p in points if p.s * sign > 0.0 and p.label != END])
        ends = [p for p in points if p.s * sign > 0.0 and p.label == END]
        steps: list[list[Entry]] = [[]]
        before = rows[0]
        for row in rows:
            if not row["s"][0] * sign > 0.0:
                continue
            special = bool(row["special"][0])
            steps[-1].append(Entry(row, before, next(records) if special else None))
            if not special:
                before = row
                steps.append([])
        if not (ends and len(steps) > 1):
            return None
        return cls([step for step in steps if step], ends[-1], rows[0])

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
    compared: list[tuple[np.ndarray, np.ndarray]] = []
    last = half.start
    for step in half.steps:
        images = imaged(mirror, step, last)
        if isinstance(images, str):
            break
        for entry, (image, _) in zip(step, images, strict=True):
            compared.append((entry.row["observables"][0, numbers], image["observables"][0, numbers]))
        last = images[-1][0]
    if not compared:
        return None
    own, there = (np.array(side) for side in zip(*compared, strict=True))
    for k, number in enumerate(numbers):
        largest = float(np.max(np.abs(own[:, k]), initial=0.0, where=np.isfinite(own[:, k])))
        if not np.allclose(own[:, k], there[:, k], rtol=SAME, atol=SAME * largest, equal_nan=True):
            return number
    return None


def continues(mirror: Mirror, half: Half, done: list[np.ndarray]) -> bool:
    """Whether the rows that are there already are images of a half's first ones, and not walked.

    `done` are the rows, of shape (1,) each.
    """
    if not done:
        return True
    walked = list(half.entries())[: len(done)]
    if len(walked) != len(done):
        return False
    before = [half.start, *(row for row in done[:-1] if not row["special"][0])]
    image = walked[-1].image(mirror, before[-1])
    return image is not None and same_rows(image, done[-1])


def imaged(
    mirror: Mirror, step: list[Entry], last: np.ndarray
) -> list[tuple[np.ndarray, SpecialPoint | None]] | str:
    """The image of what a step stored, or in words why it is to be walked.

    `last` is the image of the row that it was a step from; each row has the shape (1,).
    """
    found: list[tuple[np.ndarray, SpecialPoint | None]] = []
    for entry in step:
        if entry.point is not None and (why := mirror.refuses(entry.point)):
            return why
        image = entry.image(mirror, last)
        if image is None:
            return "the images do not satisfy the equations"
        if image["admissible"][0] != entry.row["admissible"][0]:
            return "what limits the machine is not alike on both"
        point = None
        if entry.point is not None:
            point = mirror.special_point(entry.point, entry.row[0], last[0])
        found.append((image, point))
    return found


def same_rows(a: np.ndarray, b: np.ndarray) -> bool:
    """Whether two rows, shape (1,) each, are the same to the last bit, but for the time that they took."""
    a, b = a.copy(), b.copy()
    for column in TIMED:
        a[column] = b[column] = 0.0
    return a.tobytes() == b.tobytes()


def end_of_image(
    info: BranchInfo, mirror: Mirror, end: SpecialPoint, outcome: Outcome, row: np.ndarray
) -> tuple[Outcome, SpecialPoint]:
    """How the image of a half ends, with the record of its end, which is its last row, shape (1,)."""
    message = outcome.message
    if outcome.reason not in ALIKE:
        message = f"As the other half, of which it is the image under {in_words(mirror.names)}: {message}"
    size = int(np.sum(np.isfinite(row["unknowns"][0])))
    record = replace(
        end,
        s=float(row["s"][0]),
        state=dict(zip(info.states, row["state"][0].tolist(), strict=True)),
        unknowns=(*row["unknowns"][0, :size].tolist(), float(row["free"][0, 0])),
        tangent=tuple(row["tangent"][0, : size + 1].tolist()),
        admissible=bool(row["admissible"][0]),
        margin=mirror.margin(row[0]),
        note=message,
    )
    return replace(outcome, message=message), record


def image_sentence(info: BranchInfo, mirror: Mirror, count: int) -> str:
    """That a half is the image of the other one, and what was done."""
    return (
        f"{info.name}: its half towards negative s is the image of the other one under "
        f"{in_words(mirror.names)}. It was not computed: its {count} points are images, each checked by the "
        "equations."
    )


def walked_sentence(info: BranchInfo, mirror: Mirror, count: int, why: str) -> str:
    """That a half is walked although it is the image of the other one, from the row after so many on."""
    under = f"under {in_words(mirror.names)}"
    if not count:
        return (
            f"{info.name}: its half towards negative s is the image of the other one {under}, but {why}: it "
            "was computed."
        )
    return (
        f"{info.name}: its half towards negative s is the image of the other one {under}: {count} points are "
        f"images, each checked by the equations. It was computed from there on, since {why}."
    )

"""Who is told what happens while a study is computed, and how far it has come."""

from __future__ import annotations

from types import TracebackType
from typing import Self

from contwalk.branch import Branch, BranchInfo, SpecialPoint


class Reporter:
    """Told what happens while it happens. Every method does nothing unless overridden."""

    def branch_began(self, info: BranchInfo) -> None:
        """A branch begins, or goes on."""

    def point(self, info: BranchInfo, parameter: float, step: float, unstable: int, number: int) -> None:
        """Point `number` of the branch was stored."""

    def special(self, info: BranchInfo, point: SpecialPoint) -> None:
        """A special point was stored."""

    def branch_ended(self, branch: Branch) -> None:
        """A branch ended."""

    def note(self, text: str) -> None:
        """Something about the run as a whole."""

    def interrupted(self, sentence: str) -> None:
        """Ctrl-C came; the sentence says what is kept and how the run goes on."""


class NoteKeeper(Reporter):
    """Keeps the notes; watches while it is entered."""

    def __init__(self) -> None:
        self.notes: list[str] = []

    def note(self, text: str) -> None:
        """Keep a note, once."""
        if text not in self.notes:
            self.notes.append(text)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Nothing to release."""


class Visited:
    """What part of a range each branch has passed.

    Parameters
    ----------
    ends : tuple of float
        The range of the free parameter.
    """

    def __init__(self, ends: tuple[float, float]) -> None:
        self._width = ends[1] - ends[0]
        self._seen: dict[str, tuple[float, float]] = {}

    def part(self, name: str, parameter: float) -> float:
        """The part, 0 to 1, with this value of the branch `name`."""
        low, high = self._seen.get(name, (parameter, parameter))
        self._seen[name] = low, high = min(low, parameter), max(high, parameter)
        return min((high - low) / self._width, 1.0) if self._width > 0.0 else 0.0


def point_words(info: BranchInfo, parameter: float, step: float, unstable: int, number: int) -> str:
    """`b1  B = 2.31  step 1.0e-02  unstable 2  point 57`, of what `Reporter.point` is told."""
    where = f"{info.name}  {info.free[0]} = {parameter:.6g}  step {step:.1e}"
    return f"{where}  unstable {unstable}  point {number}"

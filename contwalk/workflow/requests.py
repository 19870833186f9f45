"""What processes that walk branches are asked, and what they answer."""

from __future__ import annotations

from dataclasses import dataclass

from contwalk.diagram.ahead import Message, Task
from contwalk.workflow.study_text import StudyText


@dataclass(frozen=True)
class Reported:
    """One message of a branch."""

    message: Message


@dataclass(frozen=True)
class Finished:
    """All of the branch has been told."""


@dataclass(frozen=True)
class Failed:
    """The branch cannot be walked here."""

    trace: str


Answer = Reported | Finished | Failed


@dataclass(frozen=True)
class Walk:
    """A request: this branch."""

    study: StudyText
    task: Task


@dataclass(frozen=True)
class Drop:
    """A request: this branch is not wanted any more."""

    task: Task

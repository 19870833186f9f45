"""What a check of a plugin found, each finding with its place in the plugin."""

from __future__ import annotations

import re
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from contwalk.python_functions import place_of

__all__ = ["Finding", "Place", "Report", "place_of", "place_of_error", "split_place", "split_switch"]

LEVELS = ("ok", "warning", "error")
Place = tuple[str | None, int | None]
NOWHERE: Place = (None, None)

_PLACE = re.compile(r"(?P<file>.+?), line (?P<line>\d+): (?P<rest>.*)", re.DOTALL)


@dataclass(frozen=True)
class Finding:
    """One thing that was checked.

    Parameters
    ----------
    level : str
        `ok`, `warning` (the plugin works, but something is missing or doubtful) or `error`.
    what : str
        What was checked: `field of mode 'smooth'`.
    sentence : str
        What was found, and for a warning or an error what to do.
    file, line : str and int, optional
        The place in the plugin: of the responsible statement if it is known, else of its function.
    model : str
        The model choices it was found with, as `masses=3`; empty for the system as it is.
    """

    level: str
    what: str
    sentence: str
    file: str | None = None
    line: int | None = None
    model: str = ""


@dataclass
class Report:
    """Findings so far."""

    model: str = ""
    findings: list[Finding] = field(default_factory=list)
    _noted: set[Finding] = field(default_factory=set, init=False, repr=False)

    def add(self, level: str, what: str, sentence: str, place: Place = NOWHERE) -> None:
        """Note a finding, once."""
        finding = Finding(level, what, " ".join(sentence.split()), *place, model=self.model)
        if finding not in self._noted:
            self._noted.add(finding)
            self.findings.append(finding)

    def ok(self, what: str, sentence: str, place: Place = NOWHERE) -> None:
        """Note what is as it should be, or could not be checked."""
        self.add("ok", what, sentence, place)

    def warning(self, what: str, sentence: str, place: Place = NOWHERE) -> None:
        """Note what is missing or doubtful."""
        self.add("warning", what, sentence, place)

    def error(self, what: str, sentence: str, place: Place = NOWHERE) -> None:
        """Note what is wrong."""
        self.add("error", what, sentence, place)


def place_of_error(error: BaseException, function: Callable[..., Any] | None) -> Place:
    """The innermost line in the function's file that an exception came through; else where it begins."""
    file, line = place_of(function)
    for frame in reversed(traceback.extract_tb(error.__traceback__)):
        if frame.filename == file:
            return frame.filename, frame.lineno
    return file, line


def split_place(text: str, otherwise: Place = NOWHERE) -> tuple[Place, str]:
    """`file, line n: what` as its place and `what`; text without a place gets another one."""
    match = _PLACE.fullmatch(text)
    if match is None:
        return otherwise, text.removeprefix("the plugin: ")
    return (match["file"], int(match["line"])), match["rest"]


def split_switch(where: str) -> tuple[Place, str]:
    """`file, line n (what)`, where a choice switches, as its place and `what`."""
    line, _, what = where.partition(" (")
    place, _ = split_place(f"{line}: ")
    return place, what.removesuffix(")")

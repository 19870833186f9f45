"""What is wrong with a run file: a clear line for each problem, raised together in the order of the file."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from contwalk.errors import RunFileError
from contwalk.system.declarations import nearest
from contwalk.workflow.run_file.document import Document, Key

MOST_SHOWN = 20


class Problems:
    """Problems found so far, each with the key path it belongs to."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self._found: list[tuple[float, str, str]] = []

    def add(self, key: Key, sentence: str, remedy: str = "") -> None:
        """Note a problem: `sentence` says what is wrong with the key, `remedy` what is allowed."""
        _, origin = self.document.locate(key)
        order = origin if isinstance(origin, int) else float("inf") if isinstance(origin, str) else 0
        entry = (order, f"{self.document.where(key)}: {sentence}", remedy)
        if entry not in self._found:
            self._found.append(entry)

    def raise_any(self) -> None:
        """Raise all problems as one `RunFileError`; nothing if there is none."""
        if self._found:
            raise self.error()

    def error(self) -> RunFileError:
        """All problems, of which there is at least one, as one error: first in the file first."""
        (_, sentence, remedy), *others = sorted(self._found, key=lambda entry: entry[0])
        lines = [f"{what} {allowed}".strip() for _, what, allowed in others]
        if len(lines) > MOST_SHOWN:
            lines = [*lines[:MOST_SHOWN], f"... and {len(lines) - MOST_SHOWN} more problems."]
        return RunFileError(sentence, "\n".join([remedy, *lines]).rstrip())


def closest(name: str, known: Iterable[str]) -> str:
    """As `nearest`, and blind to upper and lower case where nothing is near as written."""
    names = list(known)
    folded = {candidate.lower(): candidate for candidate in reversed(names)}
    match = folded.get(name.lower())
    return f"Did you mean '{match}'?" if match else nearest(name, names)


def allowed(known: Sequence[str], name: str = "") -> str:
    """`Allowed: a, b, c. Did you mean 'b'?`"""
    return f"Allowed: {', '.join(known) or 'none'}. {closest(name, known)}".strip()

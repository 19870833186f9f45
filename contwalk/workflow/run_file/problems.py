"""What is wrong with a run file, one clear line for each problem.

`Problems` collects them in the order of the file and raises them together; `translate` turns what is wrong
with the form of the file into them.
"""

from __future__ import annotations

from contwalk.errors import RunFileError
from contwalk.workflow.run_file.faults import Invalid
from contwalk.workflow.run_file.model import RunModel
from contwalk.workflow.run_file.names import allowed
from contwalk.workflow.run_file.section import Section
from contwalk.workflow.run_file.yaml_lines import Document, Key

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


def translate(error: Invalid, problems: Problems) -> None:
    """Add each fault of the form as a problem."""
    for fault in error.faults:
        section, remedy = fault.unknown_in, fault.remedy
        if section is not None and issubclass(section, Section):
            name = str(fault.at[-1])
            remedy = allowed(section.known_keys(), name) + _belongs_elsewhere(name, section)
        problems.add(fault.at, fault.sentence, remedy)


def _belongs_elsewhere(name: str, section: type[Section]) -> str:
    """Where a key that is unknown here would be known."""
    if section is not RunModel:
        at_top = name in RunModel.known_keys()
        return f" '{name}' is a key of the file itself: write it without indentation." if at_top else ""
    for top in RunModel.keys.values():
        if top.inside is not None and name in top.inside.known_keys():
            return f" '{name}' is a key of '{top.written}'."
    return ""

"""What is wrong with a run file, one clear line for each problem.

`Problems` collects them in the order of the file and raises them together; `translate` turns the errors of
pydantic into them.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from contwalk.errors import RunFileError
from contwalk.system.declarations import nearest
from contwalk.workflow.run_file.model import RunModel, Section
from contwalk.workflow.run_file.yaml_lines import Document, Key, shown

MOST_SHOWN = 20
_KINDS = {
    "model_type": "a mapping {key: value}",
    "model_attributes_type": "a mapping {key: value}",
    "dict_type": "a mapping {key: value}",
    "tuple_type": "a list",
    "string_type": "a text",
    "int_type": "a whole number",
}


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


def translate(error: ValidationError, problems: Problems) -> None:
    """Add each error of pydantic as a problem in the words of a run file."""
    for detail in error.errors(include_url=False):
        key = tuple(detail["loc"])
        section, info = _schema_at(key)
        sentence, remedy = _words(detail, section)
        if not remedy and info is not None and info.description:
            remedy = f"Allowed: {info.description}."
        problems.add(key, sentence, remedy)


def _words(detail: ErrorDetails, section: type[Section]) -> tuple[str, str]:
    """Sentence and remedy of one error; an empty remedy is filled from the field's description."""
    kind, value, context = detail["type"], detail["input"], detail.get("ctx", {})
    if kind == "wrong":
        return context["sentence"], context["remedy"]
    if kind == "missing":
        return "the key is missing.", ""
    if kind == "extra_forbidden":
        name = str(detail["loc"][-1])
        return "unknown key.", allowed(section.known_keys(), name) + _belongs_elsewhere(name, section)
    if kind in _KINDS:
        return f"is {shown(value)}, which is not {_KINDS[kind]}.", ""
    if kind == "literal_error":
        names = re.findall(r"'([^']*)'", str(context["expected"]))
        return f"is {shown(value)}.", allowed(names, value) if names and isinstance(value, str) else ""
    if kind in ("greater_than_equal", "less_than_equal"):
        return f"is {shown(value)}.", ""
    return f"is {shown(value)}: {detail['msg']}.", ""


def _belongs_elsewhere(name: str, section: type[Section]) -> str:
    """Where a key that is unknown here would be known."""
    if section is not RunModel:
        at_top = name in RunModel.known_keys()
        return f" '{name}' is a key of the file itself: write it without indentation." if at_top else ""
    for top, info in RunModel.model_fields.items():
        inner = _section_in(info.annotation)
        if inner is not None and name in inner.known_keys():
            return f" '{name}' is a key of '{info.alias or top}'."
    return ""


def _schema_at(key: Key) -> tuple[type[Section], FieldInfo | None]:
    """The section that a key path leads into, and the deepest field on the way."""
    section: type[Section] = RunModel
    field: FieldInfo | None = None
    for part in key:
        for name, info in section.model_fields.items():
            if part == (info.alias or name):
                field = info
                section = _section_in(info.annotation) or section
                break
    return section, field


def _section_in(annotation: Any) -> type[Section] | None:
    """The section named in a type, as in `tuple[Start, ...] | None`."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation if issubclass(annotation, Section) else None
    for part in get_args(annotation):
        found = _section_in(part)
        if found is not None:
            return found
    return None

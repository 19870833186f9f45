"""Errors of pydantic in the words of a run file."""

from __future__ import annotations

import re
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from contwalk.workflow.run_file.document import Key, shown
from contwalk.workflow.run_file.model import RunModel, Section
from contwalk.workflow.run_file.problems import Problems, allowed

_KINDS = {
    "model_type": "a mapping {key: value}",
    "model_attributes_type": "a mapping {key: value}",
    "dict_type": "a mapping {key: value}",
    "tuple_type": "a list",
    "string_type": "a text",
    "int_type": "a whole number",
}


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

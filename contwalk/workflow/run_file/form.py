"""The form of a run file checked: YAML with its lines, `--set` values, keys and types."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from contwalk.errors import RunFileError
from contwalk.workflow.run_file.document import Document, shown
from contwalk.workflow.run_file.form_errors import translate
from contwalk.workflow.run_file.model import RunModel, Section
from contwalk.workflow.run_file.overrides import apply_override
from contwalk.workflow.run_file.problems import Problems
from contwalk.workflow.run_file.yaml_lines import parse_yaml

VERSION = 1


def checked_form(text: str, name: str, overrides: Sequence[str]) -> tuple[Document, RunModel]:
    """A run file's data with its `--set` values, and what its keys say.

    Raises
    ------
    RunFileError
        For every problem, with file, line and key.
    """
    document = document_of(text, name, overrides)
    problems = Problems(document)
    _check_version(problems)
    try:
        return document, RunModel.model_validate(document.data)
    except ValidationError as error:
        translate(error, problems)
        raise problems.error() from None


def document_of(text: str, name: str, overrides: Sequence[str]) -> Document:
    """The data of a run file, a mapping, with the `--set` values put in."""
    data, lines = parse_yaml(text, name)
    if data is None:
        raise RunFileError(
            f"{name} is empty.",
            "Give at least system, start and continue; contwalk init SYSTEM writes a file.",
        )
    if not isinstance(data, dict):
        raise RunFileError(
            f"{name}, line 1: the file is {shown(data)}, not a mapping of keys.",
            f"Write lines KEY: VALUE. Allowed: {', '.join(RunModel.known_keys())}.",
        )
    document = Document(name, data, lines)
    for override in overrides:
        apply_override(document, override)
    return document


def _check_version(problems: Problems) -> None:
    """A newer format first: its other keys would only seem to be wrong."""
    version = problems.document.data.get("contwalk")
    if isinstance(version, int) and version > VERSION:
        problems.add(
            ("contwalk",),
            f"the file has format {version}, newer than this contwalk reads.",
            f"Allowed: {VERSION}. Update contwalk, or rewrite the file in format {VERSION}.",
        )
        problems.raise_any()


def study_of(other: str | Mapping[str, Any]) -> dict[str, Any] | None:
    """What decides the branches of a run file, by key, from its text or data; None where it is none."""
    try:
        data = parse_yaml(other, "the stored run file")[0] if isinstance(other, str) else other
        return RunModel.model_validate(data).model_dump(
            exclude={"author", "description", "output", "figures", "simulate", "sample", "margins"}
        )
    except (RunFileError, ValidationError):
        return None


def allowed_start() -> str:
    """What may stand under `start`."""
    return f"Allowed: {RunModel.model_fields['start'].description}."


def written_out(value: Any) -> Any:
    """A checked section as numbers, texts, tuples, mappings and lists, for `kept_form.read_back`.

    Raises
    ------
    TypeError
        If it holds anything else.
    """
    if isinstance(value, Section):
        values = {name: written_out(getattr(value, name)) for name in type(value).model_fields}
        return ["section", values, sorted(value.model_fields_set)]
    if isinstance(value, list):
        return ["list", [written_out(each) for each in value]]
    if isinstance(value, tuple):
        return tuple(written_out(each) for each in value)
    if isinstance(value, dict):
        return {key: written_out(each) for key, each in value.items()}
    if value is None or type(value) in (bool, int, float, str):
        return value
    raise TypeError(f"{type(value).__name__} is not written out")

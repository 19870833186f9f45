"""Forms of values in a run file: functions that give a value as it is used, or raise what is wrong."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from contwalk.workflow.run_file.faults import Fault, Invalid, wrong
from contwalk.workflow.run_file.names import allowed
from contwalk.workflow.run_file.yaml_lines import shown

Form = Callable[[Any], Any]


def anything(value: Any) -> Any:
    """Whatever it is."""
    return value


def text(value: Any) -> str:
    """A text."""
    if not isinstance(value, str):
        raise wrong(f"is {shown(value)}, which is not a text.")
    return value


def whole(least: int, most: int | None = None) -> Form:
    """A whole number within bounds; true and false are none."""

    def check(value: Any) -> int:
        if isinstance(value, bool) or not isinstance(value, int):
            raise wrong(f"is {shown(value)}, which is not a whole number.")
        if value < least or (most is not None and value > most):
            raise wrong(f"is {shown(value)}.")
        return value

    return check


def one_of(*names: str) -> Form:
    """One of some words."""

    def check(value: Any) -> str:
        if not isinstance(value, str):
            raise wrong(f"is {shown(value)}.")
        if value not in names:
            raise wrong(f"is {shown(value)}.", allowed(names, value))
        return value

    return check


def as_tuple(value: Any) -> Any:
    """A list as a tuple; a single value as a tuple of one; null stays."""
    if value is None or isinstance(value, tuple):
        return value
    return tuple(value) if isinstance(value, list) else (value,)


def list_of(form: Form, written: Callable[[Any], Any] = as_tuple) -> Form:
    """A list of such values, as a tuple; `written` makes one of other ways to write it."""

    def check(value: Any) -> tuple[Any, ...]:
        entries = written(value)
        if not isinstance(entries, tuple):
            raise wrong(f"is {shown(entries)}, which is not a list.")
        return tuple(_each(form, enumerate(entries)).values())

    return check


def mapping_of(form: Form) -> Form:
    """Names with such values."""

    def check(value: Any) -> dict[str, Any]:
        return _each(form, as_mapping(value).items())

    return check


def as_mapping(value: Any) -> dict[str, Any]:
    """A mapping as it is."""
    if not isinstance(value, dict):
        raise wrong(f"is {shown(value)}, which is not a mapping {{key: value}}.")
    return value


def written_as(change: Callable[[Any], Any], form: Form) -> Form:
    """A form after another way to write it has been changed to it."""
    return lambda value: form(change(value))


def _each(form: Form, entries: Any) -> dict[Any, Any]:
    """Each entry in its form, by its key; what is wrong with all of them together."""
    found: dict[Any, Any] = {}
    faults: list[Fault] = []
    for key, value in entries:
        try:
            found[key] = form(value)
        except Invalid as error:
            faults += [fault.under(key) for fault in error.faults]
    if faults:
        raise Invalid(faults)
    return found

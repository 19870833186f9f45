"""Whether decoded JSON has the types that a record announces: a file may hold anything."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from functools import lru_cache
from types import NoneType, UnionType
from typing import Any, TypeVar, Union, get_args, get_origin, get_type_hints

T = TypeVar("T")
_NUMBERS: dict[Any, tuple[type, ...]] = {int: (int,), float: (int, float), complex: (int, float, complex)}


def typed(kind: type[T], stored: Any) -> T:
    """A dataclass made of stored values.

    Raises
    ------
    TypeError
        Where one of them is missing, unknown, or of another type than its field.
    """
    if not isinstance(stored, dict):
        raise TypeError(f"a record of {kind.__name__} is none")
    hints = _hints(kind)  # type: ignore[arg-type]  # a class is hashable
    for name, value in stored.items():
        if name not in hints or not _fits(value, hints[name]):
            raise TypeError(f"'{name}' of a record of {kind.__name__} is of another type")
    return kind(**stored)


def check_known(kind: Any, stored: Any) -> None:
    """Refuse a mapping that does not fit.

    Parameters
    ----------
    kind : type
        A `Mapping[...]`; or a `TypedDict`, of which keys that it does not declare may have any value.
    stored : object

    Raises
    ------
    TypeError
        Where it is none, or a value is of another type.
    """
    if get_origin(kind) is Mapping:
        if not _fits(stored, kind):
            raise TypeError("a mapping is of another type")
        return
    if not isinstance(stored, dict):
        raise TypeError(f"the {kind.__name__.lower()} are none")
    for name, hint in get_type_hints(kind).items():
        if name in stored and not _fits(stored[name], hint):
            raise TypeError(f"'{name}' of the {kind.__name__.lower()} is of another type")


@lru_cache
def _hints(kind: type) -> dict[str, Any]:
    hints = get_type_hints(kind)
    return {field.name: hints[field.name] for field in fields(kind)}


def _fits(value: Any, hint: Any) -> bool:
    if hint is Any:
        return True
    origin, arguments = get_origin(hint), get_args(hint)
    if origin in (Union, UnionType):
        return any(_fits(value, each) for each in arguments)
    if origin is tuple:
        return _is_tuple(value, arguments)
    if origin is Mapping:
        return isinstance(value, dict) and all(_fits(each, arguments[1]) for each in value.values())
    if hint in _NUMBERS:
        return isinstance(value, _NUMBERS[hint]) and not isinstance(value, bool)
    if hint is bool:
        return isinstance(value, bool)
    return isinstance(value, NoneType if hint is None else hint)


def _is_tuple(value: Any, arguments: tuple[Any, ...]) -> bool:
    if not isinstance(value, list | tuple):
        return False
    if arguments[-1] is Ellipsis:
        return all(_fits(each, arguments[0]) for each in value)
    return len(value) == len(arguments) and all(map(_fits, value, arguments))

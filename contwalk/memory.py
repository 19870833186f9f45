"""Memory of a bounded size: what has been made is made once, and the oldest of it is forgotten."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

Key = TypeVar("Key")
Value = TypeVar("Value")


def remembered(known: dict[Key, Value], key: Key, most: int, make: Callable[[], Value]) -> Value:
    """What is known under a key; made, and kept in place of the oldest of `most` entries, if nothing is."""
    if key not in known:
        while len(known) >= most:
            del known[next(iter(known))]
        known[key] = make()
    return known[key]

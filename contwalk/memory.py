"""Memory of a bounded size: what has been made is made once, and the oldest of it is forgotten."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

Key = TypeVar("Key")
Value = TypeVar("Value")
Given = ParamSpec("Given")


def remembered(known: dict[Key, Value], key: Key, most: int, make: Callable[[], Value]) -> Value:
    """What is known under a key; made, and kept in place of the oldest of `most` entries, if nothing is."""
    if key not in known:
        while len(known) >= most:
            del known[next(iter(known))]
        known[key] = make()
    return known[key]


def unowned(method: Callable[Given, Value]) -> Callable[Given, Value]:
    """A bound method that does not keep its object: for what the object itself remembers.

    Where they keep each other, large arrays wait for the collector of cycles: it counts objects, not bytes.
    """
    weak: weakref.WeakMethod[Any] = weakref.WeakMethod(method)

    def called(*args: Given.args, **kwargs: Given.kwargs) -> Value:
        own = weak()
        assert own is not None, "what is remembered of an object is asked for while there is the object"
        return own(*args, **kwargs)

    return called

"""Memory of a bounded size: what has been made is made once, and the oldest of it is forgotten."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import Any, Concatenate, Generic, ParamSpec, TypeVar, overload

Key = TypeVar("Key")
Value = TypeVar("Value")
Given = ParamSpec("Given")
Owner = TypeVar("Owner")


class computed_once(Generic[Value]):
    """A property that is computed when it is first asked for, as `functools.cached_property`.

    That one takes a lock in Python 3.11, which costs more than much of what is computed here. Two threads
    that ask at once may both compute it.
    """

    def __init__(self, method: Callable[[Any], Value]) -> None:
        self._method, self._name, self.__doc__ = method, method.__name__, method.__doc__

    @overload
    def __get__(self, owner: None, kind: type) -> computed_once[Value]: ...
    @overload
    def __get__(self, owner: object, kind: type) -> Value: ...
    def __get__(self, owner: object | None, kind: type) -> computed_once[Value] | Value:
        if owner is None:
            return self
        value = owner.__dict__[self._name] = self._method(owner)
        return value


def remembered(known: dict[Key, Value], key: Key, most: int, make: Callable[[], Value]) -> Value:
    """What is known under a key; made, and kept in place of the oldest of `most` entries, if nothing is."""
    if key not in known:
        while len(known) >= most:
            del known[next(iter(known))]
        known[key] = make()
    return known[key]


def memory_of(owner: object, what: str) -> dict[Any, Any]:
    """What is remembered of an object under a name, for `remembered`: it goes when the object goes.

    What is made of a system keeps the system. In a dictionary of a module both would stay as long as the
    process; with the system they are a circle that the collector finds.
    """
    known: dict[Any, Any] = vars(owner).setdefault("_memory", {}).setdefault(what, {})
    return known


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


def of_unowned(function: Callable[Concatenate[Owner, Given], Value], owner: Owner) -> Callable[Given, Value]:
    """A function of an object that does not keep it, as `unowned` of a method."""
    weak = weakref.ref(owner)

    def called(*args: Given.args, **kwargs: Given.kwargs) -> Value:
        own = weak()
        assert own is not None, "what is remembered of an object is asked for while there is the object"
        return function(own, *args, **kwargs)

    return called

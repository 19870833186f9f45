"""Data classes that cost little to define: what `dataclasses` would compile is shared, or made when needed.

The decorator of the standard library compiles up to six methods of every class, 0.6 ms each time the class is
imported. That was a quarter of a process before its first point, and most of these classes have no instance
in a given run.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from operator import attrgetter
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any

__all__ = ["dataclass"]

if TYPE_CHECKING:
    from dataclasses import dataclass
else:

    def dataclass(
        kind: type | None = None,
        /,
        *,
        frozen: bool = False,
        eq: bool = True,
        repr: bool = True,
        kw_only: bool = False,
    ) -> Any:
        """As `dataclasses.dataclass`, of these options.

        To `dataclasses` itself no such class is frozen, so that it inherits from none of its frozen ones.
        """

        def made(kind: type) -> type:
            own = vars(kind)
            hashed = "__hash__" in own and not (own["__hash__"] is None and "__eq__" in own)
            (_OF_NAMES_ONLY if kw_only else _FIELDS_ONLY)(kind)
            fields = dataclasses.fields(kind)
            methods = {"__init__": _first_init(kind, frozen)}
            if repr:
                methods["__repr__"] = _repr(tuple(f.name for f in fields if f.repr))
            if eq:
                methods["__eq__"] = _eq(_values_of([f.name for f in fields if f.compare]))
            for name, method in methods.items():
                if name not in vars(kind):
                    _put(kind, name, method)
            if frozen:
                _freeze(kind, frozenset(f.name for f in fields))
            if eq and not hashed:
                _put(kind, "__hash__", _hash(fields) if frozen else None)
            return kind

        return made if kind is None else made(kind)


_FIELDS_ONLY = dataclasses.dataclass(init=False, repr=False, eq=False)
_OF_NAMES_ONLY = dataclasses.dataclass(init=False, repr=False, eq=False, kw_only=True)


def _put(kind: type, name: str, method: Callable[..., Any] | None) -> None:
    if method is not None:
        method.__qualname__ = f"{kind.__qualname__}.{name}"
        method.__module__ = kind.__module__
    setattr(kind, name, method)


def _values_of(names: Sequence[str]) -> Callable[[Any], tuple[Any, ...]]:
    """The values of some attributes of an object."""
    if len(names) > 1:
        return attrgetter(*names)
    return lambda of: tuple(getattr(of, name) for name in names)


def _repr(names: Sequence[str]) -> Callable[[Any], str]:
    @recursive_repr()
    def __repr__(self: Any) -> str:
        return f"{type(self).__qualname__}({', '.join(f'{name}={getattr(self, name)!r}' for name in names)})"

    return __repr__


def _eq(values: Callable[[Any], tuple[Any, ...]]) -> Callable[[Any, object], bool]:
    def __eq__(self: Any, other: object) -> bool:
        return values(self) == values(other) if other.__class__ is self.__class__ else NotImplemented

    return __eq__


def _hash(fields: Sequence[dataclasses.Field[Any]]) -> Callable[[Any], int]:
    values = _values_of([f.name for f in fields if (f.compare if f.hash is None else f.hash)])

    def __hash__(self: Any) -> int:
        return hash(values(self))

    return __hash__


def _freeze(kind: type, names: frozenset[str]) -> None:
    """Refuse to change fields of instances, and any attribute of those that are of this very class."""

    def __setattr__(self: Any, name: str, value: Any) -> None:
        if type(self) is kind or name in names:
            raise dataclasses.FrozenInstanceError(f"cannot assign to field {name!r}")
        super(kind, self).__setattr__(name, value)  # type: ignore[arg-type]

    def __delattr__(self: Any, name: str) -> None:
        if type(self) is kind or name in names:
            raise dataclasses.FrozenInstanceError(f"cannot delete field {name!r}")
        super(kind, self).__delattr__(name)  # type: ignore[arg-type]

    for method in (__setattr__, __delattr__):
        if method.__name__ in vars(kind):
            raise TypeError(f"{kind.__name__} is frozen and has {method.__name__}")
        _put(kind, method.__name__, method)


# -- the initializer -----------------------------------------------------------------------------------------


def _first_init(kind: type, frozen: bool) -> Callable[..., None]:
    """What stands for `__init__` until there is an instance: it puts the compiled one in its place."""

    def __init__(self: Any, *given: Any, **named: Any) -> None:
        made = _compiled_init(kind, frozen)
        _put(kind, "__init__", made)
        made(self, *given, **named)

    return __init__


def _compiled_init(kind: type, frozen: bool) -> Callable[..., None]:
    known: dict[str, Any] = {"_absent": _ABSENT}
    free: list[str] = []
    named: list[str] = []
    body: list[str] = []
    for f in dataclasses.fields(kind):
        value, factory = f.name, f.default_factory is not dataclasses.MISSING
        if factory:
            known[f"_made_{f.name}"] = f.default_factory
            value = (
                f"_made_{f.name}() if {f.name} is _absent else {f.name}" if f.init else f"_made_{f.name}()"
            )
        if f.init:
            default = f"_default_{f.name}"
            known[default] = _ABSENT if factory else f.default
            has_default = factory or f.default is not dataclasses.MISSING
            (named if f.kw_only else free).append(f"{f.name}={default}" if has_default else f.name)
        if f.init or factory:
            body.append(f" _own['{f.name}'] = {value}" if frozen else f" self.{f.name} = {value}")
    if hasattr(kind, "__post_init__"):
        body.append(" self.__post_init__()")
    arguments = ", ".join(["self", *free, *(["*", *named] if named else [])])
    if frozen:  # past its own `__setattr__`, and at once
        body.insert(0, " _own = self.__dict__")
    exec("\n".join([f"def __init__({arguments}):", *(body or [" pass"])]), known)
    made: Callable[..., None] = known["__init__"]
    return made


_ABSENT = object()

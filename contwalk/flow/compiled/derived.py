"""What is derived from a field's graph, kept on disk: the pattern of its Jacobian, and the texts to compile.

Texts are kept rather than where compiled code is, so that code that is no longer there can be made from them.
All that belongs to one field is one entry: where constants stand is the same in all of its texts.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any, NamedTuple

from contwalk import object_cache
from contwalk.fields.kept_kernels import generator


class Derived(NamedTuple):
    """Of one field.

    Parameters
    ----------
    rows : list of list of int
        For each row of the Jacobian the columns of the entries that are nonzero on some path.
    ones : list of int
        Positions of the entries that are always 1.
    constant_count : int
        How many numbers depend on the parameters alone.
    rhs, rhs_jac, constants : str
        LLVM IR. Of a field that is not differentiated `rhs_jac`, `rows` and `ones` are empty.
    """

    rows: list[list[int]]
    ones: list[int]
    constant_count: int
    rhs: str
    rhs_jac: str
    constants: str


def derived(described: object, derive: Callable[[], Derived]) -> Derived:
    """What an earlier process has derived from the same, or what `derive` gives, which is kept.

    Parameters
    ----------
    described : object
        All that decides the result, but for this package's own text: of numbers, texts, and tuples, lists and
        dictionaries of them, whose `repr` tells all.
    derive : callable
        Asked if nothing is kept, or if it is damaged.
    """
    name = object_cache.key(
        "derived", sys.version, generator("contwalk.flow.compiled.field"), repr(described)
    )
    found = _read(object_cache.load_values(name))
    if found is None:
        found = derive()
        object_cache.store_values(name, found)
    return found


def _read(values: list[Any] | None) -> Derived | None:
    """An entry; None if it is none."""
    if values is None or len(values) != len(Derived._fields):
        return None
    found = Derived(*values)
    return found if _is_sound(found) else None


def _is_sound(found: Derived) -> bool:
    kinds: tuple[type[Any], ...] = (list, list, int, str, str, str)
    return all(isinstance(value, kind) for value, kind in zip(found, kinds, strict=True))

"""Records by which compiled code is told what to do, and by which it answers: fields with names.

A record is memory of C: 64-bit integers, addresses among them, and doubles. The interpreter sees a
`ctypes.Structure`; functions compiled by numba see the same memory by `calling.record`, under the same names.
"""

from __future__ import annotations

import ctypes
from typing import Any, TypeVar, cast

_KINDS = {"int": ctypes.c_int64, "float": ctypes.c_double}


class CallRecord(ctypes.Structure):
    """A record in memory; all fields are zero at first. Kinds of it are made by `call_record`."""

    __slots__ = ()

    @property
    def address(self) -> int:
        """Where it is; it must outlive the compiled code that is told."""
        return ctypes.addressof(self)

    def clear(self) -> None:
        """All fields are zero again."""
        ctypes.memset(ctypes.addressof(self), 0, ctypes.sizeof(self))


_Kind = TypeVar("_Kind", bound=CallRecord)


def call_record(kind: type[_Kind]) -> type[_Kind]:
    """A class decorator: the annotations of a `CallRecord` become its fields, in their order.

    Parameters
    ----------
    kind : type
        Annotated with ``int`` (numbers and addresses) and ``float`` only.

    Raises
    ------
    KeyError
        If a field is of another kind.
    """
    fields = [(name, _KINDS[annotation]) for name, annotation in kind.__annotations__.items()]
    # Without a dictionary: a name that is no field is refused.
    made = {"__slots__": (), "__doc__": kind.__doc__, "__module__": kind.__module__, "_fields_": fields}
    metaclass: Any = type(kind)
    return cast("type[_Kind]", metaclass(kind.__name__, kind.__bases__, made))

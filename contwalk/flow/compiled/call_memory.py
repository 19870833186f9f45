"""The memory of one call of compiled code: arrays that live as long as it, and the record of their places."""

from __future__ import annotations

import numpy as np

from contwalk.flow.compiled.addresses import address
from contwalk.flow.compiled.call_record import CallRecord
from contwalk.flow.compiled.compiled_field import CompiledField


class CallMemory:
    """Keeps what compiled code is told the address of.

    Parameters
    ----------
    kept : sequence of object
        What lives as long as the call, beside the arrays that it is given.
    """

    record: CallRecord

    def __init__(self, *kept: object) -> None:
        self._kept = list(kept)

    def keep(self, array: np.ndarray) -> int:
        """The address of an array of any shape, which lives as long as the call."""
        self._kept.append(array)
        return address(array)

    def field(self, field: CompiledField, c: np.ndarray) -> dict[str, int]:
        """What a record tells of a field with its Jacobian, and of the constants, shape (k,), that it has."""
        return {
            "rhs": field.rhs_address,
            "jac": field.rhs_jac_address,
            "n": field.n,
            "rows": self.keep(field.row_ptr),
            "columns": self.keep(field.col),
            "entries": len(field.col),
            "c": self.keep(c),
            "constants": len(c),
        }

    def give(self, **arrays: np.ndarray | None) -> None:
        """Put arrays where the kernel finds them: their addresses into fields of the record."""
        for name, array in arrays.items():
            setattr(self.record, name, 0 if array is None or not array.size else self.keep(array))

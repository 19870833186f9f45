"""Columns of tangents in memory: padded to whole registers, and what drives each."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from contwalk.flow.compiled.addresses import address
from contwalk.flow.compiled.products import WIDTH

# Numbers in a line of the processor's cache.
_LINE = 8


def driving(columns: int, width: int, sources: Sequence[int] | np.ndarray) -> np.ndarray:
    """Which parameter column drives which tangent: ones in places, shape (columns, width); never changed.

    Raises
    ------
    ValueError
        If there is no such column.
    """
    return _driving(columns, width, np.asarray(sources, dtype=np.int64).tobytes())


@lru_cache
def _driving(columns: int, width: int, sources: bytes) -> np.ndarray:
    given = np.frombuffer(sources, dtype=np.int64)
    if ((given < -1) | (given >= columns)).any():
        raise ValueError(f"tangents of a field with {columns} columns are driven by {given.tolist()}")
    result = aligned(max(columns, 1), width)
    result[given[given >= 0], np.flatnonzero(given >= 0)] = 1.0
    return result


def padded(count: int) -> int:
    """A count that is a whole number of registers."""
    return -(-count // WIDTH) * WIDTH


def aligned(rows: int, columns: int) -> np.ndarray:
    """Zeros, shape (rows, columns), whose vectors do not straddle the lines of the processor's cache."""
    memory = np.zeros(rows * columns + _LINE)
    offset = -(address(memory) // memory.itemsize) % _LINE
    return memory[offset : offset + rows * columns].reshape(rows, columns)

"""What became of the motions of a sampling, by their numbers: kept on the disk while others are computed."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from contwalk.flow.ensemble.sampling import Measured
from contwalk.storage.journal import Journal
from contwalk.workflow.sampled_motions import Found

# Seconds for which what is done may wait for more before it is written: a write waits for the disk.
GATHERED = 0.5
_DTYPES = {"crossed_at": float, "crossed": bool, "ended_at": float, "ended": int, "there": bool}


class KeptMotions:
    """Motions in any order, each placed by its number: whatever computes them, all together are the same.

    Parameters
    ----------
    journal : Journal
        What it has from before is taken up.
    count : int
        Of all motions.
    """

    def __init__(self, journal: Journal, count: int) -> None:
        self._journal = journal
        self._columns: dict[str, np.ndarray] = {
            name: np.zeros(count, dtype=dtype) for name, dtype in _DTYPES.items()
        }
        self._known = np.zeros(count, dtype=bool)
        self._new: list[int] = []
        self._written = time.monotonic()
        for entry in journal.kept:
            self._place(entry["numbers"], entry)

    @property
    def missing(self) -> list[int]:
        """The numbers of those that are not known."""
        found: list[int] = np.flatnonzero(~self._known).tolist()
        return found

    @property
    def found(self) -> Found:
        """All of them, shape (count,)."""
        columns = dict(self._columns)
        there = columns.pop("there")
        return Found(Measured(**columns), there)

    def add(self, numbers: Sequence[int], found: Found) -> None:
        """Keep what became of these; it is on the disk soon, and once `write` was called."""
        self._place(numbers, {**vars(found.motions), "there": found.there})
        self._new += numbers
        if time.monotonic() - self._written >= GATHERED:
            self.write()

    def write(self) -> None:
        """Put on the disk what is not there yet."""
        if self._new:
            columns = {name: column[self._new].tolist() for name, column in self._columns.items()}
            self._journal.add({"numbers": self._new, **columns})
            self._new = []
        self._written = time.monotonic()

    def _place(self, numbers: Sequence[int], columns: Mapping[str, Any]) -> None:
        for name, column in self._columns.items():
            column[numbers] = columns[name]
        self._known[numbers] = True

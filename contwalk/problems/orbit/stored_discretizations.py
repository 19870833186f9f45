"""The discretisations on which orbits of a stored branch may have been solved for."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Generic, TypeVar

import numpy as np

Own = TypeVar("Own", bound=Any)


class StoredDiscretizations(Generic[Own]):
    """Steps made for stored orbits, the last ones kept: neighbouring rows ask for the same ones."""

    def __init__(self, problem: Own) -> None:
        self._problem = problem
        self._walked: tuple[bytes, Own] | None = None
        self._finest: tuple[bytes, Own] | None = None

    def walked(self, z: np.ndarray, weights: np.ndarray) -> Own:
        """The steps that a walk makes for an orbit. z and weights have the shape (N + 1,)."""
        key = z.tobytes()
        if self._walked is None or self._walked[0] != key:
            self._walked = key, self._problem.at_stored(z, weights)
        return self._walked[1]

    def finest(self, z: np.ndarray, weights: np.ndarray) -> Own:
        """The steps on which special points are located. z and weights have the shape (N + 1,)."""
        key = z.tobytes()
        if self._finest is None or self._finest[0] != key:
            self._finest = key, self.walked(z, weights).finest(z, weights)
        return self._finest[1]

    def of_row(self, row: np.void, before: np.void, z: np.ndarray, weights: np.ndarray) -> Iterator[Own]:
        """Those on which the orbit of a row may be solved for; it was walked from the row `before`.

        z and weights have the shape (N + 1,).
        """
        if row["special"]:
            yield self.finest(z, weights)
            return
        earlier, known, _ = vectors_of(before)
        if len(earlier) == len(z):
            yield self.walked(earlier, known)
        yield self.walked(z, weights)


def vectors_of(row: np.void) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Solution, weights and tangent of a stored row. Shape (N + 1,) each."""
    size = int(np.sum(np.isfinite(row["unknowns"])))
    z = np.append(row["unknowns"][:size], row["free"])
    return z, np.array(row["weights"][: size + 1]), np.array(row["tangent"][: size + 1])

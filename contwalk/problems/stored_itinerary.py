"""What a database holds of a hybrid orbit beside its state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True, eq=False)
class StoredItinerary:
    """The legs of a stored orbit, as `orbit.itinerary.stored_leg` has them, and its unknowns.

    `image` is the symmetry up to which it closes, `pins` are the names of the directions that are held.
    """

    legs: Sequence[Sequence[Any]]
    subharmonic: int
    unknowns: np.ndarray
    image: str = ""
    pins: tuple[str, ...] = ()

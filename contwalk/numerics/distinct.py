"""The distinct ones of some numbers."""

from __future__ import annotations

import numpy as np


def distinct(values: np.ndarray) -> np.ndarray:
    """Each of some finite numbers once, in growing order. Shapes (k,) and (m,).

    What `numpy.unique` answers, which loads masked arrays at its first call: a hundredth of a short study.
    """
    ordered = np.sort(values)
    return np.append(ordered[:1], ordered[1:][ordered[1:] != ordered[:-1]])

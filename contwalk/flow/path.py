"""A computed path."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Path:
    """Steps of a flow.

    Parameters
    ----------
    times : ndarray, shape (s + 1,)
        Ends of the steps; falling in a path backwards in time.
    states : ndarray, shape (s + 1, n)
    evaluations : int
        Evaluations of the field, those of rejected steps included.
    rejected : int
        Steps that were tried and found too long.
    stiff_fraction : float
        Share of the steps whose length was limited by stability and not by accuracy.
    status : str
        "ok": the path arrived. Otherwise it ends where it could not go on: "not_finite", "too_many_steps",
        "step_too_small".
    """

    times: np.ndarray
    states: np.ndarray
    evaluations: int
    rejected: int
    stiff_fraction: float
    status: str

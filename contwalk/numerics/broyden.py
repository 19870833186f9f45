"""Broyden's method: corrections by the derivatives of another place, improved by what each has achieved.

Source: C. T. Kelley, Solving Nonlinear Equations with Newton's Method, SIAM 2003, section 4.3.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np


def broyden_step(chord: np.ndarray, steps: Sequence[np.ndarray]) -> np.ndarray:
    """The next step, shape (n,), in units in which the unknowns are of like size.

    Parameters
    ----------
    chord : ndarray, shape (n,)
        What the derivatives of the other place alone say: minus their inverse times the residual.
    steps : sequence of ndarray, shape (n,)
        All steps so far; none of them is zero.
    """
    step = chord
    for one, following in pairwise(steps):
        step = step + following * ((one @ step) / (one @ one))
    if steps:
        last = steps[-1]
        step = step / (1.0 - (last @ step) / (last @ last))
    return step

"""What derivatives of a test function of orbits lack where the field bends, by how the function changes.

Derivatives of the motion jump where it passes from one piece of the field to the next, and the instant of
that moves with the orbit. Second derivatives are integrated piece by piece, without what the moving instant
adds. That is one gradient for each function, and what it is along a step the step itself tells
(C. G. Broyden, 1965).
"""

from __future__ import annotations

import numpy as np

# Steps below this, in units of the unknowns, change a function by too few of its digits.
TELLING = 1e-7


class Lacking:
    """Rows that are added to those of the functions in a Jacobian.

    Parameters
    ----------
    size : int
        Number of equations before the functions.
    scale : ndarray, shape (n,)
        Typical magnitudes of the unknowns.
    """

    def __init__(self, size: int, scale: np.ndarray) -> None:
        self._size, self._scale = size, scale
        self._rows: np.ndarray | None = None
        self._last: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None

    def along(self, direction: np.ndarray, rates: np.ndarray, jacobian: np.ndarray) -> None:
        """Begin with what is lacking along a direction (n,), in which the functions change at rates (r,)."""
        scaled = direction / self._scale
        lacks = rates - jacobian[self._size :] @ direction
        self._rows = np.outer(lacks, scaled / self._scale) / float(scaled @ scaled)

    def on_other_steps(self) -> None:
        """Values are those of other steps of integration from now on: none is compared with one of before."""
        self._last = None

    def added(self, y: np.ndarray, residual: np.ndarray, jacobian: np.ndarray) -> np.ndarray:
        """The Jacobian (m, n) at y, (n,), with what it lacks as far as the last steps have told.

        The residual has the shape (m,).
        """
        own, rows = residual[self._size :].copy(), jacobian[self._size :].copy()
        if self._last is not None:
            before, values, slopes = self._last
            moved = (y - before) / self._scale
            length = float(moved @ moved)
            if length > TELLING**2:
                lacks = own - values - 0.5 * (slopes + rows) @ (y - before)
                self._rows = np.outer(lacks, moved / self._scale) / length
        self._last = y.copy(), own, rows
        if self._rows is None:
            return jacobian
        whole = jacobian.copy()
        whole[self._size :] += self._rows
        return whole

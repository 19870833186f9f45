"""What is integrated of one motion on the steps of a discretisation, each part once.

Whoever looks along an orbit (magnitudes, observables, extremes, the slowest place, the phase) looks at the
same states. A linearization has passed through those at the steps already, bitwise.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from contwalk.problems.orbit.shooting import Curve, Shooting


class Solution:
    """A motion over one closure; a solution of the equations, or nearly one.

    Parameters
    ----------
    shooting : Shooting
    starts : ndarray, shape (m, n)
        States at the starts of the segments.
    scalars : ndarray, shape (k,)
        Period, drifts and free parameter.
    """

    def __init__(self, shooting: Shooting, starts: np.ndarray, scalars: np.ndarray) -> None:
        self._shooting, self._starts, self._scalars = shooting, starts, scalars

    @cached_property
    def nodes(self) -> np.ndarray:
        """States at the steps of all segments, `Mesh.times`, shape (s, n)."""
        return self._shooting.states(self._starts, self._scalars)

    @cached_property
    def curve(self) -> Curve:
        """The motion, to be looked at anywhere."""
        return self._shooting.curve(self.nodes, self._scalars)

    @cached_property
    def velocities(self) -> np.ndarray:
        """dx/dt at the segments' starts, in units of the closure's duration, shape (m, n)."""
        return self._shooting.velocities(self._starts, self._scalars)

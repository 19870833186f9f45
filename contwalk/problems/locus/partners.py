"""Partners of the multipliers that a curve holds, where these come in pairs mu, 1/mu.

Of a motion that conserves something two multipliers meet at its folds, branch points and doublings, and two
pairs of opposite Krein signature where they leave the unit circle. All of them stay where they are along the
curve of such points: none is a further one that passes the circle.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.problems.orbit import volumes


def partners(orbit: Any, z: np.ndarray, critical: np.ndarray) -> np.ndarray:
    """Values of the multipliers that meet the critical ones, shape (c,), at an orbit; none where none do.

    z has the shape (N + 1,).
    """
    if not (len(critical) and (orbit.system.conserved or volumes.kept(orbit, z))):
        return critical[:0]
    found = orbit.multipliers(z, orbit.linearize(z).jacobian)
    if len(found.values) < 2 * len(critical):
        return critical[:0]
    nearest = int(np.argmin(np.abs(found.values - critical[0])))
    paired = found.bordering is not None or (found.paired is not None and bool(found.paired[nearest]))
    return critical if paired else critical[:0]

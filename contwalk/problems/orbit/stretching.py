"""Whether the segments of an orbit are too long for what is computed over them."""

from __future__ import annotations

import numpy as np

from contwalk.problems.orbit import monodromy
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.transport import STRETCHED, TOO_MUCH

# What the flow may miss its own velocity by before an orbit is cut into twice as many segments.
MISSED = 1e-3


def stretched(orbit: DiscretizedOrbit, z: np.ndarray) -> bool:
    """Whether a segment is too long for Newton's method to be at ease, or to tell multipliers.

    z has the shape (N + 1,).
    """
    jacobian = orbit.linearize(z).jacobian
    if orbit.mesh.growth > TOO_MUCH or monodromy.trivial_error(orbit, z, jacobian) > MISSED:
        return True
    variation, factors = orbit.mesh.variation, np.array(monodromy.chain(orbit, jacobian)[0])
    grown = np.linalg.norm(factors / variation[:, None] * variation, axis=(1, 2))
    return float(np.max(grown)) > STRETCHED

"""Does the motion round an orbit without events keep volumes of states, as a machine does that loses nothing?

Where the divergence of the field is zero throughout, the map round the orbit has the determinant one
(Liouville's theorem): two multipliers are mu and 1/mu. A pair on the unit circle stays there until it meets
at 1 or -1, and what rounding makes of its modulus tells no stability.
"""

from __future__ import annotations

import numpy as np

from contwalk.numerics.linear import EPSILON
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.problems.orbit.orbit_data import OrbitData

# A divergence is zero if it is no more than so many roundings of its terms.
ROUNDINGS = 1e2
# It is asked for at other states, instants and a value of the parameter as well: displaced by these parts of
# their magnitudes, and of a turn.
STATES, PARAMETER, INSTANTS = (0.0, 0.37, -0.61), 0.1, (0.0, 0.29)
# A parameter that is zero is displaced by this.
UNIT = 1.0


def kept(orbit: OrbitData, z: np.ndarray) -> bool:
    """Whether the field has no divergence, here and at another value of the parameter: a damping that passes
    zero keeps volumes at that value only.

    z has the shape (N + 1,). Of a motion with events nothing is known.
    """
    if orbit.eventful or len(orbit.itinerary) != 1 or orbit.pins:
        return False
    x, scalars = orbit.layout.inputs_of(orbit.layout.segments[0], z)
    field, own, n = orbit.passages[0].field(PLAIN), orbit.extended(0), len(x)
    for moved in (0.0, PARAMETER * (abs(float(scalars[-1])) or UNIT)):
        given = scalars.copy()
        given[0], given[-1] = given[0] or UNIT, given[-1] + moved
        c = field.constants(np.concatenate([given, orbit.line.constants]))
        for share in STATES:
            for t in INSTANTS:
                diagonal = field.jacobian(t, x + share * own[:n], c)[:, :n].diagonal()
                if not abs(diagonal.sum()) <= ROUNDINGS * EPSILON * np.abs(diagonal).sum():
                    return False
    return True

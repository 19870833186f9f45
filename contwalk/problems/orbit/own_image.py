"""Whether an orbit, or those beside it, are their own images under a symmetry, a part of the period later."""

from __future__ import annotations

import numpy as np

from contwalk.problems.orbit.closure import imaged, order_of
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.shooting import velocity
from contwalk.problems.orbit.transport import carried_to
from contwalk.system import Symmetry
from contwalk.system.declarations import ParameterValues

# An orbit is its own image if it meets it this nearly, in units of its range: corrected orbits do to 1e-8.
OWN_IMAGE = 1e-5
# One that misses that by less may be its own image but for the errors of its steps.
NEARLY = 1e-2


def carries(problem: DiscretizedOrbit, z: np.ndarray, symmetry: Symmetry, power: int, order: int) -> bool:
    """Whether the field itself has the symmetry, a part of the period later, at a state off the orbit.

    z has the shape (N + 1,).
    """
    p = ParameterValues(**problem.values_of(z))
    values = problem.given(z)
    x = problem.starts(z)[0] + 0.1 * problem.mesh.variation * np.cos(np.arange(1.0, problem.states + 1.0))
    time, step = 0.3, 1e-6
    f = velocity(problem.passages[0], x, time, values)
    image = imaged(symmetry, x, p, power)
    size = float(np.linalg.norm(f / problem.mesh.variation)) or 1.0
    moved = (imaged(symmetry, x + step / size * f, p, power) - image) / (step / size)
    there = velocity(problem.passages[0], image, time - 1.0 / order, values)
    return bool(np.linalg.norm((moved - there) / problem.mesh.variation) < 1e-4 * size)


def halved(there: DiscretizedOrbit, z: np.ndarray, tangent: np.ndarray) -> DiscretizedOrbit | None:
    """The problem of doubled orbits whose halves are images of each other, if those beside z are that.

    z and tangent have the shape (N + 1,).
    """
    if there.itinerary.image or np.any(there.turns):
        return None
    n, p, scale = there.states, ParameterValues(**there.values_of(z)), there.mesh.variation
    x, v = z[:n], tangent[:n] / np.linalg.norm(tangent[:n] / scale)
    later, moved = carried_to(there, z, tangent / np.linalg.norm(tangent[:n] / scale), 0.5)
    for symmetry in there.system.symmetries:
        if symmetry.role != "spatial" or order_of(symmetry, x, p) != 2:
            continue
        image = imaged(symmetry, later, p)
        deviation = imaged(symmetry, later + moved, p) - image  # symmetries of machines are affine
        own = max(float(np.linalg.norm(d / scale)) for d in (image - x, deviation - v))
        if own < OWN_IMAGE and carries(there, z, symmetry, 1, 2):
            return there.closing(np.zeros(n), symmetry.name, 1, 2)
    return None

"""How far an orbit is from repeating itself, and from being its own image, in units of its range."""

from __future__ import annotations

import numpy as np

from contwalk.problems.orbit.closure import imaged, order_of
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.transport import carried_to
from contwalk.system.declarations import ParameterValues

# An orbit whose states move by less, in parts of their magnitudes, is at rest: what differs there is errors.
AT_REST = 1e-6


def of_moving(problem: DiscretizedOrbit, z: np.ndarray) -> dict[str, float]:
    """As `asymmetries`; nothing of an orbit at rest, z of shape (N + 1,), whose images are all itself."""
    mesh = problem.mesh
    return {} if (mesh.variation <= AT_REST * mesh.magnitudes).all() else asymmetries(problem, z)


def asymmetries(problem: DiscretizedOrbit, z: np.ndarray) -> dict[str, float]:
    """Distances of an orbit, z of shape (N + 1,), from its images, by name: zero where it is its parent's.

    It is compared with itself half a closure later; of an orbit that closes up to a symmetry, of which each
    part is a whole, its states with their own images; and with its images under powers of symmetries, a part
    of the closure later.

    Raises
    ------
    NotFinite
        If the motion ends before the closure does.
    """
    x, itinerary = problem.starts(z)[0], problem.itinerary
    still, known = np.zeros(len(z)), dict[float, np.ndarray]()

    def later(part: float) -> np.ndarray:
        if part not in known:
            step = np.flatnonzero(problem.mesh.times == part)
            known[part] = (
                problem.view(z)[0].nodes[step[-1]]  # as of steps that are alike in halves
                if len(step)
                else carried_to(problem, z, still, part)[0]
            )
        return known[part]

    def apart(y: np.ndarray) -> float:
        return float(np.linalg.norm((y - x) / problem.mesh.variation))

    found = dict[str, float]()
    # The force alone is the same again after one of its periods, not after a half: an orbit at rest is
    # no parent's.
    if not problem.forced or problem.subharmonic % (2 * itinerary.closures) == 0:
        found["itself"] = apart(later(0.5) - 0.5 * problem.turns)
    p = ParameterValues(**problem.values_of(z))
    if itinerary.image:
        found["whole"] = apart(imaged(problem.system.symmetry(itinerary.image), x, p, itinerary.power))
    for symmetry in problem.system.symmetries:
        order = order_of(symmetry, x, p)
        if itinerary.image or symmetry.role != "spatial" or order is None or order < 2:
            continue
        for power in range(1, order):
            found[f"{symmetry.name} {power}"] = apart(imaged(symmetry, later(1.0 / order), p, power))
    return found

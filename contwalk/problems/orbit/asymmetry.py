"""How far an orbit is from repeating itself, and from being its own image, in units of its range."""

from __future__ import annotations

import numpy as np

from contwalk.problems import neutral as neutrals
from contwalk.problems.orbit.closure import imaged, order_of
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.transport import carried_to
from contwalk.system.declarations import ParameterValues

# An orbit whose states move by less, in parts of their magnitudes, is at rest: what differs there is errors.
AT_REST = 1e-6
# Parts of the closure within which an instant is that of a step.
AT_STEP = 1e-14


def of_moving(problem: DiscretizedOrbit, z: np.ndarray) -> dict[str, float]:
    """As `asymmetries`; nothing of an orbit at rest, z of shape (N + 1,), whose images are all itself."""
    mesh = problem.mesh
    return {} if (mesh.variation <= AT_REST * mesh.magnitudes).all() else asymmetries(problem, z)


def state_at(problem: DiscretizedOrbit, z: np.ndarray, part: float) -> np.ndarray:
    """State after a part of the closure, shape (n,): that of a step, as of steps that are alike in parts.

    z has the shape (N + 1,).
    """
    step = np.flatnonzero(np.abs(problem.mesh.times - part) <= AT_STEP)
    return (
        problem.view(z)[0].nodes[step[-1]] if len(step) else carried_to(problem, z, np.zeros(len(z)), part)[0]
    )


def apart(problem: DiscretizedOrbit, z: np.ndarray, y: np.ndarray) -> float:
    """How far a state y, shape (n,), is from where an orbit begins, z of shape (N + 1,), in units of its
    range.

    But for where it is along neutral directions: one who drifts along, so that the whole closes, sees its
    parts close elsewhere where the image of a direction is its opposite.
    """
    scale, every = problem.mesh.variation, range(problem.states)
    given = y, problem.starts(z)[0], problem.values_of(z), scale, every
    return float(np.linalg.norm(neutrals.apart_at_least(problem.system, problem.pins, *given) / scale))


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
    x, itinerary, known = problem.starts(z)[0], problem.itinerary, dict[float, np.ndarray]()

    def later(part: float) -> np.ndarray:
        if part not in known:
            known[part] = state_at(problem, z, part)
        return known[part]

    found = dict[str, float]()
    # The force alone is the same again after one of its periods, not after a half: an orbit at rest is
    # no parent's.
    if not problem.forced or problem.subharmonic % (2 * itinerary.closures) == 0:
        found["itself"] = apart(problem, z, later(0.5) - 0.5 * problem.turns)
    p = ParameterValues(**problem.values_of(z))
    if itinerary.image:
        found["whole"] = apart(
            problem, z, imaged(problem.system.symmetry(itinerary.image), x, p, itinerary.power)
        )
    for symmetry in problem.system.symmetries:
        order = order_of(symmetry, x, p)
        if itinerary.image or symmetry.role != "spatial" or order is None or order < 2:
            continue
        for power in range(1, order):
            image = imaged(symmetry, later(1.0 / order), p, power)
            found[f"{symmetry.name} {power}"] = apart(problem, z, image)
    return found

"""Whether an orbit, or those beside it, are their own images under a symmetry, a part of the period later."""

from __future__ import annotations

import numpy as np

from contwalk.problems.orbit.closure import imaged, order_of
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.itinerary import imaged_leg
from contwalk.problems.orbit.scales import cycle_scales
from contwalk.problems.orbit.shooting import velocity
from contwalk.system import Symmetry
from contwalk.system.declarations import ParameterValues

# An orbit is its own image if it meets it this nearly, in units of its range: corrected orbits do to 1e-8.
OWN_IMAGE = 1e-5
# One that misses that by less may be its own image but for the errors of its steps.
NEARLY = 1e-2
# A field is its own image to this part of its size: the image of its direction is a difference.
CARRIED = 1e-4
# States at which an orbit begins, and deviations there, that differ by less from their images are these.
ALIKE = 1e-6


def carries(problem: DiscretizedOrbit, z: np.ndarray, symmetry: Symmetry, power: int, later: float) -> bool:
    """Whether the first leg's field has the symmetry, a part of its time later, at a state off the orbit.

    So it must have for other values of the free parameter: a force without amplitude has any symmetry.

    z has the shape (N + 1,).
    """
    beside = z.copy()
    beside[-1] = problem.line.elsewhere(problem.system, float(z[-1]))
    missed = [_missed(problem, where, symmetry, power, later) for where in (z, beside)]
    return missed[0] < CARRIED and not missed[1] >= CARRIED  # where there is no field, nothing is told


def _missed(problem: DiscretizedOrbit, z: np.ndarray, symmetry: Symmetry, power: int, later: float) -> float:
    """How far the field is from its image there, in parts of its size."""
    p, passage = ParameterValues(**problem.values_of(z)), problem.passages[0]
    own, scale = list(passage.states), problem.mesh.variation
    values = np.concatenate([problem.layout.inputs(0, z)[1], problem.line.constants])
    x = passage.full(z[problem.layout.states[0]]) + 0.1 * scale * np.cos(np.arange(1.0, problem.states + 1.0))
    time, step = 0.3, 1e-6
    f = passage.full(velocity(passage, x[own], time, values))
    image = imaged(symmetry, x, p, power)
    size = float(np.linalg.norm(f / scale)) or 1.0
    moved = (imaged(symmetry, x + step / size * f, p, power) - image) / (step / size)
    there = velocity(passage, image[own], time - later, values)
    return float(np.linalg.norm((moved[own] - there) / scale[own])) / size


def reversing(problem: DiscretizedOrbit, z: np.ndarray, v: np.ndarray) -> str:
    """The symmetry that keeps each state of an orbit and reverses a deviation of it; empty if there is none.

    Then a doubled orbit that leaves along the deviation is its own image after half of it.

    z has the shape (N + 1,), v (N,).
    """
    if problem.itinerary.image or np.any(problem.turns) or (problem.itinerary.eventful and problem.pins):
        return ""
    columns = cycle_scales(problem)[1]
    v = v / float(np.linalg.norm(v / columns))
    if np.any(np.abs(v[problem.layout.durations]) > ALIKE * problem.mesh.total):
        return ""
    spatial = (s for s in problem.system.symmetries if s.role == "spatial")
    return next((s.name for s in spatial if _reverses(problem, z, v, s)), "")


def _reverses(problem: DiscretizedOrbit, z: np.ndarray, v: np.ndarray, symmetry: Symmetry) -> bool:
    p, scale, legs = ParameterValues(**problem.values_of(z)), problem.mesh.variation, problem.itinerary.legs
    if any(imaged_leg(problem.system, symmetry.name, leg) != leg for leg in legs):
        return False
    if order_of(symmetry, problem.first_state(z), p) != 2:
        return False
    for place, passage in problem.places:
        own, x, w = list(passage.states), passage.full(z[place]), passage.full(v[place])
        moved = imaged(symmetry, x, p) - x, imaged(symmetry, x + w, p) - x + w
        if max(float(np.linalg.norm((each / scale)[own])) for each in moved) > ALIKE:
            return False
    return carries(problem, z, symmetry, 1, 0.0)

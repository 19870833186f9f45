"""Where a family of orbits ends without an end of the range: at a point, at another orbit, at infinite
period.
"""

from __future__ import annotations

import numpy as np

from contwalk.branch import Outcome
from contwalk.errors import NotFinite
from contwalk.problems import neutral as neutrals
from contwalk.problems.orbit.asymmetry import asymmetries
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.problem import Sample

# An orbit that goes a smaller part of its metric in one closure is a point: solutions are known to 1e-10.
POINT = 1e-8
# A drift this many times what errors of the steps make of zero is one.
HELD = 30.0
# Two states of an orbit nearer than this, in units of its range, are one.
MEETS = 1e-6
# How far aside along the branch another orbit is looked at, in the metric, and a tenth as far. From a
# symmetry that it keeps it moves by this much less there, to the second order, and by a tenth from one that
# it leaves.
ASIDE, NEARER, STAYS = 1e-3, 1e-4, 0.03


def held(problem: DiscretizedOrbit, a: Sample, b: Sample) -> Outcome | None:
    """A direction that is neutral at equilibria, and along which orbits drift."""
    if not held_by_force(problem, b):
        return None
    return Outcome(
        "failed",
        "no_convergence",
        f"Beyond {problem.line.described(float(a.z[-1]))}, holding the undeclared neutral direction takes a "
        "force: the motion does not come back but drifts along it with every period, and is no periodic "
        "orbit. Declare the direction with neutral=(Neutral(...),) to follow orbits that drift along it.",
    )


def held_by_force(problem: DiscretizedOrbit, sample: Sample) -> bool:
    """Whether there is a drift along a pinned direction that nobody declared, beyond errors of the steps.

    An problem that drifts along a declared one is periodic but for its place, as was asked for. Along
    another one it does not come back: what solves the equations with a drift is no problem.
    """
    if not any(pin.name == neutrals.UNDECLARED for pin in problem.pins):
        return False
    linearization, weights = problem.linearize(sample.z), sample.weights
    errors, drifts = problem.errors_at(sample.z), problem.layout.drifts
    try:
        bordered = linearization.bordered(sample.tangent / weights**2, weights)
        for pin, place in zip(problem.pins, range(drifts.start, drifts.stop), strict=True):
            row = bordered.solve_adjoint(np.eye(len(sample.z))[place])[: len(errors)]
            moves = abs(sample.z[place]) > HELD * float(np.abs(row) @ errors)
            if moves and pin.name == neutrals.UNDECLARED:
                return True
    except np.linalg.LinAlgError:  # a branch point of the pinned equations: its neighbours tell
        return False
    return False


def unborn(problem: DiscretizedOrbit, a: Sample, b: Sample) -> Outcome | None:
    """Two orbits that are points to rounding: the walk has not left the Hopf point that it began at."""
    if problem.forced or problem.itinerary.eventful:
        return None
    if max(_extent(problem, sample) for sample in (a, b)) > POINT:
        return None
    return Outcome(
        "failed",
        "step_too_small",
        f"The cycle that is born at {problem.line.described(float(a.z[-1]))} cannot be followed away from "
        "its Hopf point: what the steps there find is rounding. Give the states a `scale` in the plugin, or "
        "start on the cycle itself with start: {simulate: ...}.",
    )


def _extent(problem: DiscretizedOrbit, sample: Sample) -> float:
    """How far an orbit goes in one closure at its present speed, in the metric."""
    way = problem.velocity(sample.z) * problem.duration(sample.z)
    size = float(np.linalg.norm(way / sample.weights[problem.layout.states[0]]))
    return size * np.sqrt(len(problem.layout.segments))


def returned_to_parent(problem: DiscretizedOrbit, z: np.ndarray, tangent: np.ndarray) -> bool:
    """Whether an orbit has become its parent: it repeats itself, or is its own image, and those beside it
    on its branch do not.

    z and tangent have the shape (N + 1,).
    """
    return repeats(problem, z, MEETS) and not _keeps_symmetry(problem, z, tangent)


def _keeps_symmetry(problem: DiscretizedOrbit, z: np.ndarray, tangent: np.ndarray) -> bool:
    """Whether an orbit that repeats itself, or is its own image, is so to the first order along a branch.

    How far those beside it are from that depends on the phase that they are compared at: what is near to it
    is looked at once more, nearer.
    """
    try:
        aside = asymmetries(problem, z + ASIDE * tangent)
        near = {name: apart for name, apart in aside.items() if apart < STAYS * ASIDE}
        if not near:
            return False
        nearer, here = asymmetries(problem, z + NEARER * tangent), asymmetries(problem, z)
    except NotFinite:
        return False
    return any(
        nearer.get(name, 0.0) <= max(STAYS * apart, 2.0 * here.get(name, 0.0)) for name, apart in near.items()
    )


def repeats(problem: DiscretizedOrbit, z: np.ndarray, meets: float) -> bool:
    """Whether an orbit runs twice through the same states, or is its own mirror image.

    z has the shape (N + 1,).
    """
    try:
        return any(apart < meets for apart in asymmetries(problem, z).values())
    except NotFinite:
        return False

"""Where a family of orbits ends without an end of the range: at a point, at another orbit, at infinite
period.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contwalk.branch import Outcome
from contwalk.errors import NotFinite
from contwalk.problems.orbit.closure import imaged, order_of
from contwalk.problems.orbit.transport import carried_to
from contwalk.system.declarations import ParameterValues

if TYPE_CHECKING:
    from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
    from contwalk.problems.orbit.periodic_orbit import PeriodicOrbit
    from contwalk.problems.orbit.protocol import Orbit
    from contwalk.problems.problem import Sample

# An orbit that goes a smaller part of its metric in one closure is a point: solutions are known to 1e-10.
POINT = 1e-8
# An orbit that is this slow somewhere, against its fastest, passes an equilibrium.
CREEPING = 1e-2
# Two states of an orbit nearer than this, in units of its range, are one.
MEETS = 1e-6
# A parameter this near to its limit, relative to itself, is at it.
LEAST_REST = 1e-10
# The extrapolated limit is better than the last value by more than this.
REST = 10.0


def ended(problem: PeriodicOrbit, a: Sample, b: Sample) -> Outcome | None:
    """Why the branch ends between two neighbouring orbits, if it does."""
    return unborn(problem, a, b) or at_a_point(problem, a, b) or homoclinic(problem, a, b)


def unborn(problem: PeriodicOrbit, a: Sample, b: Sample) -> Outcome | None:
    """Two orbits that are points to rounding: the walk has not left the Hopf point that it began at."""
    if problem.forced or max(_extent(problem, sample) for sample in (a, b)) > POINT:
        return None
    return Outcome(
        "failed",
        "step_too_small",
        f"The cycle that is born at {problem.free} = {a.z[-1]:.10g} cannot be followed away from its Hopf "
        "point: what the steps there find is rounding. Give the states a `scale` in the plugin, or start on "
        "the cycle itself with start: {simulate: ...}.",
    )


def _extent(problem: PeriodicOrbit, sample: Sample) -> float:
    """How far an orbit goes in one closure at its present speed, in the metric."""
    n = problem.states
    return float(np.linalg.norm(problem.velocity(sample.z) / sample.weights[:n])) * np.sqrt(problem.segments)


def at_a_point(problem: PeriodicOrbit | HybridOrbit, a: Sample, b: Sample) -> Outcome | None:
    """The orbit shrinks to an equilibrium: beyond it the same orbits follow, half a period later."""
    if problem.forced or problem.section is None:
        return None
    normal = problem.section.normal
    before, after = float(normal @ problem.velocity(a.z)), float(normal @ problem.velocity(b.z))
    if not before > 0.0 > after:
        return None
    # The parameter changes with the square of the amplitude, and so of the velocity.
    share = before**2 / (before**2 - after**2) if abs(before + after) > 1e-3 * before else 0.5
    value = float(a.z[-1] + share * (b.z[-1] - a.z[-1]))
    return Outcome(
        "complete",
        "shrunk",
        f"The orbit shrinks onto an equilibrium, at a Hopf point near {problem.free} = {value:.6g}: "
        "the family ends there. Nothing to do.",
    )


def homoclinic(problem: Orbit, a: Sample, b: Sample) -> Outcome | None:
    """The period runs off while the parameter converges: lambda - lambda_h falls like exp(-kappa T)."""
    if problem.forced or not b.period > a.period:
        return None
    rises = [problem.lengthening(s.tangent) for s in (a, b)]
    if 0.0 in rises:
        return None
    slopes = [float(s.tangent[-1]) / rise for s, rise in zip((a, b), rises, strict=True)]
    if not (np.all(np.isfinite(slopes)) and slopes[0] * slopes[1] > 0.0 and abs(slopes[1]) < abs(slopes[0])):
        return None
    kappa = float(np.log(slopes[0] / slopes[1]) / (b.period - a.period))
    rest = float(slopes[1] / kappa)
    value = float(b.z[-1])
    wanted = max(REST * problem.discretization.accuracy, LEAST_REST) * max(abs(value), 1e-300)
    if abs(rest) > wanted or problem.slowness(b.z) > CREEPING:
        return None
    return Outcome(
        "stopped",
        "homoclinic",
        f"The period runs off ({b.period:.4g} s here) while the orbit creeps past an equilibrium: a "
        f"homoclinic or "
        f"heteroclinic orbit at {problem.free} = {value + rest:.12g}, by extrapolation from {value:.12g}. "
        "Nothing to do; a finer accuracy follows it further.",
    )


def slowness(problem: PeriodicOrbit, z: np.ndarray) -> float:
    """Speed where the orbit is slowest against where it is fastest, in units of the states' variation."""
    speeds = speeds_of(problem, z)[1]
    return float(speeds.min() / max(speeds.max(), 1e-300))


def speeds_of(problem: PeriodicOrbit, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Times 0..1 in the middle of the steps, and mean speeds over each, in units of the states' variation."""
    times, speeds = [], []
    states = problem.shooting.states(problem.starts(z), problem.scalars(z))
    for t, x in zip(problem.mesh.steps, states, strict=True):
        times.append(0.5 * (t[1:] + t[:-1]))
        speeds.append(np.linalg.norm(np.diff(x, axis=0) / problem.mesh.variation, axis=1) / np.diff(t))
    return np.concatenate(times), np.concatenate(speeds)


def repeats(problem: PeriodicOrbit, z: np.ndarray) -> bool:
    """Whether an orbit runs twice through the same states, or is its own mirror image, so that its
    parent is met.
    """
    try:
        x = problem.starts(z)[0]
        still = np.zeros(len(z))
        # The force alone is the same again after one of its periods, not after a half: an orbit at rest is
        # no parent's.
        if not problem.forced or problem.subharmonic % 2 == 0:
            half = carried_to(problem, z, still, 0.5)[0] - 0.5 * problem.closure.turns
            if _meet(problem, half, x):
                return True
        p = ParameterValues(**problem.values_of(z))
        for symmetry in problem.system.symmetries:
            order = order_of(symmetry, x, p)
            if problem.closure.fold > 1 or symmetry.role != "spatial" or order is None or order < 2:
                continue
            part = carried_to(problem, z, still, 1.0 / order)[0]
            if any(_meet(problem, imaged(symmetry, part, p, power), x) for power in range(1, order)):
                return True
    except NotFinite:
        return False
    return False


def _meet(problem: PeriodicOrbit, x: np.ndarray, y: np.ndarray) -> bool:
    return float(np.linalg.norm((x - y) / problem.mesh.variation)) < MEETS

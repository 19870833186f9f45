"""Curves of cycles that are born at special points of curves of equilibria.

At a generalized Hopf point r' = r (mu + c1 r^2 + l2 r^4) with mu = c1 = 0: cycles of the amplitude r
fold where c1 = -2 l2 r^2 and mu = l2 r^4 (Kuznetsov 2004, section 8.3). Beside the point, on the side of the
curve of Hopf points where c1 has the other sign than l2, a cycle of that amplitude is a fold to fourth order.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import ContwalkError
from contwalk.numerics.linear import kernel_direction
from contwalk.problems.equilibrium.equilibrium import Equilibrium
from contwalk.problems.equilibrium.points.hopf_to_orbit import from_hopf
from contwalk.problems.locus.lines import whole_plane
from contwalk.problems.locus.normal_forms import cubic_rate
from contwalk.problems.locus.orbit_curves import CURVES
from contwalk.problems.locus.orbit_locus import OrbitLocus
from contwalk.problems.locus.orbit_places import OrbitPlane
from contwalk.problems.orbit.branching import filled_magnitudes
from contwalk.problems.orbit.solving import newton_on
from contwalk.problems.problem import Seed

# How far along the curve of Hopf points the first cycle is looked for, in the metric; the first that is found
# counts. Nearer its fold is lost in that of the point itself.
ASIDE = (1e-2, 3e-3, 3e-2, 1e-3, 1e-1, 3e-4)
# Of the amplitude that is expected, what is found is no cycle below this part, and another one above that.
SMALLER, LARGER = 0.8, 1.25


def folds_of_cycles(problem: Any, point: SpecialPoint) -> Sequence[Seed]:
    """The curve of folds of cycles that is born at a generalized Hopf point; none where none is found."""
    if problem.system.acting:
        return ()
    z, l2 = np.array(point.unknowns), float(point.coefficients["l2"])
    there = problem.at(z)
    jacobian, known = there.linearize(z).jacobian, there.linearize(z).magnitudes
    weights = np.where(np.isfinite(known) & (known > 0.0), known, 1.0)
    tangent = kernel_direction(jacobian, weights)
    for aside in ASIDE:
        for sign in (1.0, -1.0):
            try:
                guess = z + sign * aside * tangent
                beside = newton_on(there, guess, weights, tangent / weights**2)
                found = _fold(problem, beside, l2, z[-2:])
            except (ContwalkError, np.linalg.LinAlgError):
                continue
            if found is not None:
                return [found]
    return ()


def _fold(problem: Any, z: np.ndarray, l2: float, origin: np.ndarray) -> Seed | None:
    """The fold of cycles beside a Hopf point at z, shape (N + 1,) of its curve.

    `origin` are the second and the first parameter at the generalized Hopf point, shape (2,).
    """
    kappa, place = problem.kappa(z), problem.in_plane(z)
    rate = cubic_rate(problem.plane, place, kappa) if kappa > 0.0 else 0.0
    if not rate * l2 < 0.0:
        return None
    amplitude = float(np.sqrt(-rate / (2.0 * l2)))
    values, free = problem.values_of(z), (problem.free, str(problem.plane.second))
    n, pins = problem.states, len(problem.pins)
    record = SpecialPoint(
        "HB",
        0.0,
        unknowns=(*z[: n + pins].tolist(), 0.0),
        coefficients={"omega": kappa**0.5, "l1": rate / kappa**0.5, "crossing_rate": 1.0},
    )
    resting = Equilibrium(
        problem.system, values, "path", whole_plane(values, free), problem.pins, z[:n], problem.discretization
    )
    (seed,) = from_hopf(resting, record)
    assert seed.tangent is not None
    orbit: Any = seed.problem
    swing = 2.0 * amplitude * seed.tangent[:-1]  # the critical vector has the length one
    near = np.concatenate([seed.z[:-1] + swing, [values[free[1]], values[free[0]]]])
    there, own = OrbitPlane(orbit, free).first(near)
    made = there.finely(own)
    sizes = filled_magnitudes(made, own)
    typical = [max(abs(values[name]), 1e-2) for name in reversed(free)]
    weights = np.concatenate([sizes[:-1], typical])
    curve = OrbitLocus(OrbitPlane(made, free), CURVES["LP"], (near, weights))
    normal = np.concatenate([swing, [0.0, 0.0]]) / weights**2  # the amplitude is held
    solved = newton_on(curve, near, weights, normal)  # type: ignore[arg-type]
    moved = float(np.linalg.norm((solved - near)[:n] + swing[:n]) / np.linalg.norm(swing[:n]))
    if not SMALLER < moved < LARGER:
        return None
    # Towards the point itself cycles shrink to nothing: only the other way is walked.
    away = kernel_direction(curve.linearize(solved).jacobian, weights)
    away = away * (np.sign(float((away / weights**2)[-2:] @ (solved[-2:] - origin))) or 1.0)
    return Seed("LP", solved, away, None, curve, one_sided=True)

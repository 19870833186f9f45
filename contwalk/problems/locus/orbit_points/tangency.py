"""How a curve of folds or doublings leaves the grazing curve at a resonant grazing: a quadratic coefficient.

Both curves are regular there, of the orbit in which the event happens without rate, and have one tangent.
With z' and J z'' = -D2F(z', z') of each, the difference of the second derivatives of one parameter by the
other is twice the coefficient (Simpson & Ghosh, arXiv 2602.22797).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.errors import NotFinite
from contwalk.numerics.linear import kernel_direction
from contwalk.problems.hybrid import locating_limits
from contwalk.problems.locus.orbit_conditions import At
from contwalk.problems.locus.orbit_curve import OrbitCurve
from contwalk.problems.locus.orbit_curves import CURVES, Limits
from contwalk.problems.locus.orbit_places import OrbitPlane
from contwalk.problems.orbit.branching import filled_magnitudes

# How far slopes are looked at for second derivatives, in the metric; those of twice as far take the next
# order out. Curves bend within some 1e-3 there.
APART = 1e-5


def coefficients(problem: Any, there: Any, own: np.ndarray, second: float, label: str) -> dict[str, Any]:
    """The coefficient of the curve of folds (`LP`) or doublings (`PD`), for either parameter.

    `there` is the orbit with the event without rate, `own` its unknowns, shape (N + 1,), `second` the second
    parameter. None where no such event, or no regular curve, is found.
    """
    try:
        bends = [_bend(made, z) for made, z in _curves(problem, there, own, second, label)]
    except (NotFinite, np.linalg.LinAlgError):
        return {}
    if len(bends) < 2 or not np.all(np.isfinite(bends)):
        return {}
    (curve, slope, error), (grazing, _, error_of_grazing) = bends
    name, other = problem.plane.free
    found = 0.5 * (curve - grazing)
    told = {f"tangency_{name}": found, f"tangency_{name}_error": 0.5 * (error + error_of_grazing)}
    if slope != 0.0:
        told[f"tangency_{other}"] = -found / slope**3
    return {
        **told,
        "convention": f"{name} - {name} on the grazing curve = tangency_{name} ({other} - {other} here)^2 "
        "along the other curve, and so with both parameters exchanged",
    }


def _curves(
    problem: Any, there: Any, own: np.ndarray, second: float, label: str
) -> list[tuple[Any, np.ndarray]]:
    """The curve of a label and the grazing curve of an orbit, each with its unknowns there."""
    typical = problem.weights[-2:]
    weights = np.append(filled_magnitudes(there, own)[:-1], typical[-1])
    near = At(own, weights, float(typical[0]))
    margins = there.margins(own)
    rates = [k for k, limit in enumerate(there.limits) if limit.label == "GR" and limit.test == "rate"]
    if not rates:
        return []
    which = min(rates, key=lambda k: abs(float(np.nan_to_num(margins.relative[k], nan=np.inf))))
    system = locating_limits.system_of(there, which, near)
    if system is None:
        return []
    plane_of = OrbitPlane(there, problem.plane.free)
    found = []
    further = system.start[len(own) :]
    chosen: list[tuple[OrbitCurve, np.ndarray]] = [
        (CURVES[label], np.zeros(0)),
        (Limits(there.limits[which], len(further)), further),
    ]
    for curve, extra in chosen:
        z = np.concatenate([own[:-1], extra, [second], own[-1:]])
        sizes = np.where(extra == 0.0, 1.0, np.abs(extra))
        scale = np.concatenate([weights[:-1], sizes, typical])
        found.append((problem.on(plane_of.orbit, z, scale, curve), z))
    return found


def _bend(curve: Any, z: np.ndarray) -> tuple[float, float, float]:
    """Second derivative of the first parameter by the second along a curve at z, the first, and an error.

    z has the shape (N + k + 2,).
    """
    weights = curve.weights
    rows = np.ones(len(z) - 1)
    rows[: curve.plane.size] = curve.orbit.equation_scales

    def slopes(place: np.ndarray) -> np.ndarray:
        return np.asarray(curve.jacobian(place) / rows[:, None] * weights)

    here = slopes(z)
    t = kernel_direction(here, np.ones(len(z)))

    def second(apart: float) -> float:
        ahead, behind = (slopes(z + sign * apart * weights * t) for sign in (1.0, -1.0))
        drive = (ahead - behind) @ t / (2.0 * apart)
        bend = np.linalg.solve(np.vstack([here, t]), np.append(-drive, 0.0))
        (d2, d1), (b2, b1) = (v[-2:] * weights[-2:] for v in (t, bend))
        return float((b1 * d2 - b2 * d1) / d2**3)

    near, far = second(APART), second(2.0 * APART)
    best = (4.0 * near - far) / 3.0
    d2, d1 = t[-2:] * weights[-2:]
    return best, float(d1 / d2), abs(best - near)

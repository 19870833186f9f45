"""Which way what leaves a point turns: what decides it, by differences of the record's own equations."""

from __future__ import annotations

import numpy as np

from contwalk.branch import Branch, SpecialPoint
from contwalk.verification import coefficients, normal_forms
from contwalk.verification.branching import Unfolded
from contwalk.verification.degenerate import critical_angle
from contwalk.verification.equations import Equations
from contwalk.verification.equilibrium import EquilibriumEquations
from contwalk.verification.finding import AGREES, CANNOT_TELL, DISAGREES, SLACK, CannotTell
from contwalk.verification.lengths import squared
from contwalk.verification.normal_forms import Told
from contwalk.verification.orbit import OrbitEquations
from contwalk.verification.passage import EPSILON, TIGHT
from contwalk.verification.rounds import Round
from contwalk.verification.solving import Solution

# The coefficient that decides, and the sign with which it is that of a supercritical point.
COEFFICIENTS = {"BP": ("c", -1.0), "HB": ("l1", -1.0), "PD": ("c", 1.0), "NS": ("d", -1.0)}
# A fold has no criticality; the product of both its coefficients depends on no length.
PRODUCT = "a b"


def judged(branch: Branch, point: SpecialPoint, equations: Equations, found: Solution) -> tuple[str, str]:
    """A verdict and its reason on a point's criticality and the coefficient that decides it."""
    label, (name, sign) = decided(branch, point)
    if not name:
        return AGREES, ""
    stored, claim = _stored(point, name)
    if sign and stored is not None and (sign * stored > 0.0) != (point.criticality == "supercritical"):
        return DISAGREES, f"it says {point.criticality}, and its coefficient {name} is {stored:.6g}"
    try:
        own = _own(label, point, equations, found)
    except CannotTell as why:
        reason = f"it is there; its coefficient {name} is not recomputed: {why.sentence}"
        return (CANNOT_TELL, reason) if sign else (AGREES, "")
    by = "by differences of its equations"
    if sign and not abs(own.value) > own.error:
        return CANNOT_TELL, f"it is there; its {name} is {own.value:.2g}, to {own.error:.2g}, {by}"
    if sign and (sign * own.value > 0.0) != (point.criticality == "supercritical"):
        return DISAGREES, f"it says {point.criticality}, and its {name} is {own.value:.6g} {by}"
    if stored is not None:
        allowed = SLACK * (own.error + claim) + EPSILON**0.25 * max(abs(own.value), abs(stored))
        if abs(own.value - stored) > allowed:
            return DISAGREES, f"its {name} is {stored:.6g}, and {own.value:.6g} {by}"
    return AGREES, ""


def decided(branch: Branch, point: SpecialPoint) -> tuple[str, tuple[str, float]]:
    """Which map's point it is, by what coefficient it is told, and the sign of a supercritical one.

    There is none where nothing is said.
    """
    label = point.label
    if label == "BP" and point.kind == "symmetry-breaking" and branch.info.closure not in (None, "full"):
        label = "PD"  # half the orbit is doubled
    if label == "LP" and {"a", "b"} <= set(point.coefficients):
        return label, (PRODUCT, 0.0)
    if label in COEFFICIENTS and point.criticality is not None:
        return label, COEFFICIENTS[label]
    return label, ("", 0.0)


def _stored(point: SpecialPoint, name: str) -> tuple[float | None, float]:
    """The record's own coefficient, and its error."""
    if name == PRODUCT:
        return float(point.coefficients["a"]) * float(point.coefficients["b"]), 0.0
    value = point.coefficients.get(name)
    return None if value is None else float(value), float(point.coefficients.get(f"{name}_error", 0.0))


def _own(label: str, point: SpecialPoint, equations: Equations, found: Solution) -> Told:
    """The coefficient by differences, of a critical vector as long as that of the record's."""
    at = found.at
    if isinstance(equations, Unfolded):
        at, equations = equations.inner(at), equations.equations
    if isinstance(equations, EquilibriumEquations):
        forms = {"BP": coefficients.pitchfork, "LP": coefficients.fold}
        form = forms.get(label) or coefficients.lyapunov(float(point.coefficients["omega"]))
        return coefficients.told(equations, at.z, form)
    if not isinstance(equations, OrbitEquations):
        raise CannotTell("Its equations have no return map.")
    round_ = Round(equations, at, TIGHT)
    theta = critical_angle(at) if label == "NS" else 0.0
    value = complex(np.exp(1j * theta)) if label == "NS" else -1.0 if label == "PD" else 1.0
    form_of = {
        "PD": normal_forms.flip,
        "BP": normal_forms.pitchfork,
        "LP": normal_forms.fold,
        "NS": lambda given: normal_forms.torus(given, theta),
    }
    found_ = normal_forms.told(round_, value, form_of[label])
    if label == "LP":  # no length of q changes it
        return found_
    square = squared(equations, at, round_.basis @ normal_forms.critical(round_.matrix, value)[0], value)
    size = found_.value / square.value
    return Told(size, found_.error / square.value + abs(size) * square.error / square.value)

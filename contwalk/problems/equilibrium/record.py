"""The record of a special point of an equilibrium: its normal form, and what is to be said about it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.equilibrium.normal_forms import (
    branch_point_coefficients,
    fold_coefficients,
    hopf_coefficients,
)
from contwalk.problems.equilibrium.second_direction import keep_parameter
from contwalk.problems.problem import Located, Sample
from contwalk.system import Symmetry

if TYPE_CHECKING:
    from contwalk.problems.equilibrium.equilibrium import Equilibrium

# A coefficient has a sign if it is this many times its estimated error.
SURE = 10.0


def described(problem: Equilibrium, label: str, located: Located, sample: Sample, s: float) -> SpecialPoint:
    """The record of a located point, with its normal form."""
    z = located.z
    try:
        kind, criticality, coefficients, note = _normal_form(problem, label, located, sample)
    except np.linalg.LinAlgError:
        kind, criticality, coefficients = None, None, {}
        note = "degenerate: the critical directions are not determined, so there is no normal form"
    return SpecialPoint(
        label=label,
        s=s,
        kind=kind,
        parameters=problem.values_of(z) | {problem.free: float(z[-1])},
        state=dict(zip(problem.system.state_names, z[: problem.states].tolist(), strict=True)),
        spectrum=tuple(complex(v) for v in sample.spectrum),
        error=located.error,
        criticality=criticality,
        coefficients=coefficients,
        note=note,
        unknowns=tuple(z.tolist()),
        tangent=tuple(sample.tangent.tolist()),
    )


def _normal_form(
    problem: Equilibrium, label: str, located: Located, sample: Sample
) -> tuple[str | None, str | None, dict[str, Any], str | None]:
    """Kind, criticality, coefficients and note of a located point."""
    kind: str | None = None
    criticality: str | None = None
    coefficients: dict[str, Any] = {}
    note: str | None = None
    if label == "LP":
        coefficients = fold_coefficients(problem, located)
    elif label == "HB":
        coefficients = hopf_coefficients(problem, located, sample.weights)
        criticality, note = _hopf(problem, coefficients)
    elif "multiplicity" in located.vectors:
        coefficients = {"multiplicity": located.vectors["multiplicity"]}
        note = (
            f"{located.vectors['multiplicity']} real eigenvalues vanish together: more than two branches "
            "may meet here; the other ones are not followed"
        )
    elif label == "BP":
        kind, criticality, coefficients, note = _branch_point(problem, located, sample.weights)
    if located.vectors.get("turns"):
        turns = "the parameter turns here as well: a fold that is not told apart"
        note = f"{note}; {turns}" if note else turns
    return kind, criticality, coefficients, note


def _branch_point(
    problem: Equilibrium, located: Located, weights: np.ndarray
) -> tuple[str | None, str | None, dict[str, Any], str | None]:
    if keep_parameter(problem, located.z, weights):
        return None, None, {}, "both branches that cross here keep the parameter: there is no criticality"
    c = branch_point_coefficients(problem, located, weights)
    numbers = {name: c[name] for name in ("c11", "c12", "c22", "c", "c_error")}
    numbers["convention"] = (
        "c11 s^2 + 2 c12 s t + c22 t^2 = 0 for the directions s q + t h; "
        "c = p.(C(q,q,q) - 3 B(q, A^-1 B(q,q)))/6, |q| = 1, p.q = 1"
    )
    if c["c11"] != 0.0:
        return "transcritical", None, numbers, None
    if c["c"] == 0.0:
        note = "the other branch keeps the parameter to third order: it may be vertical"
        return "pitchfork", None, numbers, note
    if abs(c["c"]) <= SURE * c["c_error"]:
        return "pitchfork", None, numbers, "degenerate: the cubic coefficient is zero to its error"
    critical = "supercritical" if c["c"] < 0 else "subcritical"
    symmetry = _breaks(problem, located.z, c["q"])
    if symmetry is None:
        return "pitchfork", critical, numbers, None
    note = f"the branches that leave are images of each other under the symmetry '{symmetry.name}'"
    kind = "symmetry-breaking" if symmetry.role == "spatial" else "pitchfork"
    return kind, critical, numbers, note


def _hopf(problem: Equilibrium, coefficients: dict[str, Any]) -> tuple[str | None, str | None]:
    """Criticality and note of a Hopf point."""
    if abs(coefficients["l1"]) <= SURE * coefficients["l1_error"]:
        return None, "degenerate: the first Lyapunov coefficient is zero to its error"
    criticality = "supercritical" if coefficients["l1"] < 0 else "subcritical"
    held = "l1 is that of the motion with the pinned neutral directions held"
    return criticality, held if problem.pins else None


def _breaks(problem: Equilibrium, z: np.ndarray, q: np.ndarray) -> Symmetry | None:
    """The declared symmetry that a branch point's state has and its critical vector has not."""
    n = problem.states
    for symmetry in problem.system.symmetries:
        image = problem.image(symmetry.name, z)[:n]
        moved = problem.image(symmetry.name, np.append(z[:-1] + 1e-3 * q, z[-1]))[:n] - image
        kept = np.allclose(image, z[:n], rtol=1e-9, atol=1e-12)
        if kept and not np.allclose(moved, 1e-3 * q[:n], rtol=1e-6, atol=1e-12):
            return symmetry
    return None

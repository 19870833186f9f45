"""Curves in two parameters from located special points of equilibria."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import StartError
from contwalk.numerics.linear import balanced
from contwalk.problems.locus.curves import (
    BRANCH_POINTS,
    CURVES,
    FOLDS,
    HOPF_POINTS,
    LABELS,
    MARKED,
    AtParameter,
    Curve,
    FamilyFolds,
    ObservableAt,
    PairAt,
    RealEigenvalueAt,
)
from contwalk.problems.locus.equilibrium_locus import EquilibriumLocus, plane_of, spans_of
from contwalk.problems.locus.persistence import not_followed
from contwalk.problems.locus.plane import Plane
from contwalk.problems.problem import MAX_RE
from contwalk.system import Neutral, System


def locus_at(
    system: System,
    point: SpecialPoint,
    parameters: dict[str, float],
    free: tuple[str, str],
    pins: Sequence[Neutral] = (),
    discretization: Any = None,
    ranges: Mapping[str, tuple[float, float]] | None = None,
) -> tuple[EquilibriumLocus, np.ndarray]:
    """The curve through a located special point of equilibria, and that point's z, shape (N + 1,).

    Parameters
    ----------
    system : System
    point : SpecialPoint
        An LP, HB, BP or UZ point of a branch of equilibria.
    parameters : dict
        All parameters there.
    free : pair of str
        The two parameters.
    pins : sequence of Neutral
        Neutral directions pinned along the branch.
    discretization : Discretization, optional
        Of the orbits that are born on the branch.
    ranges : mapping, optional
        Those of both parameters, by name.

    Raises
    ------
    StartError
        If no curve begins there.
    """
    curve, own = followed_from(system, point, free)
    n = len(system.states)
    state = np.array([point.state[name] for name in system.state_names])
    drifts = np.array(point.unknowns[n : n + len(pins)])
    plane = plane_of(system, parameters, free, pins, state, discretization)
    values = [parameters[name] for name in reversed(free)]
    z = np.concatenate([state, drifts, [own] * curve.own, values])
    if curve is FOLDS and pins and _of_family(plane, z, float(np.abs(point.spectrum).min(initial=np.inf))):
        curve = FamilyFolds()
    return EquilibriumLocus(plane, curve, z, spans_of(ranges or {}, (free[1], free[0]))), z


def _of_family(plane: Plane, z: np.ndarray, nearest: float) -> bool:
    """Whether at a fold z, (N + 2,), what fixes held directions is at a right angle to one of them.

    There (F_u - s E) q = 0 has solutions along what is held, whatever s is: a family turns back, and no
    eigenvalue need be zero, of which the `nearest` one is so large. Of both, as parts of what they are parts
    of, the smaller one is what vanishes.
    """
    n = plane.states
    scaled, _ = balanced(plane.jacobian(z)[:, : plane.size])
    fixing, along = scaled[n:, :n], scaled[:n, n:]
    cosines = fixing @ along / np.outer(np.linalg.norm(fixing, axis=1), np.linalg.norm(along, axis=0))
    return bool(nearest > np.linalg.norm(scaled[:n, :n]) * np.linalg.norm(cosines, -2))


def followed_from(system: System, point: SpecialPoint, free: tuple[str, str]) -> tuple[Curve, float]:
    """What the curve through a special point is of, and its own unknown there.

    Raises
    ------
    StartError
        If no curve begins there.
    """
    if point.label not in LABELS or point.status != "located" or "pairs" in point.coefficients:
        raise StartError(
            f"No curve in two parameters can be followed from {point.name or point.label}.",
            "Start at a located fold (LP), Hopf point (HB), branch point (BP) or marked value (UZ) of "
            "equilibria.",
        )
    if point.label == BRANCH_POINTS.of and "multiplicity" in point.coefficients:
        raise StartError(
            f"No curve in two parameters can be followed from {point.name or point.label}: "
            f"{point.coefficients['multiplicity']} eigenvalues vanish there together.",
            "Start at a branch point where one does.",
        )
    if point.label == MARKED:
        return _marked(system, point, free)
    curve = CURVES[point.label]
    return curve, float(point.coefficients["omega"]) ** 2 if curve.pair else 0.0


def _marked(system: System, point: SpecialPoint, free: tuple[str, str]) -> tuple[Curve, float]:
    """What the curve through a marked value is of, and its own unknown there."""
    name, level = point.mark.get("name"), point.mark.get("value")
    known = {observable.name for observable in system.observables}
    if name in known and level is not None:
        return ObservableAt(str(name), float(level)), 0.0
    if name in free and level is not None:
        return AtParameter(-1 - free.index(str(name)), float(level)), 0.0
    if name == MAX_RE and level is not None and point.spectrum:
        leading = max(point.spectrum, key=lambda value: value.real)
        kappa = leading.imag**2
        if level == 0.0 and kappa > 0.0:
            return HOPF_POINTS, kappa
        if level != 0.0:
            return (PairAt(float(level)), kappa) if kappa > 0.0 else (RealEigenvalueAt(float(level)), 0.0)
    raise StartError(
        f"No curve in two parameters can be followed from {point.name or point.label}: "
        f"{not_followed(point, free)}",
        "Mark a value of an observable of the system, of max_re, or of one of both parameters.",
    )

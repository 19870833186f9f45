"""The record of a special point of an orbit: its normal form, and what is to be said about it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import NotFinite
from contwalk.problems.images import to_declare
from contwalk.problems.kink import FieldKink
from contwalk.problems.orbit import volumes
from contwalk.problems.orbit.normal_forms import SectionMap
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.protocol import OrbitKind
from contwalk.problems.problem import Located, Sample
from contwalk.special_point import allowed_error
from contwalk.system.held import settled

# Where theta is this near to 2 pi k / q, q = 1..4, the point is a strong resonance.
RESONANT = 1e-6
# A coefficient this small is zero: deviations as large as the orbit, or as the states on it where they move
# little (the ripple of a converter), would do nothing.
VANISHES = 1e-9
# How well a coefficient is known is told by steps of this many times the tolerance: some ten times its error.
COARSER = 10.0
# Multipliers that meet are known to the root of rounding only.
MEET = 1e-3
# Coefficients that take third derivatives of the motion.
CUBIC = ("c", "d", "c_error", "d_error")
PAIR = (
    "multipliers come in pairs mu, 1/mu here, and a pair meets: no coefficient tells which side is stable, "
    "but the multipliers of solutions on either side do"
)

TOGETHER = "{} multipliers are {:g} together, as a symmetry of the field makes them: "
KEPT = "{} of the orbits that leave, as symmetries keep them, up to images; others are not looked for"
NONE_KEPT = (
    "the orbits that leave are not followed, for no symmetry is known that tells their directions (one that "
    "is stable is found by simulating beside this value, start: {simulate: {state: {...}}})"
)

Form = tuple[str | None, str | None, dict[str, Any], str | None]


def described(
    problem: OrbitData, kind: OrbitKind, located: Located, sample: Sample, s: float
) -> SpecialPoint:
    """The record of a located point, with its normal form."""
    there = located.problem if located.problem is not None else problem
    variant, criticality, coefficients, note = with_reason(lambda: _form(there, kind, located, sample))
    criticality, coefficients, note = _beside_kinks(sample, criticality, coefficients, note)
    value, weight = abs(float(located.z[-1])), float(sample.weights[-1])
    asked = problem.discretization.accuracy
    if located.refined and located.error > allowed_error(asked, value, located.error, weight):
        share = f", {located.error / value:.1e} of the value" if value > 0.0 else ""
        known = f"known to {located.error:.1e}{share} only"
        limit = f"{known}: rounding does not allow the accuracy of {asked:g} that was asked for"
        note = limit if note is None else f"{note}; {limit}"
    told = variant, criticality, coefficients, note
    return record(problem, there, located, sample, sample.eigenvalues, told, label=kind.label, s=s)


def with_reason(form: Callable[[], Form]) -> Form:
    """A normal form, or why there is none."""
    try:
        return form()
    except np.linalg.LinAlgError:
        why = "degenerate: the critical directions are not determined, so there is no normal form"
    except NotFinite as error:
        why = f"there is no normal form: {error.sentence}"
    return None, None, {}, why


def record(
    problem: Any, there: Any, located: Located, sample: Sample, values: np.ndarray, form: Form, **more: Any
) -> SpecialPoint:
    """The record of a point of a branch or a curve of orbits.

    `there` is what it was located on, `values` are its multipliers, shape (m,); `more` is what else it says.
    """
    z, spectrum = located.z, tuple(complex(v) for v in values)
    kind, criticality, coefficients, note = form
    duration, (_, fold) = problem.duration(z), problem.whole
    state = there.reported(z) if sample.reported is None else sample.reported
    return SpecialPoint(
        kind=kind,
        parameters=settled(problem.system, problem.values_of(z) | {problem.free: float(z[-1])}),
        state=dict(zip(problem.system.state_names, state.tolist(), strict=True)),
        period=duration,
        period_full=duration * fold,
        spectrum=spectrum,
        spectrum_full=None if fold == 1 else tuple(v**fold for v in spectrum),
        trivial_error=sample.trivial_error if np.isfinite(sample.trivial_error) else None,
        error=located.error,
        errors=dict(located.errors),
        criticality=criticality,
        coefficients=coefficients,
        note=note,
        unknowns=tuple(z.tolist()),
        tangent=tuple(sample.tangent.tolist()),
        **more,
    )


def _beside_kinks(
    sample: Sample, criticality: str | None, coefficients: dict[str, Any], note: str | None
) -> tuple[str | None, dict[str, Any], str | None]:
    """What is right of a normal form where the orbit meets places at which derivatives of the field jump."""
    orders = [k.order for k in sample.kinks if isinstance(k, FieldKink) and k.moves and 0 < k.order < 3]
    if not orders or not (criticality or coefficients):
        return criticality, coefficients, note
    told = {} if min(orders) == 1 else {k: v for k, v in coefficients.items() if k not in CUBIC}
    what, lost = (
        ("slopes", "normal form is")
        if min(orders) == 1
        else ("second derivatives", "cubic coefficient and criticality are")
    )
    why = f"the orbit crosses a place where {what} of the field jump: its {lost} not known"
    return None, told, why if note is None else f"{note}; {why}"


def _form(problem: OrbitData, point: OrbitKind, located: Located, sample: Sample) -> Form:
    """Kind, criticality, coefficients and note of a located point."""
    if point.multiplier is None or not _double(sample, point.multiplier):
        return point.form(problem, located, sample)
    count, directions = _together(problem, located, sample, point.multiplier)
    if directions < count or problem.system.conserved or volumes.kept(problem, located.z):
        return point.form_of_pair(problem, located, sample)
    form = point.form(problem, located, sample)
    if count < 2:
        return form
    # No coefficient along one direction tells of what leaves along several.
    return form[0], None, {"multiplicity": count}, _several(problem, located.z, point.multiplier, count)


def _several(problem: OrbitData, z: np.ndarray, multiplier: float, count: int) -> str:
    """What leaves where several multipliers are critical, in words."""
    kept, orders = problem.kept_directions(z, multiplier, count)
    told = TOGETHER.format(count, multiplier) + (KEPT.format(len(kept)) if kept else NONE_KEPT)
    return f"{told}; {to_declare(orders, problem.system.state_names, 'orbits')}" if orders else told


def _double(sample: Sample, critical: float) -> bool:
    """Whether two multipliers meet at a critical value, as those of a pair mu, 1/mu do."""
    return int(np.sum(np.abs(sample.eigenvalues - critical) < MEET)) > 1


def _together(problem: OrbitData, located: Located, sample: Sample, critical: float) -> tuple[int, int]:
    """How many multipliers are a critical value to their errors, and how many directions they have.

    A symmetry makes several, each with its own; where areas are kept two have one.
    """
    known = np.minimum(sample.errors, MEET)
    together = np.abs(sample.eigenvalues - critical) <= known
    count = int(np.count_nonzero(together))
    if count < 2:  # one has its own direction
        return count, count
    a = problem.return_map(located.z).a
    sizes = np.linalg.svd(a - critical * np.eye(len(a)), compute_uv=False)
    least = known[together].max() * float(np.linalg.norm(a, 2))
    return count, int(np.count_nonzero(sizes <= max(least, sizes[-1])))


def known(
    problem: OrbitData,
    located: Located,
    sample: Sample,
    name: str,
    form: Callable[[SectionMap], dict[str, Any]],
) -> dict[str, Any]:
    """A normal form with the estimated error of one coefficient: what it is on coarser steps tells.

    What the point itself is known to counts as well. Where there is no motion on these steps there is no
    estimate.
    """
    z, found, tolerance = located.z, form(problem.return_map(located.z)), problem.mesh.tolerance
    try:
        coarse = problem.refined(z, sample.weights, COARSER * tolerance)
        error = abs(form(coarse.return_map(z))[name] - found[name]) + tolerance * abs(found[name])
    except (NotFinite, np.linalg.LinAlgError):
        return found
    return {**found, f"{name}_error": error} if np.isfinite(error) else found


def negligible(problem: OrbitData, located: Located, value: complex) -> float:
    """Below what a cubic coefficient of a critical multiplier is zero, as of a linear system."""
    map_ = problem.return_map(located.z)
    return VANISHES * map_.unit_of_cubic(map_.critical(value)[0])


def criticality_of(
    coefficient: float, error: float | None, least: float = VANISHES
) -> tuple[str | None, str | None]:
    """Criticality by the sign of a coefficient, and a note where it vanishes; `least` as of `negligible`."""
    if abs(coefficient) < least:
        return None, "degenerate: the cubic coefficient is zero, as of a linear system"
    if error is not None and abs(coefficient) <= error:
        return None, "degenerate: the cubic coefficient is zero to its error"
    return "supercritical" if coefficient < 0 else "subcritical", None

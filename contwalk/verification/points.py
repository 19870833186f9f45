"""A special point recomputed: its equations and what defines it, solved from where it says that it is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from contwalk.branch import Branch, SpecialPoint
from contwalk.labels import LOCUS, MARK
from contwalk.system import System
from contwalk.verification.branching import Unfolded
from contwalk.verification.conditions import BOTH, RESONANCES, SPECTRAL, spectral
from contwalk.verification.curves import SYMMETRY_BREAKING, of_curve, unfolds
from contwalk.verification.declared import boundary, kind_of, own_test
from contwalk.verification.degenerate import ON, vanishing
from contwalk.verification.equations import Equations, Evaluation
from contwalk.verification.equilibrium import EquilibriumEquations
from contwalk.verification.finding import (
    AGREES,
    CANNOT_TELL,
    DISAGREES,
    SLACK,
    CannotTell,
    Contradiction,
    Finding,
    judged_by_errors,
)
from contwalk.verification.limits import KINDS, limit
from contwalk.verification.marks import mark
from contwalk.verification.orbit import OrbitEquations
from contwalk.verification.records import equations_of, free_of, method_of
from contwalk.verification.rows import checked_row
from contwalk.verification.solving import Condition, NotThere, Sheet, Solution, solved
from contwalk.verification.words import told

# A grazing orbit at something else as well.
GRAZINGS = ("GRLP", "GRPD", "GRNS")
# Points of curves whose own conditions say what the curve is of.
WHOLE = (*BOTH, *RESONANCES, "BT", "CP")


def checked_point(system: System, branch: Branch, point: SpecialPoint) -> Finding:
    """One special point, recomputed from its own words."""
    begun = Finding(branch.name, point.name, branch.info.free[0], method=method_of(branch))
    if point.status != "located":
        return replace(begun, reason="it was not located in the first place")
    if point.label == MARK and point.kind == "parameter" and branch.info.problem != LOCUS:
        return _at_value(system, branch, point, begun)
    stored = free_of(branch, point)
    named = np.array(
        [point.parameters.get(name, value) for name, value in zip(branch.info.free, stored, strict=True)]
    )
    if np.any(named != stored):
        return replace(begun, verdict=DISAGREES, reason="its parameters and its unknowns are not the same")
    errors = np.array(
        [point.error if i == 0 else point.errors.get(name) for i, name in enumerate(branch.info.free)],
        dtype=float,
    )
    if not np.isfinite(errors).all():
        return replace(begun, reason="it has no error that it could be compared with")
    try:
        equations, conditions = _defined(system, branch, point)
        sheet = Sheet(equations)
        found = solved(sheet, conditions(sheet))
    except NotThere as failure:
        return _lost(begun, point, failure, stored, errors)
    except CannotTell as why:
        verdict = DISAGREES if isinstance(why, Contradiction) else CANNOT_TELL
        return replace(begun, verdict=verdict, reason=str(why))
    result = _judged(begun, branch, found, equations, errors)
    if result.verdict == AGREES:
        verdict, reason = told(branch, point, equations, found)
        return replace(result, verdict=verdict, reason=reason)
    return result


def _at_value(system: System, branch: Branch, point: SpecialPoint, begun: Finding) -> Finding:
    """A marked value of the free parameter: that it has it, and the solution there as of any row."""
    free, marked = branch.info.free[0], point.mark
    if marked and marked["name"] == free and marked["value"] != point.parameters.get(free):
        return replace(begun, verdict=DISAGREES, reason=f"{free} is not {marked['value']:.10g} there")
    return replace(checked_row(system, branch, point.index)[0], record=point.name)


def _defined(
    system: System, branch: Branch, point: SpecialPoint
) -> tuple[Equations, Callable[[Sheet], list[Condition]]]:
    """A point's equations, and what defines it beside them."""
    equations = equations_of(system, branch, point)
    curve = branch.info.problem == LOCUS and (point.label not in WHOLE or unfolds(branch))
    labels = _parts(branch, point)
    if unfolds(branch) or "BP" in labels:
        equations = Unfolded(equations)

    def conditions(sheet: Sheet) -> list[Condition]:
        found = of_curve(branch, point.spectrum, equations, sheet) if curve else []
        found += [each for label in labels for each in _one(label, branch, point, equations, sheet)]
        if len(found) < sheet.along.shape[1]:
            raise CannotTell(f"What defines {point.label} is not recomputed.")
        return found

    return equations, conditions


def _parts(branch: Branch, point: SpecialPoint) -> list[str]:
    """What a point is, as labels: one, or of a curve what it is beside that."""
    label, of = point.label, str(branch.info.settings.get("of"))
    if label in GRAZINGS:
        return [label[2:] if of == "GR" else "GR"]
    if label == "GRGR":
        return ["GR"]
    halved = branch.info.closure not in (None, "full")
    if label == "BP" and point.kind == SYMMETRY_BREAKING and halved:
        return ["PD"]  # the multiplier -1 of the map of a half
    return [label]


def _one(
    label: str, branch: Branch, point: SpecialPoint, equations: Equations, sheet: Sheet
) -> list[Condition]:
    """What one label demands."""
    if isinstance(equations, Unfolded):
        if label == "BP":
            return equations.conditions
        if label not in (MARK, *RESONANCES, *SPECTRAL):
            own = _one_of(label, point, equations.equations, equations.inner(sheet.begin))
            return [lambda at: own(equations.inner(at))]
    if label == MARK:
        return [mark(branch, point, equations, sheet)]
    if label in ON or label in KINDS or label == "BE" or kind_of(equations.functions.system, label):
        return [_one_of(label, point, equations, sheet.begin)]
    return spectral(label, point.spectrum, equations, sheet)


def _one_of(label: str, point: SpecialPoint, equations: Equations, begin: Evaluation) -> Condition:
    """The condition of a label that is neither one of eigenvalues nor of a mark."""
    if label in ON:
        return vanishing(label, equations)
    if label in KINDS and isinstance(equations, OrbitEquations):
        return limit(label, point, equations, begin)
    if label == "BE" and isinstance(equations, EquilibriumEquations):
        return boundary(point, equations)
    if (declared := kind_of(equations.functions.system, label)) is not None:
        return own_test(declared, begin)
    raise CannotTell(f"What defines {label} is not recomputed.")


def _lost(
    begun: Finding, point: SpecialPoint, failure: NotThere, stored: np.ndarray, errors: np.ndarray
) -> Finding:
    """A point to which Newton's method does not come back: its first step says how far it would be."""
    size = len(failure.first) - len(stored)
    allowed = SLACK * (errors + failure.noise[size:])
    away = float(np.max(np.abs(failure.first[size:]) / np.maximum(allowed, np.spacing(np.abs(stored)))))
    if away > 1.0:
        return replace(begun, verdict=DISAGREES, reason="what defines it has no solution near it")
    return replace(begun, reason=str(failure))


def _judged(
    begun: Finding, branch: Branch, found: Solution, equations: Equations, errors: np.ndarray
) -> Finding:
    """Whether the parameters agree: by the one that is off by most."""
    size = equations.size
    moved, own = np.abs(found.moved[size:]), found.error[size:]
    worst = int(np.argmax(moved / (errors + own)))
    value = float(found.at.z[size + worst])
    result = replace(
        begun,
        quantity=branch.info.free[worst],
        stored=value - float(found.moved[size + worst]),
        recomputed=value,
        difference=float(moved[worst]),
        stored_error=float(errors[worst]),
        own_error=float(own[worst]),
    )
    return judged_by_errors(result, float(np.spacing(equations.sizes[size + worst])))

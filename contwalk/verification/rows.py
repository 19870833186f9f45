"""An ordinary row recomputed: the solution beside its error, its leading eigenvalue, its stability."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.branch import Branch
from contwalk.labels import LOCUS
from contwalk.system import System
from contwalk.verification.admissible import judged, kept
from contwalk.verification.branching import Unfolded
from contwalk.verification.curves import of_curve, on_limit, unfolds
from contwalk.verification.equations import Equations
from contwalk.verification.finding import (
    AGREES,
    DISAGREES,
    MOVED,
    SLACK,
    CannotTell,
    Finding,
    judged_by_errors,
)
from contwalk.verification.orbit import OrbitEquations
from contwalk.verification.passage import COARSER, TIGHT
from contwalk.verification.records import equations_of, method_of
from contwalk.verification.solving import ROUGH, Condition, Held, NotThere, Sheet, Solution, solved

# How many eigenvalues are at the border all along a curve.
CRITICAL = {"LP": 1, "BP": 1, "PD": 1, "HB": 2, "NS": 2}


def checked_row(system: System, branch: Branch, row: int) -> list[Finding]:
    """The solution of a row, its leading eigenvalue, and how many directions are unstable."""
    begun = Finding(branch.name, str(row), "solution", method=method_of(branch))
    try:
        equations = equations_of(system, branch, row)
        if unfolds(branch):
            equations = Unfolded(equations)
        sheet = Sheet(equations, _tolerance(branch, row))
        found = solved(sheet, _conditions(branch, row, equations, sheet))
    except NotThere as failure:
        return [_lost(begun, branch, row, equations, failure)]
    except CannotTell as reason:
        return [replace(begun, reason=str(reason))]
    result = [_solution(begun, branch, row, equations, found, sheet.rounding(found.at))]
    if np.isfinite(found.at.matrix).all() and len(found.at.spectrum):
        result += [
            _leading(begun, branch, row, equations, found),
            _stability(begun, branch, row, equations, found),
        ]
    return result + _admissible(begun, branch, row, equations, found)


def _admissible(
    begun: Finding, branch: Branch, row: int, equations: Equations, found: Solution
) -> list[Finding]:
    """Whether the machine moves so, where there is anything that it could pass."""
    stored, numbers = bool(branch.points["admissible"][row]), kept(equations, found)
    if stored and not any(each.judged for each in numbers):
        return []
    verdict, reason = judged(stored, numbers, on_limit(branch))
    result = replace(begun, quantity="admissible", stored=float(stored), verdict=verdict, reason=reason)
    return [result if verdict != AGREES else replace(result, recomputed=float(stored), difference=0.0)]


def _conditions(branch: Branch, row: int, equations: Equations, sheet: Sheet) -> list[Condition]:
    """What a curve is of, and that nothing moves along it."""
    if not (own := of_curve(branch, branch.points["spectrum"][row], equations, sheet)):
        which, scale = _compared(branch, row, equations)
        normal = sheet.along[which, 0] / scale**2
        gradient = np.zeros(len(equations.z))
        gradient[which] = normal / np.linalg.norm(normal * scale)
        return [Held(equations.z, gradient)]
    along = along_curve(branch, row, equations)
    return [*own, Held(equations.z, np.append(np.zeros(equations.size), along))]


def _tolerance(branch: Branch, row: int) -> float:
    """The coarser tolerance of motions by what the row says that it is known to.

    As much smaller as errors grow on a piece, and as a check that sees so many errors has to see one.
    """
    at = branch.points[row]
    leading = max(abs(complex(at["spectrum"][0])) if len(at["spectrum"]) else 1.0, 1.0)
    claims = [float(at["error"]), float(at["spectrum_error"]) / leading]
    known = min((each for each in claims if each > 0.0), default=0.0)  # what is not a number is not known
    return float(np.clip(known / (MOVED * MOVED), COARSER * TIGHT, ROUGH))


def _compared(branch: Branch, row: int, equations: Equations) -> tuple[np.ndarray, np.ndarray]:
    """Where the state at the start, durations and the free parameters stand in z, and their weights in the
    metric.

    What an orbit passes later is no word of the record: it is followed from its start, from which it may have
    grown away.
    """
    k, weights = len(equations.free), branch.points[row]["weights"][: len(branch.unknowns(row))]
    n, lasting, durations = equations.rank, slice(0), np.arange(0)
    if isinstance(equations, OrbitEquations):
        n, lasting, last = len(equations.first[0]), equations.lasting, equations.size - 1
        durations = np.arange(last - equations.count, last)[: len(weights[lasting])]
    which = np.concatenate([np.arange(n), durations, np.arange(len(equations.z) - k, len(equations.z))])
    return which, np.concatenate([weights[:n], weights[lasting], weights[: -1 - k : -1]])


def along_curve(branch: Branch, row: int, equations: Equations) -> np.ndarray:
    """The direction of a curve at a row, by which free parameters are measured in their sizes, shape (2,)."""
    sizes = equations.sizes[equations.size :]
    tangent = branch.points["tangent"][row][: len(branch.unknowns(row))][[-1, -2]] / sizes
    return np.asarray(tangent / np.linalg.norm(tangent) / sizes)


def _lost(begun: Finding, branch: Branch, row: int, equations: Equations, failure: NotThere) -> Finding:
    """A row to which Newton's method does not come back: its first step says how far it would be."""
    which, scale = _compared(branch, row, equations)
    away, noise = (float(np.linalg.norm(step[which] / scale)) for step in (failure.first, failure.noise))
    if away > SLACK * (float(branch.points[row]["error"]) + noise):
        return replace(begun, verdict=DISAGREES, reason="no solution is near it")
    return replace(begun, reason=str(failure))


def _solution(
    begun: Finding, branch: Branch, row: int, equations: Equations, found: Solution, rounding: np.ndarray
) -> Finding:
    """How far the solution is from its row, in the row's own metric."""
    at, (which, scale) = branch.points[row], _compared(branch, row, equations)
    moved, error = found.moved[which] / scale, (found.error + rounding)[which] / scale
    result = replace(
        begun,
        stored=0.0,
        recomputed=float(np.linalg.norm(moved)),
        difference=float(np.linalg.norm(moved)),
        stored_error=float(at["error"]),
        own_error=float(np.linalg.norm(error)),
    )
    if not np.isfinite(result.stored_error):
        return replace(result, reason="the row has no error that it could be compared with")
    return judged_by_errors(result, float(np.linalg.norm(np.spacing(np.abs(found.at.z[which])) / scale)))


def _leading(begun: Finding, branch: Branch, row: int, equations: Equations, found: Solution) -> Finding:
    """The leading eigenvalue; what the solution moved by, which is judged for itself, counts as an error."""
    at = branch.points[row]
    stored, spectrum = complex(at["spectrum"][0]), found.at.spectrum
    begun = replace(begun, quantity="leading eigenvalue")
    if not np.isfinite(stored) or not np.isfinite(at["spectrum_error"]):
        return replace(begun, reason="the row does not tell its leading eigenvalue")
    nearest = int(np.argmin(np.abs(spectrum - stored)))
    known = float(found.spread[nearest] + np.spacing(np.abs(spectrum).max()) * len(spectrum))
    result = replace(
        begun,
        stored=abs(stored),
        recomputed=float(abs(spectrum[nearest])),
        difference=float(abs(spectrum[nearest] - stored)),
        stored_error=float(at["spectrum_error"]),
        own_error=known,
    )
    if result.difference > SLACK * (result.stored_error + known):
        # The same orbit but for its start, which is where the row has it: it is followed no farther from it.
        which, z = _compared(branch, row, equations)[0], found.at.z.copy()
        z[which] = equations.z[which]
        shifted = np.abs(equations.at(z, found.at.relative).spectrum - spectrum[nearest]).min()
        result = replace(result, own_error=known + float(shifted))
    return judged_by_errors(result, float(np.spacing(np.abs(spectrum).max())))


def _stability(begun: Finding, branch: Branch, row: int, equations: Equations, found: Solution) -> Finding:
    """How many directions are unstable, as far as the errors tell the sign of each."""
    at = branch.points[row]
    least, most = unstable_between(branch, found, equations.unit)
    result = replace(
        begun, quantity="unstable directions", stored=float(at["unstable"]), recomputed=float(least)
    )
    if at["undecided"] > 0:
        return replace(result, reason="the row itself says that its stability is not known")
    if not least <= at["unstable"] <= most:
        return replace(
            result, verdict=DISAGREES, reason=f"there are {least}" + (f" to {most}" if most > least else "")
        )
    if int(at["stable"]) != int(at["unstable"] == 0) and branch.info.problem != LOCUS:
        return replace(
            result, verdict=DISAGREES, reason="its stability is not what its unstable directions say"
        )
    if least < most:
        return replace(result, reason=f"there are {least} to {most}: an eigenvalue is at the border")
    return replace(result, difference=0.0, verdict=AGREES)


def unstable_between(branch: Branch, found: Solution, unit: bool) -> tuple[int, int]:
    """How many eigenvalues are beyond the border for certain, and may be; those of a curve are none."""
    spectrum = found.at.spectrum
    level = SLACK * found.spread + len(spectrum) * np.spacing(np.abs(spectrum).max())
    beyond = np.abs(spectrum) - 1.0 if unit else spectrum.real
    critical = CRITICAL.get(str(branch.info.settings.get("of")), 0) if branch.info.problem == LOCUS else 0
    order = np.argsort(np.abs(beyond))
    held = order[:critical]
    # A fold in what says where on a held family one is has no eigenvalue at the border: all count there.
    if critical and np.all(np.abs(beyond[held]) <= level[held]):
        saddle = int(critical == 2 and not np.any(np.abs(spectrum[held].imag) > 0.0))
        beyond, level = beyond[order[critical:]], level[order[critical:]]
        return int(np.sum(beyond > level)) + saddle, int(np.sum(beyond > -level)) + saddle
    return int(np.sum(beyond > level)), int(np.sum(beyond > -level))

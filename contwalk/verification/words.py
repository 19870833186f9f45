"""What a special point says beside its place: its eigenvalues, counts, and which way what leaves it turns."""

from __future__ import annotations

import numpy as np

from contwalk.branch import Branch, SpecialPoint
from contwalk.labels import LOCUS
from contwalk.verification.admissible import judged as kept_or_not
from contwalk.verification.admissible import kept, margins_agree
from contwalk.verification.conditions import RESONANCES
from contwalk.verification.criticality import judged
from contwalk.verification.curves import on_limit
from contwalk.verification.equations import Equations
from contwalk.verification.finding import AGREES, CANNOT_TELL, DISAGREES, SLACK
from contwalk.verification.limits import KINDS
from contwalk.verification.passage import EPSILON
from contwalk.verification.solving import Solution

# Multipliers of which no digit is known: what should be one, or the leading one, is off by a tenth.
NO_DIGIT = 0.1
# How many eigenvalues cross.
CROSSING = {"LP": 1, "HB": 2, "PD": 1, "NS": 2}


def told(branch: Branch, point: SpecialPoint, equations: Equations, found: Solution) -> tuple[str, str]:
    """A verdict and its reason on what a point says beside its place."""
    numbers = kept(equations, found)
    at_limit = on_limit(branch) or point.label in (*KINDS, "BE") or point.label.startswith("GR")
    found_ = [
        _critical(branch, point, equations, found),
        kept_or_not(point.admissible, numbers, at_limit),
        margins_agree(point.margin, numbers, _claim(branch, point, found)),
    ]
    return next(
        (each for word in (DISAGREES, CANNOT_TELL) for each in found_ if each[0] == word), (AGREES, "")
    )


def _critical(branch: Branch, point: SpecialPoint, equations: Equations, found: Solution) -> tuple[str, str]:
    """A verdict and its reason on eigenvalues, counts, and which way what leaves it turns."""
    located = branch.info.problem != LOCUS
    if (located and point.label in CROSSING) or point.label in RESONANCES:
        if reason := _meaningless(branch, point, found, equations.unit):
            return CANNOT_TELL, reason
        if reason := _spectrum(branch, point, found) or _counts(branch, point, found, equations.unit):
            return DISAGREES, reason
    return judged(branch, point, equations, found) if located else (AGREES, "")


def _claim(branch: Branch, point: SpecialPoint, found: Solution) -> float:
    """The largest error that a point tells, in parts of what it has moved by and is known to."""
    names = branch.info.free
    told_ = [point.error if i == 0 else point.errors.get(name) for i, name in enumerate(names)]
    off = np.abs(found.moved[-len(names) :]) + found.error[-len(names) :]
    return float(np.max(np.array(told_, dtype=float) / off))


def _meaningless(branch: Branch, point: SpecialPoint, found: Solution, unit: bool) -> str:
    """Why multipliers say nothing: where those that are known are wrong, or none is known to a digit."""
    if not unit:
        return ""
    row = branch.points[point.index]
    trivial = max(
        np.nan_to_num(float(point.trivial_error or 0.0)),
        np.nan_to_num(row["trivial_error"]),
        found.at.trivial,
    )
    # A fold is where the parameter turns, whatever the multipliers are known to.
    if trivial > NO_DIGIT and point.label != "LP":
        return f"the trivial multiplier is off by {trivial:.2g}, so that the others say nothing"
    leading = max(abs(complex(row["spectrum"][0])), 1.0)
    # Of a double one, known to the root of it, the sum and the product, which are compared, are known better.
    power = 2.0 if point.label in ("R1", "R2") else 1.0
    if row["spectrum_error"] ** power > NO_DIGIT * leading:
        return f"the leading multiplier is known to {row['spectrum_error']:.2g} only"
    return ""


def _spectrum(branch: Branch, point: SpecialPoint, found: Solution) -> str:
    """Whether each stored eigenvalue is one that is recomputed; a double one is known to half the digits."""
    own = found.at.spectrum
    error = np.nan_to_num(float(branch.points["spectrum_error"][point.index]))
    level = SLACK * (error + found.spread.max()) + EPSILON**0.25 * max(float(np.abs(own).max()), 1.0)
    for value in point.spectrum:
        if np.isfinite(value) and np.abs(own - value).min() > level:
            return f"no eigenvalue or multiplier is {value:.6g} there"
    omega = point.coefficients.get("omega")
    if omega is not None and np.abs(np.abs(own.imag) - abs(omega)).min() > level:
        return f"no pair swings with omega = {omega:.6g}"
    return ""


def _counts(branch: Branch, point: SpecialPoint, found: Solution, unit: bool) -> str:
    """Whether as many directions are unstable on both sides as the other eigenvalues say."""
    before, after, own = point.unstable_before, point.unstable_after, found.at.spectrum
    if before is None or after is None or point.label not in CROSSING:
        return ""
    beyond = np.abs(own) - 1.0 if unit else own.real
    critical = np.argsort(np.abs(beyond))[: CROSSING[point.label]]
    others = np.delete(beyond, critical)
    level = SLACK * np.delete(found.spread, critical) + EPSILON**0.5 * max(float(np.abs(own).max()), 1.0)
    least, most = int(np.sum(others > level)), int(np.sum(others > -level))
    changes = (CROSSING[point.label], 0) if point.label == "LP" else (CROSSING[point.label],)  # one may touch
    if not least <= min(before, after) <= most or abs(after - before) not in changes:
        return f"it says {before} to {after} unstable directions, and {least} are beside those that cross"
    return ""

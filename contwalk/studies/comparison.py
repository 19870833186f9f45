"""Whether a special point computed once more is the stored one."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from contwalk.branch import ORBITS, Branch, SpecialPoint
from contwalk.continuation.folds import NO_SHARE
from contwalk.continuation.kinds import kind_of
from contwalk.errors import ContwalkError
from contwalk.problems.problem import Located, PointType, Problem, Sample, Test
from contwalk.special_point import allowed_error

# A point may differ by so many times what the two error estimates together allow: estimates are estimates.
SLACK = 5.0
AGREES, DIFFERS, LOST, SKIPPED = "agrees", "DISAGREES", "NOT FOUND AGAIN", "not recomputed"
ELSEWHERE = "checked at its parent"  # where a branch has become its parent, whose own point is the same one


@dataclass(frozen=True)
class Comparison:
    """A stored point beside its second computation.

    Parameters
    ----------
    branch, point : str
        Names, as `b2` and `PD1`.
    quantity : str
        What is compared: the free parameter, or what was solved for at a given value of it.
    stored, recomputed, difference : float
    stored_error, own_error : float
        Estimated absolute errors of both.
    allowed : float
        The largest difference with which they agree.
    spectral : float
        Distance of the parameter from where the critical eigenvalue crosses; NaN where none does.
    method : str
        How it was recomputed.
    verdict : str
        `AGREES`, `DIFFERS`, `LOST`, `SKIPPED` or `ELSEWHERE`.
    reason : str
        Why, unless it agrees.
    """

    branch: str
    point: str
    quantity: str
    stored: float
    recomputed: float = float("nan")
    difference: float = float("nan")
    stored_error: float = float("nan")
    own_error: float = float("nan")
    allowed: float = float("nan")
    spectral: float = float("nan")
    method: str = ""
    verdict: str = SKIPPED
    reason: str = ""

    @property
    def failed(self) -> bool:
        """Whether the stored point is called into question."""
        return self.verdict in (DIFFERS, LOST)


def defining(problem: Problem, point: SpecialPoint, sample: Sample) -> PointType:
    """The kind of a point, whose defining system it solves."""
    kind = kind_of(problem, point)
    if kind is None:
        raise ContwalkError(f"Points {point.label} are none of this branch's.")
    still = abs(sample.share) < NO_SHARE
    return kind.flat[0] if kind.flat and still else kind


def critical(kind: PointType, point: SpecialPoint, sample: Sample) -> int:
    """Number of the eigenvalue that is critical at a point, 0 where all are held by the curve."""
    if not len(sample.eigenvalues):
        return 0
    return int(np.argmin(np.abs(sample.eigenvalues - kind.critical(point, sample))))


def judged(
    begun: Comparison,
    branch: Branch,
    problem: Problem,
    sample: Sample,
    point: SpecialPoint,
    found: Located,
    accuracy: float,
) -> Comparison:
    """Whether both values of the parameter agree."""
    name, stored, value, claim, own = max(
        _parameters_of(branch, point, found, accuracy),
        key=lambda each: abs(each[2] - each[1]) / max(each[3] + each[4], 1e-300),
    )
    difference = abs(value - stored)
    within = SLACK * (claim + own)
    asked = allowed_error(accuracy, stored, claim, float(sample.weights[-1]))
    spectral, uncertain = _from_spectrum(problem, sample, point, found)
    result = replace(
        begun,
        quantity=name,
        stored=stored,
        stored_error=claim,
        recomputed=value,
        difference=difference,
        own_error=own,
        allowed=min(within, asked) if asked > 0.0 else within,
        spectral=spectral,
        verdict=DIFFERS,
    )
    if difference > within:
        return replace(result, reason=f"more than {SLACK:g} times the errors of both")
    if asked > 0.0 and difference > asked:
        return replace(result, reason=f"more than the accuracy {accuracy:g} that was asked for")
    if spectral > SLACK * (_claim(branch, point, accuracy) + found.error + uncertain):
        return replace(result, reason=f"its critical eigenvalue is {spectral:.1e} away from the border")
    return replace(result, verdict=AGREES)


def _claim(branch: Branch, point: SpecialPoint, accuracy: float) -> float:
    """The error of the first free parameter as it is stored, or what was asked for."""
    stored = float("nan") if point.error is None else float(point.error)
    return stored if np.isfinite(stored) else accuracy * abs(float(point.unknowns[-1]))


def _parameters_of(
    branch: Branch, point: SpecialPoint, found: Located, accuracy: float
) -> list[tuple[str, float, float, float, float]]:
    """Of each free parameter its name, what is stored and found, and the errors of both."""
    rows = []
    for number, name in enumerate(branch.info.free):
        stored, value = float(point.unknowns[-1 - number]), float(found.z[-1 - number])
        claim = _claim(branch, point, accuracy) if number == 0 else float(point.errors[name])
        rows.append((name, stored, value, claim, float(found.errors.get(name, found.error))))
    return rows


def _from_spectrum(
    problem: Problem, sample: Sample, point: SpecialPoint, found: Located
) -> tuple[float, float]:
    """Distance of the parameter from where the critical measure is zero, and how uncertain that is."""
    kind = defining(problem, point, sample)
    if kind.test is not Test.STABILITY:
        return float("nan"), 0.0
    there = problem if found.problem is None else found.problem
    tangent = np.array(point.tangent)
    at = there.examine(found.z, tangent, sample.weights, there.linearize(found.z), sample.unstable)
    which = critical(kind, point, at)
    rate = abs(at.rates[which])
    if not rate > 0.0:
        return float("nan"), 0.0
    change = abs(float(at.tangent[-1])) / rate
    return abs(float(at.measures[which])) * change, float(at.errors[which]) * change


def at_value(
    begun: Comparison,
    branch: Branch,
    problem: Problem,
    sample: Sample,
    point: SpecialPoint,
    accuracy: float,
) -> Comparison:
    """Whether the solution at a given value of the parameter agrees, by the unknown that differs most."""
    z = np.array(point.unknowns)
    moved = np.abs(sample.z - problem.equivalence.nearest_turn(z, sample.z)) / sample.weights
    at = int(np.argmax(moved[:-1]))
    n, size = len(branch.info.states), len(z) - 1
    orbit = branch.info.problem in ORBITS
    segments = int(branch.info.settings.get("segments", 1)) if orbit else 1
    if at < segments * n:
        name = branch.info.states[at % n]
    else:
        name = "period" if orbit and at == segments * n and size > segments * n else "drift"
    scale = max(float(sample.weights[at]), abs(float(z[at])))
    result = replace(
        begun,
        quantity=name,
        stored=float(z[at]),
        recomputed=float(sample.z[at]),
        difference=float(moved[at] * sample.weights[at]),
        stored_error=float("nan"),
        allowed=accuracy * scale,
        verdict=AGREES,
    )
    if result.difference > result.allowed:
        return replace(
            result, verdict=DIFFERS, reason=f"more than the accuracy {accuracy:g} that was asked for"
        )
    return result

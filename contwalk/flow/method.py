"""Which method for which flow: told by what the methods do on the very path that is wanted.

Stiffness is no property of a field alone: it depends on the path, its length and the tolerance. The explicit
pair is therefore tried first. If stability limits its steps, or if they become many, the implicit method is tried
too, and the one that works less is taken. Work is counted and not timed, so that the same problem always gets the same
method.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from contwalk.flow.field import Field
from contwalk.flow.path import Path
from contwalk.flow.verbs import adaptive

IMPLICIT = "radau9"

# At this tolerance both explicit pairs need about equally many right-hand sides; below, the pair of order 9
# fewer.
ORDER_9_FROM = 1e-11

# Explicit steps after which the implicit method is tried, whatever limits them.
TRIAL_STEPS = 2000

# A share of stability-limited steps that is worth a trial of the implicit method.
NOTABLE = 0.02

_NAMES = {
    "dop853": "explicit 8th-order pair",
    "verner98": "explicit 9th-order pair",
    IMPLICIT: "Radau IIA of order 9",
}


@dataclass(frozen=True, eq=False)
class Choice:
    """A method and why it was chosen.

    Parameters
    ----------
    method : str
    reason : str
        A sentence for the user.
    stability_limited : float
        Share of the explicit pair's steps that stability limited, among those that were tried.
    path : Path
        The path by the method chosen.
    explicit_work, implicit_work : float
        Work of the two in units of a right-hand side; that of the explicit pair up to where its trial ended;
        NaN for the implicit method if it was not tried.
    """

    method: str
    reason: str
    stability_limited: float
    path: Path
    explicit_work: float
    implicit_work: float


def explicit_pair(tolerance: float) -> str:
    """The explicit pair for a tolerance."""
    return "verner98" if tolerance <= ORDER_9_FROM else "dop853"


def choose(
    field: Field,
    c: np.ndarray,
    t0: float,
    x0: Sequence[float] | np.ndarray,
    t1: float,
    tolerance: float,
    weights: Sequence[float] | np.ndarray,
    max_steps: int = 100_000,
) -> Choice:
    """The method that does least work on the path from (t0, x0) to t1; arguments as for `adaptive`."""

    def run(method: str, most: float) -> Path:
        return adaptive(field, c, t0, x0, t1, tolerance, weights, method, int(min(most, max_steps)))

    pair = explicit_pair(tolerance)
    explicit = run(pair, TRIAL_STEPS)
    if explicit.status == "ok" and explicit.stiff_fraction <= NOTABLE:
        return _chosen(pair, _limited(pair, explicit), explicit, explicit)
    implicit = run(IMPLICIT, max_steps)
    if implicit.status != "ok":
        if explicit.status == "too_many_steps":
            explicit = run(pair, max_steps)
        why = f"{_limited(pair, explicit)}; {_NAMES[IMPLICIT]} {_failure(implicit)}"
        return _chosen(pair, why, explicit, explicit)
    work = implicit_work(field, implicit)
    if explicit.status == "too_many_steps" and float(explicit.evaluations) < work:
        # on, as far as it may still turn out to be the cheaper one
        explicit = run(pair, _steps(explicit) * work / explicit.evaluations)
    if explicit.status == "ok" and explicit.evaluations <= work:
        return _chosen(pair, _limited(pair, explicit), explicit, explicit, work)
    return _chosen(IMPLICIT, _against(explicit, work), implicit, explicit, work)


def implicit_work(field: Field, path: Path) -> float:
    """Work of an implicit path in units of a right-hand side, linear algebra included.

    Operations as they were measured, in units of about half a nanosecond: a right-hand side with its share
    of an explicit step 20 + 8 an entry of the Jacobian; a stage of a Newton pass 30 n + 3.6 n^2 besides its
    right-hand side; a step 6 n^3 and a Jacobian, which costs four right-hand sides.
    """
    n, rhs = field.n, 20.0 + 8.0 * len(field.col)
    steps = _steps(path)
    stages = path.evaluations - steps
    return (stages * (rhs + 30.0 * n + 3.6 * n**2) + steps * (4.0 * rhs + 6.0 * n**3)) / rhs


def _steps(path: Path) -> int:
    return len(path.times) - 1


def _limited(method: str, explicit: Path) -> str:
    """How many steps of the explicit pair stability limited."""
    count = round(explicit.stiff_fraction * _steps(explicit))
    ended = "" if explicit.status == "ok" else f"; it {_failure(explicit)}"
    return f"{_NAMES[method]}: {count} of {_steps(explicit)} steps limited by stability{ended}"


def _against(explicit: Path, work: float) -> str:
    """Why the implicit method: stability if that is what was seen, else work."""
    count, steps = round(explicit.stiff_fraction * _steps(explicit)), _steps(explicit)
    if explicit.status in ("not_finite", "step_too_small"):
        return f"{_NAMES[IMPLICIT]}: the explicit pair {_failure(explicit)}"
    if explicit.stiff_fraction > NOTABLE:
        return f"{_NAMES[IMPLICIT]}: {count} of {steps} explicit steps were limited by stability"
    more = "more than " if explicit.status == "too_many_steps" else ""
    return (
        f"{_NAMES[IMPLICIT]}: its work is that of {work:.0f} right-hand sides, "
        f"and the explicit pair needs {more}{explicit.evaluations}"
    )


def _failure(path: Path) -> str:
    """How a path ended, in words."""
    ends = {
        "not_finite": "meets a field that is not finite",
        "too_many_steps": f"does not arrive in {_steps(path)} steps",
        "step_too_small": "needs steps below rounding",
    }
    return f"{ends[path.status]} (t = {path.times[-1]:.6g})"


def _chosen(method: str, reason: str, path: Path, explicit: Path, work: float = float("nan")) -> Choice:
    return Choice(method, reason, explicit.stiff_fraction, path, float(explicit.evaluations), work)

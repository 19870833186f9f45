"""Which method for which flow: told by what the methods do on the very path that is wanted.

Stiffness is no property of a field alone: it depends on the path, its length and the tolerance. The explicit
pair is therefore tried first. If stability limits its steps, or if they become many, the implicit method is
tried too, and the one that works less is taken. Work is counted and not timed, so that the same problem
always gets the same method.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from contwalk.flow.compiled.compiled_field import CompiledField
from contwalk.flow.integrate import controlled, controlled_each
from contwalk.flow.path import FINER, STEADY, ErrorControl, Path

IMPLICIT = "radau9"

# At this tolerance both explicit pairs need about equally many right-hand sides; below, the pair of order 9
# fewer.
ORDER_9_FROM = 1e-11

# Explicit steps after which the implicit method is tried, whatever limits them.
TRIAL_STEPS = 2000

# A share of stability-limited steps that is worth a trial of the implicit method.
NOTABLE = 0.02
# A few steps may be limited by the way a motion begins: compiling another method costs more than they do.
FEW = 10

_NAMES = {
    "dop853": "explicit 8th-order pair",
    "verner98": "explicit 9th-order pair",
    IMPLICIT: "Radau IIA of order 9",
}


# So many times the work of the explicit trial the implicit method is given before the former goes on: where
# a motion repels, stability limits neither, and the implicit one may not arrive at all.
PATIENCE = 8

# Stages of the implicit method: evaluations of a pass of Newton's method, of which a step has at least one.
STAGES = 5
# Passes with tangents on the steps of one path: a correction by Newton's method takes a few.
REPEATED = 4


@dataclass(frozen=True, eq=False)
class Carried:
    """Tangents that are to be computed on the steps of a path: of which field, and how many columns."""

    field: CompiledField
    columns: int


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
        Work of the two in units of a right-hand side; that of a method that was not chosen up to where its
        trial ended; NaN for the implicit method if it was not tried.
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
    field: CompiledField,
    c: np.ndarray,
    t0: float,
    x0: Sequence[float] | np.ndarray,
    t1: float,
    control: ErrorControl,
    carried: Carried | None = None,
    tried: Path | None = None,
) -> Choice:
    """The method that does least work on the path from (t0, x0) to t1; arguments as for `controlled`.

    `tried` is the explicit pair's path, where it is known already. `carried` are the tangents that are to be
    computed on the steps of the path, from neighbouring starts.
    Explicit steps at the limit of stability, taken again, would go beyond it: at a price they are made finer.
    """

    def run(method: str, most: float) -> Path:
        return controlled(field, c, t0, x0, t1, control._replace(max_steps=int(min(most, longest))), method)

    def explicitly(path: Path) -> float:
        return explicit_work(field, path, carried)

    longest, pair = control.max_steps, explicit_pair(control.tolerance)
    explicit = run(pair, TRIAL_STEPS) if tried is None else tried
    spent = explicitly(explicit)
    if explicit.status == "ok" and not _notable(explicit):
        return _chosen(pair, _limited(pair, explicit), explicit, explicit, spent)
    # What takes more work than the explicit pair is not chosen, and need not arrive.
    patience = 1 if explicit.status == "ok" else PATIENCE
    implicit = run(IMPLICIT, _affordable(field, patience * spent, carried))
    if implicit.status == "too_many_steps" and explicit.status == "too_many_steps":
        explicit = run(pair, PATIENCE * _steps(explicit))
        spent = explicitly(explicit)
    if implicit.status == "too_many_steps" and explicit.status != "ok":
        implicit = run(IMPLICIT, longest)
    if implicit.status == "too_many_steps" and explicit.status == "ok":
        more = implicit_work(field, implicit, carried)
        return _chosen(pair, _limited(pair, explicit), explicit, explicit, spent, more)
    if implicit.status != "ok":
        if explicit.status == "too_many_steps":
            explicit = run(pair, longest)
        why = f"{_limited(pair, explicit)}; {_NAMES[IMPLICIT]} {_failure(implicit)}"
        return _chosen(pair, why, explicit, explicit, explicitly(explicit))
    work = implicit_work(field, implicit, carried)
    if explicit.status == "too_many_steps" and spent < work:
        # on, as far as it may still turn out to be the cheaper one
        explicit = run(pair, _steps(explicit) * work / spent)
        spent = explicitly(explicit)
    if explicit.status == "ok" and spent <= work:
        return _chosen(pair, _limited(pair, explicit), explicit, explicit, spent, work)
    return _chosen(IMPLICIT, _against(explicit, spent, work), implicit, explicit, spent, work)


def choose_each(
    field: CompiledField,
    c: np.ndarray,
    bounds: np.ndarray,
    x0: np.ndarray,
    control: ErrorControl,
    carried: Carried | None = None,
) -> Iterator[Choice]:
    """As `choose`, of several paths; arguments as for `controlled_each`.

    Explicit steps of all are tried in one call; what more a path needs is done when it is asked for.
    """
    times = bounds.tolist()
    if len(times) == 1:
        yield choose(field, c, times[0][0], x0[0], times[0][1], control, carried)
        return
    pair = explicit_pair(control.tolerance)
    trial = control._replace(max_steps=min(TRIAL_STEPS, control.max_steps))
    paths = controlled_each(field, c, bounds, x0, trial, pair)
    for (t0, t1), x, tried in zip(times, x0, paths, strict=True):
        yield choose(field, c, t0, x, t1, control, carried, tried)


def _rhs(field: CompiledField) -> float:
    """Nanoseconds of a right-hand side with its share of a step, as they were measured; no timing here."""
    return 10.0 + 1.5 * len(field.col)


def explicit_work(field: CompiledField, path: Path, carried: Carried | None = None) -> float:
    """Work of an explicit path and of tangents on its steps, in units of a right-hand side of `field`.

    Per evaluation and column of tangents: a product with the Jacobian and about six sums of vectors.
    """
    work = path.evaluations * _rhs(field)
    if carried is not None:
        other, q = carried.field, carried.columns
        each = 2.0 * _rhs(other) + 0.08 * q * (len(other.col) + 6.0 * other.n)
        finer = FINER if path.stiff_fraction > STEADY else 1.0
        work += REPEATED * finer * path.evaluations * each
    return work / _rhs(field)


def implicit_work(field: CompiledField, path: Path, carried: Carried | None = None) -> float:
    """Work of an implicit path and of tangents on its steps, in units of a right-hand side of `field`.

    Tangents of a step need the Jacobians of five stages, 125 n^3 / 3 products for the factors, and 25 n^2 a
    column for the solution; some of them are zero.
    """
    work = _newton(field, path)
    if carried is not None:
        n, q, rhs = carried.field.n, carried.columns, _rhs(carried.field)
        each = 20.0 * rhs + 6.3 * n * n * (n + q)
        work += REPEATED * (_newton(carried.field, path) + _steps(path) * each)
    return work / _rhs(field)


def _affordable(field: CompiledField, work: float, carried: Carried | None) -> int:
    """Implicit steps that take more work than this, in units of a right-hand side, however few passes each
    needs.
    """
    step = Path(
        np.zeros(2),
        np.zeros((2, field.n)),
        evaluations=STAGES + 1,
        rejected=0,
        stiff_fraction=0.0,
        status="ok",
    )
    return int(work / implicit_work(field, step, carried)) + 1


def _newton(field: CompiledField, path: Path) -> float:
    """Nanoseconds of a path by Newton's method: stages of its passes, and steps with their factors."""
    n, rhs, steps = field.n, _rhs(field), _steps(path)
    stages = path.evaluations - steps
    return stages * (rhs + 12.0 * n + 1.2 * n**2) + steps * (4.0 * rhs + 0.3 * n**3)


def _notable(explicit: Path) -> bool:
    """Whether stability limited enough steps that a trial of the implicit method is worth its price."""
    limited = explicit.stiff_fraction * _steps(explicit)
    return explicit.stiff_fraction > NOTABLE and limited > FEW


def _steps(path: Path) -> int:
    return len(path.times) - 1


def _limited(method: str, explicit: Path) -> str:
    """How many steps of the explicit pair stability limited."""
    count = round(explicit.stiff_fraction * _steps(explicit))
    ended = "" if explicit.status == "ok" else f"; it {_failure(explicit)}"
    return f"{_NAMES[method]}: {count} of {_steps(explicit)} steps limited by stability{ended}"


def _against(explicit: Path, spent: float, work: float) -> str:
    """Why the implicit method: stability if that is what was seen, else work."""
    count, steps = round(explicit.stiff_fraction * _steps(explicit)), _steps(explicit)
    if explicit.status in ("not_finite", "step_too_small"):
        return f"{_NAMES[IMPLICIT]}: the explicit pair {_failure(explicit)}"
    if explicit.stiff_fraction > NOTABLE:
        return f"{_NAMES[IMPLICIT]}: {count} of {steps} explicit steps were limited by stability"
    more = "more than " if explicit.status == "too_many_steps" else ""
    return (
        f"{_NAMES[IMPLICIT]}: its work is that of {work:.0f} right-hand sides, "
        f"and that of the explicit pair {more}{spent:.0f}"
    )


def _failure(path: Path) -> str:
    """How a path ended, in words."""
    ends = {
        "not_finite": "meets a field that is not finite",
        "too_many_steps": f"does not arrive in {_steps(path)} steps",
        "step_too_small": "needs steps below rounding",
    }
    return f"{ends[path.status]} (t = {path.times[-1]:.6g})"


def _chosen(
    method: str, reason: str, path: Path, explicit: Path, spent: float, work: float = float("nan")
) -> Choice:
    return Choice(method, reason, explicit.stiff_fraction, path, spent, work)

"""What is true of any branch, checked against the plugin's own field and nothing else.

Of equilibria here, of periodic orbits in `orbit_invariants`.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
from orbit_invariants import check_orbit_branch as check_orbit_branch
from special_point_invariants import check_special_points

from contwalk.branch import Branch
from contwalk.problems.equilibrium.equilibrium import Equilibrium

EPSILON = sys.float_info.epsilon
# The corrector ends at some roundings of the terms. Of these, constants in the field are not seen here.
RESIDUAL = 1e3 * EPSILON
# Differences of fourth order with a step of 1e-4: truncation 1e-16, rounding eps / 1e-4 = 2e-12 of the
# terms, and the state itself is that of a corrector that ended at 1e4 roundings.
DIFFERENCE = 1e-9
# Away from a bifurcation an eigenvalue's sign is certain when it exceeds some roundings of the matrix.
CERTAIN = 1e3 * EPSILON


def check_branch(branch: Branch, problem: Equilibrium, scale: Sequence[float] | None = None) -> None:
    """Assert the invariants of a branch of `problem`'s equilibria.

    `scale` holds typical magnitudes of the states where the branch's own metric does not know them: those
    that are zero along the branch while the field bends on another scale than one.
    """
    assert branch.complete
    assert branch.info.states == problem.system.state_names
    assert branch.outcome.status in ("complete", "stopped", "failed")
    assert branch.outcome.message.endswith((".", ".)"))
    _check_order(branch)
    for row in branch.points:
        _check_row(branch, problem, row, scale)
    _check_continuity(branch)
    _check_counts_between(branch)
    check_special_points(branch)


def _check_order(branch: Branch) -> None:
    s = branch["s"]
    assert np.all(np.isfinite(s))
    assert np.all(np.diff(s) >= 0.0), "points are not ordered by arclength"
    assert np.any(s == 0.0), "the start is missing"
    regular = s[~branch["special"]]
    assert np.all(np.diff(regular) > 0.0), "two regular points at the same place"


def parameters_at(branch: Branch, problem: Equilibrium, row: np.void) -> SimpleNamespace:
    """All parameters at a row."""
    value = float(row["free"][0])
    if problem.line.ends is None:
        return SimpleNamespace(**{**branch.info.parameters, branch.info.free[0]: value})
    begin, end = problem.line.ends
    return SimpleNamespace(**{name: begin[name] + value * (end[name] - begin[name]) for name in begin})


def _field(problem: Equilibrium, x: np.ndarray, p: SimpleNamespace) -> np.ndarray:
    dx = np.full(len(x), np.nan)
    problem.system.modes[0].field(0.0, x, p, dx)
    return dx


def differenced_jacobian(
    problem: Equilibrium, x: np.ndarray, p: SimpleNamespace, scale: np.ndarray
) -> tuple[np.ndarray, float]:
    """df/dx by central differences of fourth order, and its rounding error in the metric of `scale`."""
    columns, lost = [], 0.0
    for j, size in enumerate(np.maximum(np.abs(x), scale)):
        h = np.zeros(len(x))
        h[j] = 2.0 ** round(math.log2(1e-4 * size))
        values = [_field(problem, x + k * h, p) for k in (-2, -1, 1, 2)]
        columns.append((8.0 * (values[2] - values[1]) - (values[3] - values[0])) / (12.0 * h[j]))
        # Rounding of the field's values, and of the places that they are taken at.
        slopes = np.abs(np.diff(values, axis=0)) / h[j]
        rounding = EPSILON * (np.abs(values).max(axis=0) + slopes.max(axis=0) * abs(x[j])) / h[j]
        lost = max(lost, float(np.max(rounding * scale[j] / scale)))
    return np.column_stack(columns), lost


def _check_row(branch: Branch, problem: Equilibrium, row: np.void, given: Sequence[float] | None) -> None:
    x, n = np.array(row["state"]), len(branch.info.states)
    p = parameters_at(branch, problem, row)
    scale = np.array(row["weights"])[:n] if given is None else np.array(given, dtype=float)
    assert np.all(scale > 0.0)
    assert np.array_equal(row["unknowns"][:n], x)
    norm = np.linalg.norm(row["tangent"] / row["weights"])
    assert abs(norm - 1.0) < 1e-9, "the tangent is not a unit vector"
    matrix, lost = differenced_jacobian(problem, x, p, scale)
    terms = _terms(branch, problem, row, x, p, matrix)
    field = np.abs(_field(problem, x, p))
    assert np.all(field <= RESIDUAL * terms + 1e-290), f"residual {field} of terms {terms}"
    assert 0.0 <= row["residual"] <= 1e4
    # What cancels in the field itself limits what differences of it can tell.
    lost += 1e4 * EPSILON * float(np.max(terms / scale))
    matrix = matrix / scale[:, None] * scale
    _check_spectrum(row, matrix, float(np.linalg.norm(matrix)) + 10.0 * lost / DIFFERENCE)


def _terms(
    branch: Branch, problem: Equilibrium, row: np.void, x: np.ndarray, p: SimpleNamespace, matrix: np.ndarray
) -> np.ndarray:
    """What moving the state or the parameter by their own size would make of the field."""
    weights = np.array(row["weights"])
    terms = np.abs(matrix) @ np.maximum(np.abs(x), weights[: len(x)])
    value = float(row["free"][0])
    slope = np.zeros(len(x))
    for part in (EPSILON, 1e-6):  # far from and near to an edge of the field
        change = part * (abs(value) or weights[-1])
        moved = row.copy()
        moved["free"] = value - math.copysign(change, value)
        there = _field(problem, x, parameters_at(branch, problem, moved))
        slope = np.maximum(slope, np.abs(there - _field(problem, x, p)) / change)
    return terms + slope * max(abs(value), weights[-1])


def _check_spectrum(row: np.void, matrix: np.ndarray, size: float) -> None:
    """Each stored eigenvalue is one of a matrix that is nearly `matrix`; their sum is its trace.

    Distances between eigenvalues themselves would be no measure near a double one.
    """
    n = len(matrix)
    values = np.array(row["spectrum"])
    kept = values[np.isfinite(values)]
    for value in kept:
        distance = np.linalg.svd(matrix - value * np.eye(n), compute_uv=False)[-1]
        assert distance <= DIFFERENCE * max(size, 1e-290), f"{value} is no eigenvalue: {distance} of {size}"
    assert abs(kept.sum() - np.trace(matrix)) <= n * DIFFERENCE * max(size, 1e-290)
    assert np.all(np.diff(kept.real) <= 0.0), "the spectrum is not in descending order"
    assert abs(kept.imag.sum()) <= n * EPSILON * size, "complex eigenvalues are not in pairs"
    doubt = max(float(row["spectrum_error"]), CERTAIN * size)
    assert np.sum(kept.real > doubt) <= row["unstable"] <= np.sum(kept.real >= -doubt)


def _check_continuity(branch: Branch) -> None:
    """Neighbours are as far apart as their arclengths say, in the metric of the one nearer to the start."""
    rows = branch.points
    for a, b in pairwise(rows):
        inner = a if b["s"] > 0.0 else b
        change = np.append(b["unknowns"] - a["unknowns"], b["free"] - a["free"]) / inner["weights"]
        length = b["s"] - a["s"]
        distance = float(np.linalg.norm(change))
        # Positions of special points are feet on a chord of an arc of at most 20 degrees, from which they are
        # less than a tenth of its length away; no step is longer than 0.1 but by its own stretch to a bound.
        assert distance <= 1.1 * length + 0.01, f"a jump of {distance} at s = {a['s']}"


def _check_counts_between(branch: Branch) -> None:
    """The unstable count changes at bifurcations only, and at the branch point that the branch was born
    at.
    """
    rows = branch.points
    for a, b in pairwise(rows):
        birth = branch.info.parent is not None and 0.0 in (a["s"], b["s"])
        if not birth and not a["special"] and not b["special"]:
            assert a["unstable"] == b["unstable"], f"a crossing was missed between s = {a['s']} and {b['s']}"

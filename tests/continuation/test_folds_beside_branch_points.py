"""A fold and a branch point of one branch, however near to each other."""

from __future__ import annotations

import numpy as np
import pytest
from small_systems import labelled, small_problem

import contwalk as cw


def fold_and_pitchfork(apart, sign, mixed):
    """lam = a^2 with a fold at a = 0, crossed at a = apart by sign (a - apart) = b^2."""

    def field(t, x, p, dx):
        a, b = (x[0] + 0.5 * x[1], x[1] - 0.25 * x[0]) if mixed else (x[0], x[1])
        f, g = p.lam - a**2, sign * (a - apart) * b - b**3
        dx[0], dx[1] = ((f - 0.5 * g) / 1.125, (g + 0.25 * f) / 1.125) if mixed else (f, g)

    return field


@pytest.mark.drawn(4)
@pytest.mark.parametrize("mixed", [False, True], ids=["plain", "turned"])
@pytest.mark.parametrize("sign", [1.0, -1.0], ids=["one each way", "both"])
@pytest.mark.parametrize("apart", [1e-6, 1e-7, 1e-8])
def test_both_are_located(apart, sign, mixed):
    """At the branch point the parameter's share of the tangent is noise: both its sides had the same sign."""
    problem = small_problem(fold_and_pitchfork(apart, sign, mixed), "xy", {"lam": 0.1}, "lam")
    a = -np.sqrt(0.1)
    start = [a / 1.125, 0.25 * a / 1.125] if mixed else [a, 0.0]
    branch = cw.continue_branch(problem, start, (-1.0, 0.2))
    (fold,), (point,) = labelled(branch, "LP"), labelled(branch, "BP")
    assert (fold.status, point.status) == ("located", "located")
    # Where both eigenvalues are this small, lam is known to rounding times the distance.
    assert fold.parameters["lam"] == pytest.approx(0.0, abs=1e-16)
    assert point.parameters["lam"] == pytest.approx(apart**2, abs=1e-16)
    # One eigenvalue passes at each; the walk may come from either side.
    (before, between), (between_too, after) = [
        (q.unstable_before, q.unstable_after) for q in branch.special_points if q.label in ("LP", "BP")
    ]
    assert between == between_too
    assert {before, after} == ({1} if sign > 0.0 else {0, 2})
    assert abs(between - before) == abs(between - after) == 1


@pytest.mark.parametrize("mixed", [False, True], ids=["plain", "turned"])
def test_where_they_are_one_point_it_says_so(mixed):
    problem = small_problem(fold_and_pitchfork(0.0, 1.0, mixed), "xy", {"lam": 0.1}, "lam")
    a = -np.sqrt(0.1)
    start = [a / 1.125, 0.25 * a / 1.125] if mixed else [a, 0.0]
    branch = cw.continue_branch(problem, start, (-1.0, 0.2))
    (point,) = labelled(branch, "LP", "BP", "HB")
    assert point.label == "BP"
    assert "the parameter turns here as well" in point.note

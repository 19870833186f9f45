"""Zeros of the saddle quantity of saddles whose eigenvalues are known: a kind that a system declares."""

from __future__ import annotations

import pytest
from saddle_quantity import SaddleQuantity
from small_systems import labelled, small_problem

import contwalk as cw
from contwalk.verification.finding import AGREES
from contwalk.verification.points import checked_point


def sheared(t, x, p, dx):
    """The equilibrium (a^2, a^3, a^2) with the eigenvalues 2 - a, -(1 + a) and -3: their sum is 1 - 2 a."""
    u, v, w = x[0] - p.a**2, x[1] - p.a * x[0], x[2] - x[0]
    dx[0] = (2.0 - p.a) * u + u * v
    dx[1] = p.a * dx[0] + 0.3 * u**2 - (1.0 + p.a) * v
    dx[2] = dx[0] + u + v - 3.0 * w


def handed_over(t, x, p, dx):
    """The origin with the eigenvalues a, 2 and -(1 + a): where a passes zero the leading ones are others."""
    dx[0] = p.a * x[0]
    dx[1] = 2.0 * x[1]
    dx[2] = -(1.0 + p.a) * x[2]


def focus(t, x, p, dx):
    """A saddle-focus: a and -1 +- i, whose real parts add to zero at a = 1."""
    dx[0] = -x[0] - x[1]
    dx[1] = x[0] - x[1]
    dx[2] = p.a * x[2]


def walked(field, start, bounds, state=(0.0, 0.0, 0.0), own=True):
    kinds = (SaddleQuantity(),) if own else ()
    problem = small_problem(field, "xyz", {"a": start}, "a", point_types=kinds)
    return problem, cw.continue_branch(problem, list(state), bounds)


def test_it_is_found_where_both_eigenvalues_add_to_zero():
    problem, branch = walked(sheared, 0.1, (0.1, 1.5), (0.01, 0.001, 0.01))
    (point,) = labelled(branch, "SQ")
    assert (point.name, point.status) == ("SQ1", "located")
    assert abs(point.parameters["a"] - 0.5) <= point.error < 1e-15
    assert point.coefficients["eigenvalue"] == pytest.approx(1.5, abs=1e-15)
    assert checked_point(problem.system, branch, point).verdict == AGREES


def test_another_leading_eigenvalue_is_no_zero():
    """0 + 2 before a = 0, -1 + 0 after it: the sum jumps, its sign changes, and nothing is told."""
    _, branch = walked(handed_over, -0.6, (-0.6, 0.7))
    assert labelled(branch, "SQ") == []
    (crossing,) = labelled(branch, "BP")
    assert crossing.parameters["a"] == pytest.approx(0.0, abs=1e-15)


def test_leading_eigenvalues_with_partners_have_no_such_point():
    _, branch = walked(focus, 0.5, (0.5, 1.5))
    assert labelled(branch, "SQ") == []


def test_who_does_not_declare_it_has_none():
    _, branch = walked(sheared, 0.1, (0.1, 1.5), (0.01, 0.001, 0.01), own=False)
    assert labelled(branch, "SQ") == []

"""Problems are restored by the kind that is stored of their branch."""

from __future__ import annotations

from importlib import import_module

import pytest
from small_systems import small_problem, small_system

import contwalk as cw
from contwalk.branch import ORBITS
from contwalk.errors import DatabaseError
from contwalk.problems.restoring import RESTORED_BY, problem_of


def test_every_kind_that_is_stored_can_be_restored():
    assert set(RESTORED_BY) == {"equilibrium", "locus", *ORBITS}
    assert all(callable(import_module(name).restored) for name in RESTORED_BY.values())


def decay(t, x, p, dx):
    dx[0] = p.a - x[0]


def branch():
    return cw.continue_branch(small_problem(decay, "x", {"a": 0.5}, "a"), [0.5], (0.0, 1.0))


def test_equations_come_back_as_they_were():
    system = small_system(decay, "x", {"a": 0.5})
    found = branch()
    problem = problem_of(system, found.info, found.points["state"][0])
    assert (problem.kind, problem.free, problem.parameters) == ("equilibrium", "a", {"a": 0.5})
    assert problem.linearize(found.unknowns(0)).residual == pytest.approx([0.0], abs=1e-15)


def test_another_system_is_refused():
    other = small_system(decay, "y", {"a": 0.5})
    found = branch()
    with pytest.raises(DatabaseError, match="is of another system or model"):
        problem_of(other, found.info, found.points["state"][0])

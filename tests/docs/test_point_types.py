"""The how-to page on kinds of special points: the kind that it writes is found, told, drawn and verified."""

from __future__ import annotations

from types import ModuleType

import pytest
from code_blocks import blocks
from small_systems import labelled, small_problem

import contwalk as cw
from contwalk.labels import MEANINGS
from contwalk.plotting import special_points
from contwalk.problems.equilibrium.equilibrium import Equilibrium
from contwalk.problems.orbit.discretization import Discretization
from contwalk.studies.comparison import AGREES
from contwalk.studies.verification import compared

PAGE = "docs/howto/point_types.md"


def saddle(t, x, p, dx):
    """As the page says: tr A = a^2 - 1 at the origin."""
    dx[0] = (p.a**2 - 2.0) * x[0] + x[0] * x[1]
    dx[1] = x[1]


@pytest.fixture
def kind(monkeypatch):
    """The kind of the page, its label and its marker, added as the page says."""
    (text,) = blocks(PAGE, "python")
    module = ModuleType("neutral_equilibrium")
    exec(compile(text, PAGE, "exec"), module.__dict__)
    found = module.NeutralEquilibrium()
    monkeypatch.setattr(Equilibrium, "point_types", (*Equilibrium.point_types, found))
    monkeypatch.setitem(MEANINGS, "NE", "neutral equilibrium")
    monkeypatch.setitem(special_points.MARKERS, "NE", "d")
    return found


def walked():
    problem = small_problem(saddle, "xy", {"a": 0.5}, "a")
    return problem, cw.continue_branch(problem, [0.0, 0.0], (0.5, 1.3))


def test_the_point_of_the_page_is_found_and_drawn(kind):
    problem, branch = walked()
    (point,) = labelled(branch, "NE")
    assert (point.name, point.status) == ("NE1", "located")
    assert point.parameters["a"] == pytest.approx(1.0, abs=max(point.error, 1e-15))
    assert point.error < 1e-14
    assert point.coefficients == {"largest": 1.0}
    assert (point.unstable_before, point.unstable_after) == (1, 1)
    entries = special_points.legend_entries([point])
    assert [entry.get_label() for entry in entries] == ["NE  neutral equilibrium"]
    assert compared(problem.system, branch, point, Discretization()).verdict == AGREES


def test_one_that_cannot_be_located_is_told(kind, monkeypatch):
    monkeypatch.setattr(type(kind), "locate", lambda *given: None)
    _, branch = walked()
    (point,) = labelled(branch, "NE")
    assert point.status == "unlocated"
    assert "passes zero, but none is found" in point.note
    assert branch.outcome.reason == "bound"


def test_a_problem_without_it_has_no_such_point():
    assert labelled(walked()[1], "NE") == []

"""The how-to page on kinds of special points: the kind that it writes is found, told, drawn and verified."""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from code_blocks import blocks
from small_systems import labelled, small_problem, small_system

import contwalk as cw
from contwalk.cli.entry import run as command
from contwalk.labels import MEANINGS
from contwalk.plotting import special_points
from contwalk.problems.equilibrium import equilibrium
from contwalk.problems.locus import orbit_curves, orbit_starts
from contwalk.problems.locus.orbit_points import catalogue
from contwalk.verification.finding import AGREES, CANNOT_TELL
from contwalk.verification.points import checked_point
from contwalk.workflow.equations import equations_hash

PAGE = "docs/howto/point_types.md"
AT = {"a": 0.3, "k": 0.2}
RUN = """contwalk: 1
system: ./saddle.py
start: {state: {x: 0.0, y: 0.0}}
continue: {parameter: a, range: [0.5, 1.3]}
output: saddle.h5
"""


def saddle(t, x, p, dx):
    """As the page says: tr A = a^2 - 1 at the origin."""
    dx[0] = (p.a**2 - 2.0) * x[0] + x[0] * x[1]
    dx[1] = x[1]


def spiral(t, x, p, dx):
    """As the page says: multipliers exp(-4 pi k) and exp(2 pi a) of the unit circle."""
    growth = p.k * (1.0 - x[0] ** 2 - x[1] ** 2)
    dx[0] = growth * x[0] - x[1]
    dx[1] = growth * x[1] + x[0]
    dx[2] = p.a * x[2] + 0.1 * x[0]


def made(block, name):
    """A kind that a block of the page declares."""
    module = ModuleType(name)
    exec(compile(blocks(PAGE, "python")[block], PAGE, "exec"), module.__dict__)
    return getattr(module, name)()


@pytest.fixture
def kind(monkeypatch):
    """The kind of the page, its label and its marker, added for everybody as the page says."""
    found = made(0, "NeutralEquilibrium")
    monkeypatch.setattr(equilibrium, "POINT_TYPES", (*equilibrium.POINT_TYPES, found))
    monkeypatch.setitem(MEANINGS, "NE", "neutral equilibrium")
    monkeypatch.setitem(special_points.MARKERS, "NE", (6, 0, 30))
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
    assert point.coefficients == pytest.approx({"largest": 1.0})
    assert (point.unstable_before, point.unstable_after) == (1, 1)
    entries = special_points.legend_entries([point])
    assert [entry.get_label() for entry in entries] == ["NE  neutral equilibrium"]
    assert checked_point(problem.system, branch, point).verdict == CANNOT_TELL  # its kind is the plugin's


def test_one_that_cannot_be_located_is_told(kind, monkeypatch):
    monkeypatch.setattr(type(kind), "locate", lambda *given: None)
    _, branch = walked()
    (point,) = labelled(branch, "NE")
    assert point.status == "unlocated"
    assert "passes zero, but none is found" in point.note
    assert branch.outcome.reason == "bound"


@pytest.fixture
def neutral():
    """A system that declares the page's kind of orbits, which has neither label nor marker."""
    return small_system(spiral, "xyz", AT, point_types=made(2, "NeutralCycle"))


@pytest.fixture
def cycles(neutral):
    """Its orbits."""
    system = neutral
    orbit = cw.PeriodicOrbit(system, AT, "a")
    return cw.continue_branch(orbit, [1.0, 0.0, 0.0], (0.2, 0.6), period=2.0 * np.pi)


def test_the_kind_of_orbits_of_the_page_is_found(cycles, neutral):
    (point,) = labelled(cycles, "NC")
    assert (point.name, point.status) == ("NC1", "located")
    assert abs(point.parameters["a"] - 0.4) <= point.error
    assert point.error < 1e-8 * 0.4  # the accuracy that is asked for
    assert point.coefficients["largest"] == pytest.approx(np.exp(0.8 * np.pi), rel=1e-7)
    assert labelled(cycles, "EP")[-1].parameters["a"] == 0.6
    assert checked_point(neutral, cycles, point).verdict == AGREES  # by the kind's own test function


def test_the_curve_of_the_page_is_followed(cycles, neutral, monkeypatch):
    monkeypatch.setitem(orbit_curves.CURVES, "NC", made(3, "NeutralCycles"))
    monkeypatch.setitem(catalogue.POINT_TYPES, "NC", catalogue.POINT_TYPES["AZ"])
    monkeypatch.setattr(orbit_starts, "FOLLOWED", (*orbit_starts.FOLLOWED, "NC"))
    curve = cw.continue_locus(neutral, cycles, "NC1", {"a": (0.3, 0.6), "k": (0.1, 0.4)}, max_points=20)
    assert len(curve) > 10
    # The steps of a walk are a hundred times coarser than those of special points.
    assert np.max(np.abs(curve["a"] - 2.0 * curve["k"])) < 1e-7


def test_a_label_without_a_meaning_is_drawn_and_told_all_the_same(cycles):
    """As a database has it that somebody's changed contwalk has written."""
    (point,) = labelled(cycles, "NC")
    assert [entry.get_label() for entry in special_points.legend_entries([point])] == ["NC"]
    assert "NC1" in repr(point)


@pytest.fixture
def plugin(tmp_path, monkeypatch):
    """The page's files, and a run file."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)  # as PYTHONPATH=. does
    monkeypatch.delitem(sys.modules, "neutral_equilibrium", raising=False)
    for block, name in enumerate(("neutral_equilibrium.py", "saddle.py")):
        Path(name).write_text(blocks(PAGE, "python")[block])
    Path("saddle.yaml").write_text(RUN)
    return Path("saddle.yaml")


def test_the_plugin_of_the_page_has_its_own_kind(plugin):
    assert command(["continue", str(plugin)]) == 0
    with cw.open_database("saddle.h5") as database:
        (point,) = labelled(database.branch("b1"), "NE")
    assert (point.status, point.parameters["a"]) == ("located", 1.0)
    assert command(["verify", "saddle.h5", "--trust"]) == 0


def test_another_text_of_its_kind_is_another_system(plugin):
    before = equations_hash(cw.read_run_file(plugin))
    assert equations_hash(cw.read_run_file(plugin)) == before
    kind = Path("neutral_equilibrium.py")
    kind.write_text(kind.read_text().replace("sum(sample.eigenvalues.real)", "sum(sample.eigenvalues).real"))
    sys.modules.pop("neutral_equilibrium", None)
    assert equations_hash(cw.read_run_file(plugin)) != before


def test_a_problem_without_it_has_no_such_point():
    assert labelled(walked()[1], "NE") == []

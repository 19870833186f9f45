"""What a new user stumbles over: names nearly right, files of the wrong kind, doors that lead nowhere."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest

import contwalk as cw

ONE_STATE = """
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0] = {field}

SYSTEM = System(
    "one", states=(State("x"),), parameters=(Parameter("a", 1.0),), modes=(Mode("only", field),)
)
"""
SPIRAL = """
import math

from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    r = math.hypot(x[0], x[1])
    dx[0] = p.m * x[0] - x[1] - r * x[0]
    dx[1] = x[0] + p.m * x[1] - r * x[1]

SYSTEM = System(
    "spiral",
    states=(State("x"), State("y")),
    parameters=(Parameter("m", -0.5),),
    modes=(Mode("only", field),),
)
"""
CYCLE = """
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    r = x[0] ** 2 + x[1] ** 2
    dx[0] = p.a * x[0] - x[1] - r * x[0] * p.b
    dx[1] = x[0] + p.a * x[1] - r * x[1] * p.b

SYSTEM = System(
    "cycle",
    states=(State("x"), State("y")),
    parameters=(Parameter("a", -0.5), Parameter("b", 1.0)),
    modes=(Mode("only", field),),
)
"""
OF_CYCLE = "{system: ./cycle.py, start: {state: {x: 0, y: 0}}, continue: {parameter: a, range: [-1, 1]}"


SMALL = """
from contwalk.system import Mode, Parameter, State, System

UNIT = 1e-9

def field(t, x, p, dx):
    r = (x[0] ** 2 + x[1] ** 2) / UNIT ** 2
    dx[0] = p.a * x[0] - x[1] - r * x[0]
    dx[1] = x[0] + p.a * x[1] - r * x[1]
    dx[2] = UNIT * (p.a + 0.25) - (x[2] - UNIT) ** 2 / UNIT

SYSTEM = System(
    "small",
    states=(State("x"), State("y"), State("z")),
    parameters=(Parameter("a", 0.75),),
    modes=(Mode("only", field),),
)
"""


@pytest.fixture
def of_cycle(folder):
    """Run files of a cycle that is born, with more keys."""

    def written(name: str, more: str = "") -> str:
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        (path.parent / "cycle.py").write_text(CYCLE, encoding="utf-8")
        path.write_text(f"{OF_CYCLE}{more}}}", encoding="utf-8")
        return name

    return written


@pytest.mark.parametrize("name", ["bp1", "BP1", "b1/bp1"])
def test_a_point_without_its_branch_is_suggested_with_it(contwalk, fork_with_branches, name):
    done = contwalk("show", fork_with_branches, name)
    assert done.code == 2
    assert f"Did you mean '{'BP1' if '/' in name else 'b1/BP1'}'" in done.err


@pytest.mark.parametrize("name", ["x.png", "x.PDF", "x.csv", "x.yaml", "x.py", "x.html"])
@pytest.mark.parametrize("command", ["continue", "simulate", "sample", "margins"])
def test_an_output_named_as_another_kind_of_file_is_refused(contwalk, folder, of_cycle, command, name):
    more = ", margins: {of: {from: o.h5, point: b1/1}, survive: {periods: 2}}, simulate: {until: 1}"
    more += ", sample: {count: 2, draw: {x: [0, 1]}, measure: settling}" if command == "sample" else ""
    before = {each.name for each in folder.iterdir()} | {"run.yaml", "cycle.py"}
    done = contwalk(command, of_cycle("run.yaml", more), "--output", name)
    assert done.code == 2
    assert {each.name for each in folder.iterdir()} == before
    if command != "sample":
        assert "Name it x.h5" in done.err


def test_a_range_of_curves_without_the_value_of_the_study_is_refused(contwalk, folder, of_cycle):
    done = contwalk("continue", of_cycle("run.yaml", ", loci: {with: b, range: [2, 3]}"))
    assert done.code == 2
    assert "loci.range: the start has b = 1, outside the range [2, 3]" in done.err
    assert not (folder / "run.h5").exists()


def test_a_study_elsewhere_finds_what_it_has_written_here(contwalk, folder, of_cycle):
    """Outputs go to the current directory, and `margins.of` of the same file is looked for there as well."""
    more = ", output: of_it.h5, margins: {of: {from: of_it.h5, point: b2/5}, survive: {periods: 1},"
    file = of_cycle("deeper/run.yaml", f"{more} states: [x], instants: 1, accuracy: 0.1}}")
    assert contwalk("continue", file, "--quiet", "--no-figures").code == 0
    done = contwalk("margins", file, "--no-figures")
    assert done.code == 0, done.err
    assert (folder / "of_it_margins.csv").exists()


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_of_a_shell(folder, shell):
    command = [sys.executable, "-m", "contwalk"]

    def asked(**variables: str) -> str:
        given = {**os.environ, **variables}
        done = subprocess.run(command, env=given, capture_output=True, text=True, timeout=60, check=False)
        assert (done.returncode, done.stderr) == (0, "")
        return done.stdout

    assert "_CONTWALK_COMPLETE" in asked(_CONTWALK_COMPLETE=f"{shell}_source")
    words = {"COMP_WORDS": "contwalk sh", "COMP_CWORD": "sh" if shell == "fish" else "1"}
    assert "show" in asked(_CONTWALK_COMPLETE=f"{shell}_complete", **words)


def test_a_derivative_without_a_value_is_told_as_one(contwalk, folder):
    (folder / "spiral.py").write_text(SPIRAL, encoding="utf-8")
    run = "{system: ./spiral.py, start: {state: {x: 0, y: 0}}, continue: {parameter: m, range: [-1, 1]}}"
    (folder / "run.yaml").write_text(run, encoding="utf-8")
    done = contwalk("continue", "run.yaml", "--output", "spiral.h5")
    assert done.code == 1
    assert "spiral.py, line 6: it has a value, and a derivative has none" in done.err


@pytest.mark.parametrize("power", [4, 6])
@pytest.mark.parametrize("scale", [1.0, 1e-3])
def test_a_flat_fold_is_a_fold(contwalk, folder, power, scale):
    """One real eigenvalue passes zero, and the parameter turns: no pair, and no end at infinity."""
    text = ONE_STATE.format(field=f"p.a - (x[0] / {scale}) ** {power}")
    (folder / "one.py").write_text(text, encoding="utf-8")
    run = (
        f"{{system: ./one.py, start: {{state: {{x: {scale}}}}}, continue: {{parameter: a, range: [-1, 2]}}}}"
    )
    (folder / "run.yaml").write_text(run, encoding="utf-8")
    assert contwalk("continue", "run.yaml", "--output", "one.h5", "--quiet").code == 0
    (branch,) = cw.open_database("one.h5")
    points = [(point.label, point.unstable_before, point.unstable_after) for point in branch.special_points]
    assert points in ([("EP", 1, 1), ("LP", 1, 0), ("EP", 0, 0)], [("EP", 0, 0), ("LP", 0, 1), ("EP", 1, 1)])
    assert branch.special_points[1].parameters["a"] == pytest.approx(0.0, abs=1e-12)
    assert np.ptp(np.sign(branch["x"])) == 2.0


def test_states_of_a_size_that_nobody_has_told(contwalk, folder):
    """In units of 1e-9 of what is declared: a Hopf point at 0 on both sides of a fold at -1/4."""
    (folder / "small.py").write_text(SMALL, encoding="utf-8")
    run = "{system: ./small.py, start: {state: {x: 0, y: 0, z: 2.0e-9}}, diagram: none, "
    run += "continue: {parameter: a, range: [-1, 1]}}"
    (folder / "run.yaml").write_text(run, encoding="utf-8")
    assert contwalk("continue", "run.yaml", "--output", "small.h5").code == 0
    (branch,) = cw.open_database(folder / "small.h5")
    found = [(point.label, point.parameters["a"]) for point in branch.special_points if point.label != "EP"]
    assert [label for label, _ in found] == ["HB", "LP", "HB"]
    np.testing.assert_allclose([a for _, a in found], [0.0, -0.25, 0.0], atol=1e-12)

"""Parameters that a run file holds by expressions of others, against the same models written out."""

from __future__ import annotations

import math

import pytest

import contwalk as cw
from contwalk.cli.entry import run

BRUSSELATOR = """
import math
from contwalk.system import Mode, Observable, Parameter, Signal, State, System

def field(t, x, p, dx):
    dx[0] = p.A - (p.B + 1) * x[0] + x[0] ** 2 * x[1] + 0.0 * math.sin(p.C)
    dx[1] = p.B * x[0] - x[0] ** 2 * x[1]

SYSTEM = System(
    "brusselator",
    states=(State("x"), State("y")),
    parameters=(Parameter("A", 1.0), Parameter("B", 1.5, bounds=(0.1, 50.0)), Parameter("C", 0.0)),
    modes=(Mode("only", field),),
    signals=(Signal("feed", lambda t, x, p: p.B + 0.0 * x[:, 0], extremes=True),),
    observables=(Observable("both", lambda t, x, p: p.B * p.C),),
)
"""
STUDY = """
system: ./brusselator.py
parameters: {B: "A^2/4 + C/2", C: 2 * A}
start: {state: {x: 1, y: 1.5}}
continue: {parameter: A, range: [0.5, 3]}
diagram: {follow: none}
output: study.h5
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "brusselator.py").write_text(BRUSSELATOR)
    return tmp_path


def refused(capsys, *arguments):
    assert run(arguments) == 2
    return " ".join(capsys.readouterr().err.split())


def test_they_are_held_along_a_branch(folder, capsys):
    """With B = A^2/4 + 2 the Hopf point at B = 1 + A^2 is at A = 2/sqrt(3)."""
    (folder / "study.yaml").write_text(STUDY.replace("2 * A", '"4"'))
    assert run(["continue", "study.yaml", "--quiet", "--no-figures"]) == 0
    database = cw.open_database("study.h5")
    (hopf,) = (point for point in database["b1"].special_points if point.label == "HB")
    exact = 2 / math.sqrt(3)
    assert hopf.parameters["A"] == pytest.approx(exact, rel=1e-12)
    assert hopf.parameters["B"] == pytest.approx(1 + exact**2, rel=1e-12)
    assert hopf.parameters["C"] == 4.0
    feed = database["b1"]["feed_max"]
    assert feed == pytest.approx(database["b1"]["A"] ** 2 / 4 + 2, rel=1e-14)
    assert database["b1"]["both"] == pytest.approx(4 * feed, rel=1e-14)


def test_one_may_depend_on_another(folder):
    (folder / "study.yaml").write_text(STUDY)
    assert run(["continue", "study.yaml", "--quiet", "--no-figures"]) == 0
    ends = [p.parameters for p in cw.open_database("study.h5")["b1"].special_points if p.label == "EP"]
    for end in ends:
        assert (end["C"], end["B"]) == (2 * end["A"], end["A"] ** 2 / 4 + end["A"])


def test_a_study_goes_on_and_is_verified_with_them(folder, capsys):
    (folder / "study.yaml").write_text(STUDY.replace("2 * A", '"4"'))
    short = ("--set", "continue.max_points=5")
    assert run(["continue", "study.yaml", "--quiet", "--no-figures", *short]) == 0
    assert (
        run(
            [
                "continue",
                "study.yaml",
                "--quiet",
                "--no-figures",
                "--resume",
                "--set",
                "continue.max_points=90",
            ]
        )
        == 0
    )
    assert run(["verify", "study.h5", "--trust"]) == 0
    assert "DISAGREE" not in capsys.readouterr().out.replace("0 DISAGREES", "")
    (folder / "study.yaml").write_text(STUDY.replace("2 * A", '"5"'))
    said = refused(capsys, "continue", "study.yaml", "--quiet", "--no-figures", "--resume")
    assert "another" in said or "differ" in said


BALL = """
system:
  equations: |
    q' = v
    v' = force*cos(omega*t) - 2*zeta*v - q
    zeta = 0.1; omega = 1.3; force = 0.3; gap = 1; restitution = 0.8
    period = 2*pi/omega
    event impact: gap - q falls, v = -restitution*v
parameters: {gap: "2*zeta + 0.8"}
start: {simulate: {state: {q: 0.0, v: 0.0}, until: settled}}
continue: {parameter: force, range: [0.1, 2.0]}
output: ball.h5
"""


def test_machines_with_impacts_hold_them(folder):
    """The orbit grazes at gap sqrt((1 - w^2)^2 + (2 zeta w)^2), also along zeta, which moves the gap."""
    (folder / "ball.yaml").write_text(BALL)
    assert run(["continue", "ball.yaml", "--quiet", "--no-figures"]) == 0
    (grazing,) = (p for p in cw.open_database("ball.h5")["b1"].special_points if p.label == "GR")
    assert grazing.parameters["force"] == pytest.approx(math.hypot(1 - 1.3**2, 0.26), rel=1e-8)
    other = ("--set", "continue={parameter: zeta, range: [0.05, 0.5]}", "--set", "parameters.force=0.73")
    assert run(["continue", "ball.yaml", "--quiet", "--no-figures", "--output", "zeta.h5", *other]) == 0
    (grazing,) = (p for p in cw.open_database("zeta.h5")["b1"].special_points if p.label == "GR")
    zeta = grazing.parameters["zeta"]
    assert grazing.parameters["gap"] == pytest.approx(2 * zeta + 0.8, rel=1e-14)
    assert (2 * zeta + 0.8) * math.hypot(1 - 1.3**2, 2.6 * zeta) == pytest.approx(0.73, rel=1e-7)


def test_diagrams_from_python_hold_them():
    system = cw.system_from_text("x' = a - b*x; a = 1; b = 1")
    found = cw.diagram(system, "a", (1, 2), parameters={"b": "2*a"})
    assert found["b1"]["x"] == pytest.approx([0.5] * len(found["b1"]["x"]), rel=1e-12)


WRONG = {
    "B: 2 * D": "'D' is no parameter of 'brusselator'",
    "B: 2 * a": "Did you mean 'A'?",
    "B: 2 *": "stands where a number, a name or ( must",
    "B: sine(A)": "there is no function 'sine'",
    "B: 'sin(A, C)'": "sin takes 1 argument",
    "B: 2024-01-01": "'01' is no number. A date is no value",
    "B: 2 * B": "it is held by itself",
    "B: C, C: B + 1": "it is held by itself",
    "B: __import__('os')": "stands where a number, a name or ( must",
    "B: A.real": "stands for nothing",
    "B: log(A - 1)": "cannot be computed",
    "B: 60 * A": "lies outside the bounds of 'B'",
    "D: 2 * A": "has no parameter 'D'",
    "A: 2 * B": "'A' is held by the expression '2 * B'",
    "B: t": "'t' is no parameter",
}


@pytest.mark.parametrize("held", WRONG)
def test_what_holds_nothing_is_refused(folder, capsys, held):
    (folder / "study.yaml").write_text(STUDY.replace('B: "A^2/4 + C/2", C: 2 * A', held))
    said = refused(capsys, "continue", "study.yaml")
    assert WRONG[held] in said
    assert "study.yaml, line 3, key parameters" in said or "key continue.parameter" in said
    assert not (folder / "study.h5").exists()


@pytest.mark.parametrize(
    "more", ["sweep: {B: [1, 2]}", "path: {from: {B: 1}, to: {B: 2}}", "loci: {with: B, range: [1, 2]}"]
)
def test_what_is_held_is_set_nowhere_else(folder, capsys, more):
    text = STUDY.replace("continue: {parameter: A, range: [0.5, 3]}", "") if "path" in more else STUDY
    (folder / "study.yaml").write_text(f"{text}{more}\n")
    assert "'B' is held by the expression" in refused(capsys, "continue", "study.yaml")


def test_where_it_grows_without_bound_the_branch_ends(folder):
    (folder / "study.yaml").write_text(STUDY.replace('"A^2/4 + C/2"', '"2 + log(2 - A)"'))
    assert run(["continue", "study.yaml", "--quiet", "--no-figures"]) == 0
    branch = cw.open_database("study.h5")["b1"]
    assert "unbounded" in repr(branch.special_points)
    assert branch["A"].max() == pytest.approx(2.0, abs=1e-8)

"""`contwalk tradeoff`: the table, the files, and what is refused before anything runs."""

from __future__ import annotations

import csv
import math

import pytest

from contwalk.workflow.tradeoff import measuring

# x' = r x, and a wall at 1 that sends it back to 1/4: from x = 1/2 with r = 1 it is there after log 2, and
# again each log 4.
GROWING = """\
from contwalk.system import Mode, Parameter, State, System, Transition

def grow(t, x, p, dx):
    dx[0] = p.r * x[0]

def back(t, x, p, x_plus):
    x_plus[0] = 0.25

SYSTEM = System(
    name="growing",
    states=(State("x", scale=1.0),),
    parameters=(Parameter("r", 1.0),),
    modes=(Mode("inside", grow),),
    transitions=(
        Transition("wall", "inside", "inside", lambda t, x, p: x[0] - 1.0, direction="rising", reset=back),
    ),
)
"""

# The fork, and the same one with a little more load.
FORKS = """\
from contwalk.system import Choice, Family, Mode, Parameter, Start, State, System

def build(load):
    more = {"none": 0.0, "little": 0.004, "much": 0.4}[load]

    def field(t, x, p, dx):
        dx[0] = (p.r - 1.0 + more) * x[0] - x[0] ** 3

    return System(
        name="forks",
        states=(State("x"),),
        parameters=(Parameter("r", 0.5),),
        modes=(Mode("free", field),),
        starts=(Start("upright", lambda p: [[0.0]]),),
    )

SYSTEM = Family(name="forks", choices=(Choice("load", "none", ("none", "little", "much")),), build=build)
"""


@pytest.fixture(autouse=True)
def timed_less_often(monkeypatch):
    monkeypatch.setattr(measuring, "REPEATS", measuring.LEAST)


@pytest.fixture
def following(folder):
    """The run file of the fork with its branch point followed."""
    text = (folder / "run.yaml").read_text(encoding="utf-8")
    (folder / "run.yaml").write_text(
        text.replace("diagram: none", "diagram: {follow: [BP]}"), encoding="utf-8"
    )
    return "run.yaml"


def test_table_recommendation_and_files(contwalk, following, folder):
    done = contwalk("tradeoff", following, "--accuracies", "1e-4,1e-8", "--methods", "auto")
    assert done.code == 0
    lines = done.out.splitlines()
    assert lines[0].split()[:3] == ["accuracy", "method", "CPU"]
    assert [line.split()[:2] for line in lines[1:3]] == [["0.0001", "auto"], ["1e-08", "auto"]]
    assert "Truth: 1 point at accuracy 1e-10, recomputed by Newton" in done.out
    assert "met the accuracy of 1e-08" in done.out
    assert "Giving up 4 digits, from 1e-08 to 0.0001, " in done.out
    assert (folder / "fork_tradeoff.csv").exists()
    assert (folder / "fork_tradeoff.png").exists()
    assert not (folder / "fork.h5").exists()  # databases are temporary
    again = contwalk("tradeoff", following, "--accuracies", "1e-4", "--methods", "auto")
    assert again.code == 2
    assert "fork_tradeoff.csv exists" in again.err


def test_quiet_and_without_figures(contwalk, following, folder):
    done = contwalk(
        "tradeoff", following, "--accuracies", "1e-4", "--methods", "auto", "--quiet", "--no-figures"
    )
    assert (done.code, done.out, done.err) == (0, "", "")
    assert not (folder / "fork_tradeoff.png").exists()


def test_of_a_motion_the_end_and_the_last_events_are_compared(contwalk, folder):
    (folder / "growing.py").write_text(GROWING, encoding="utf-8")
    (folder / "g.yaml").write_text(
        "system: ./growing.py\nstart: {state: {x: 0.5}}\nsimulate: {until: 4.0}\naccuracy: 1.0e-6\n",
        encoding="utf-8",
    )
    more = ["--of", "simulate", "--accuracies", "1e-4,1e-9", "--methods", "dop853,radau5"]
    done = contwalk("tradeoff", "g.yaml", *more)
    assert (done.code, done.err) == (0, "")
    with (folder / "g_tradeoff.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [(row["tolerance"], row["method"]) for row in rows] == [
        ("0.0001", "dop853"),
        ("1e-09", "dop853"),
        ("0.0001", "radau5"),
        ("1e-09", "radau5"),
    ]
    # Three times at the wall within 4 seconds.
    assert int((4.0 - math.log(2.0)) / math.log(4.0)) + 1 == 3
    assert "error time of wall 3" in rows[0]
    for row in rows[1::2]:
        assert float(row["worst_error"]) < 1e-7
        assert row["promise_held"] == "True"
    assert "met the accuracy of 1e-06" in done.out
    assert "simulate: {tolerance: " in done.out
    assert (folder / "g_tradeoff.png").exists()


def test_a_motion_without_a_given_end_is_refused(contwalk, folder):
    done = contwalk("tradeoff", "run.yaml", "--of", "simulate")
    assert done.code == 2
    assert "--set simulate.until=20" in done.err


def test_models_are_compared_with_the_run_file_s_own(contwalk, folder):
    (folder / "forks.py").write_text(FORKS, encoding="utf-8")
    text = "system: ./forks.py\nstart: {equilibrium: upright}\ncontinue: {parameter: r, range: [0, 2]}\n"
    (folder / "f.yaml").write_text(text + "diagram: none\n", encoding="utf-8")
    done = contwalk("tradeoff", "f.yaml", "--model", "load=little", "--model", "load=much")
    assert (done.code, done.err) == (0, "")
    with (folder / "f_tradeoff.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["model"] for row in rows] == ["", "load=little", "load=much"]
    # The branch point is at r = 1 less the load.
    assert [float(row["error b1/BP1"]) for row in rows] == pytest.approx([0.0, 0.004, 0.4], abs=1e-9)
    assert [row["promise_held"] for row in rows] == ["True", "True", "False"]
    assert (folder / "f_tradeoff.png").exists()
    assert contwalk("tradeoff", "f.yaml", "--model", "load=huge", "--force").code == 2
    both = contwalk("tradeoff", "f.yaml", "--model", "load=much", "--methods", "auto", "--force")
    assert both.code == 2
    assert "Leave out --of" in both.err


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--accuracies", "tight"), "is not a list of numbers"),
        (("--accuracies", "0"), "is not possible"),
        (("--accuracies", "nan"), "is not possible"),
        (("--methods", "dopri853"), "Did you mean 'dop853'?"),
        (("--set", "start={equilibrium: nowhere}"), "nowhere"),
    ],
)
def test_bad_input(contwalk, following, folder, arguments, said):
    done = contwalk("tradeoff", following, *arguments)
    assert done.code == 2
    assert said in done.err
    assert not (folder / "fork_tradeoff.csv").exists()


def test_a_folder_that_takes_no_file_is_refused_before_anything_is_computed(contwalk, following):
    done = contwalk("tradeoff", "run.yaml", "--output", "/proc/x.h5")
    assert done.code == 2
    assert "/proc/x_tradeoff.csv cannot be created" in done.err

"""`contwalk verify`: what agrees, what does not, and what it says."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import count

import numpy as np
import pytest

from contwalk.storage.hdf5 import Hdf5Database
from contwalk.verification import budget, checking

CYCLES = """\
from contwalk.system import Mode, Parameter, Start, State, System

def field(t, x, p, dx):
    growth = p.mu - x[0] ** 2 - x[1] ** 2
    dx[0] = growth * x[0] - x[1]
    dx[1] = x[0] + growth * x[1]

SYSTEM = System(
    name="cycles",
    states=(State("x"), State("y")),
    parameters=(Parameter("mu", -0.5),),
    modes=(Mode("free", field),),
    starts=(Start("rest", lambda p: [[0.0, 0.0]]),),
)
"""
RUN = """\
contwalk: 1
system: ./cycles.py
start: {equilibrium: rest}
continue: {parameter: mu, range: [-1.0, 1.0]}
diagram: {follow: [HB]}
mark: {mu: 0.5, max_abs: 0.5}
output: cycles.h5
"""


@pytest.fixture
def database(contwalk):
    assert contwalk("continue", "run.yaml", "--quiet").code == 0
    return "fork.h5"


@pytest.fixture
def cycles(folder, contwalk):
    """A database with a Hopf point, its cycle, and marked values on both."""
    (folder / "cycles.py").write_text(CYCLES, encoding="utf-8")
    (folder / "cycles.yaml").write_text(RUN, encoding="utf-8")
    assert contwalk("continue", "cycles.yaml", "--quiet").code == 0
    return "cycles.h5"


def tampered(path, change, to="wrong.h5"):
    """A copy of a database in which every special point but the ends went through `change`."""
    with Hdf5Database.open(path) as old, Hdf5Database.create(to, old.header) as new:
        for name in old.branch_names():
            branch = old.branch(name)
            new.start_branch(branch.info)
            for row in old.rows(name):
                new.append(name, row)
            for point in old.specials(name):
                new.append_special(name, point if point.label == "EP" else change(point))
            new.finish(name, branch.outcome, branch.cost)
    return to


def test_a_branch_point_agrees(contwalk, database):
    done = contwalk("verify", "--trust", database)
    assert done.code == 0
    assert done.err == ""
    assert "DISAGREES" not in done.out
    assert "CANNOT TELL" not in done.out
    assert "Differences over stored errors: below 0.1: " in done.out
    row = next(line for line in done.out.splitlines() if line.startswith("b1/BP1"))
    assert row.endswith("AGREES")


def test_orbits_are_recomputed_by_another_integrator(contwalk, cycles):
    done = contwalk("verify", "--trust", cycles, "--json")
    shown = json.loads(done.out)
    assert done.code == 0
    assert shown["agree"] is True
    by_name = {f"{p['branch']}/{p['point']}": p for p in shown["points"]}
    assert by_name["b1/HB1"]["recomputed"] == 0.0
    orbits = [p for name, p in by_name.items() if name.startswith("b2/")]
    assert orbits
    assert {p["method"] for p in orbits} == {"SciPy DOP853"}
    assert {each["verdict"] for each in (*orbits, *shown["ends"], *shown["rows"])} == {"AGREES"}


def test_one_record(contwalk, cycles):
    for what in ("b2/UZ1", "b2/5"):
        shown = json.loads(contwalk("verify", "--trust", cycles, what, "--json").out)
        assert {f"{each['branch']}/{each['point']}" for each in (*shown["points"], *shown["rows"])} == {what}
    assert contwalk("verify", "--trust", cycles, "b1").out.count("\nb1/") >= 1


def test_a_wrong_value_is_found(contwalk, database):
    def change(point):
        value = point.unknowns[-1] + 1e-6
        return replace(point, unknowns=(*point.unknowns[:-1], value), parameters={"r": value})

    wrong = tampered(database, change)
    done = contwalk("verify", "--trust", wrong)
    assert done.code == 1
    assert "DISAGREES" in done.out
    assert "agree, 1 DISAGREES." in done.out
    assert json.loads(contwalk("verify", "--trust", wrong, "--json").out)["agree"] is False


def test_what_is_not_checked_is_told(contwalk, database):
    wrong = tampered(database, lambda point: replace(point, status="unlocated"))
    done = contwalk("verify", "--trust", wrong)
    assert (done.code, contwalk("verify", "--trust", wrong, "--strict").code) == (0, 1)
    assert "agree, 1 CANNOT TELL." in done.out
    assert "b1/BP1: it was not located in the first place" in done.out
    told = json.loads(contwalk("verify", "--trust", wrong, "--json").out)
    assert (told["agree"], told["cannot_tell"]) == (True, 1)


def test_a_computation_that_breaks_down_is_the_outcome_of_its_point(contwalk, database, monkeypatch):
    def broken(*_):
        raise np.linalg.LinAlgError("Singular matrix")

    monkeypatch.setattr(checking, "checked_point", broken)
    done = contwalk("verify", "--trust", database, "--strict")
    assert done.code == 1
    assert "b1/BP1: the second computation broke down: Singular matrix" in done.out
    assert "internal error" not in done.err


def test_a_budget_leaves_out_what_does_not_fit(contwalk, cycles):
    done = contwalk("verify", "--trust", cycles, "--budget", "1e-9")
    assert done.code == 0
    assert "the budget of CPU is used up" in done.out
    assert "did not fit into --budget." in done.out


def test_a_budget_ends_within_a_record(contwalk, cycles, monkeypatch):
    monkeypatch.setattr(budget.time, "process_time", count(0.0, 0.01).__next__)  # each look at the clock
    done = contwalk("verify", "--trust", cycles, "b2/UZ1", "--budget", "0.5")
    assert "b2/UZ1: the budget of CPU is used up" in done.out


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("missing.h5",), "missing.h5"),
        (("fork.h5", "b7"), "no branch 'b7'"),
        (("fork.h5", "b1/HB9"), "no special point 'HB9'"),
        (("fork.h5", "b1/999"), "no special point '999'"),
        (("fork.h5", "--budget", "-1"), "'--budget'"),
    ],
)
def test_bad_input(contwalk, database, arguments, said):
    done = contwalk("verify", "--trust", *arguments)
    assert done.code == 2
    assert said in done.err
    assert "Traceback" not in done.err


def test_a_plugin_that_is_gone(contwalk, database, folder):
    (folder / "fork.py").unlink()
    done = contwalk("verify", "--trust", database)
    assert done.code == 2
    assert "cannot be loaded" in done.err


def test_pages_of_orbits(contwalk, cycles):
    text = contwalk("show", cycles, "b2").out
    assert "period from 6.28319 to 6.28319; trivial" in text  # the plugin declares no unit
    assert "trivial multiplier right to" in text
    page = contwalk("show", cycles, "b2/3").out
    assert "period: 6.28318" in page
    assert "closure: full" in page
    assert "estimated error of the leading eigenvalue" in page
    assert "right-hand sides" in page
    assert "multipliers: real" in page


def test_a_phase_portrait_of_stored_orbits(contwalk, cycles, folder):
    done = contwalk(
        "plot", "--trust", "--force", cycles, "--kind", "phase_portrait", "-x", "x", "-y", "y", "-o", "p.svg"
    )
    assert (done.code, done.out) == (0, "Wrote p.svg.\n")
    assert "mu = 0.5,  T = 6.283 -->" in (folder / "p.svg").read_text(encoding="utf-8")
    point = ("--point", "b2/2", "--point", "b2/UZ1")
    assert (
        contwalk("plot", "--trust", "--force", cycles, "--kind", "phase_portrait", *point, "-o", "p.svg").code
        == 0
    )
    refused = contwalk(
        "plot", "--trust", "--force", cycles, "--kind", "phase_portrait", "-x", "mu", "-o", "p.svg"
    )
    assert refused.code == 2
    assert "'mu' is not a state" in refused.err
    assert contwalk("plot", "--trust", "--force", cycles, "-z", "x", "-o", "p.svg").code == 2
    assert (
        contwalk("plot", "--trust", "--force", cycles, "--kind", "machine", *point, "-o", "p.svg").code == 2
    )


def test_what_a_plugin_prints_is_no_part_of_the_document(contwalk, folder):
    text = (folder / "fork.py").read_text()
    (folder / "fork.py").write_text("print('hello')\n" + text.replace("dx[1] =", "print(x)\n    dx[1] ="))
    assert contwalk("continue", "run.yaml").code == 0
    done = contwalk("verify", "fork.h5", "--trust", "--json")
    assert json.loads(done.out)["agree"]
    assert "hello" in done.err

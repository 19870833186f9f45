"""Fields that change with the free parameter alone, at whatever states: found between two solutions."""

from __future__ import annotations

import numpy as np
import pytest

import contwalk as cw
from contwalk.storage import open_database

pytestmark = pytest.mark.slow

HEAD = """\
import math
import numpy as np
from contwalk.system import Mode, Parameter, State, System, Transition

def factor(p):
    return {factor}

"""
STILL = """\
def field(t, x, p, dx):
    dx[0] = p.a * factor(p) - x[0] - x[0]**3

SYSTEM = System("small", states=(State("x"),), parameters=(Parameter("a", 0.1), Parameter("b", 0.1)),
    modes=(Mode("m", field),))
"""
CYCLE = """\
def field(t, x, p, dx):
    r2 = x[0]**2 + x[1]**2
    dx[0] = factor(p) * (p.a * x[0] - x[1] - x[0] * r2)
    dx[1] = x[0] + p.a * x[1] - x[1] * r2 + 0.1 * x[0]**2

SYSTEM = System("small", states=(State("x"), State("y")),
    parameters=(Parameter("a", 0.2), Parameter("b", 0.1)),
    modes=(Mode("m", field),))
"""
BOUNCING = """\
def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -factor(p) * x[0] - 0.1 * x[1] + p.a * math.cos(2.0 * t)

def guard(t, x, p):
    return x[0] + 0.05

def reset(t, x, p, x_plus):
    x_plus[0] = x[0]
    x_plus[1] = -0.6 * x[1]

SYSTEM = System("small", states=(State("x"), State("y")),
    parameters=(Parameter("a", 0.3), Parameter("b", 0.1)),
    modes=(Mode("m", field),), transitions=(Transition("hit", "m", "m", guard, "falling", reset),),
    period=lambda p: math.pi)
"""
SETTLED = "start: {simulate: {state: {x: 0.3, y: 0.0}, until: settled}}\n"
RUNS = {
    STILL: "start: {state: {x: 0.1}}\ncontinue: {parameter: a, range: [0.1, 0.9]}\n",
    CYCLE: SETTLED + "continue: {parameter: a, range: [0.1, 0.9]}\n",
    BOUNCING: SETTLED + "continue: {parameter: a, range: [0.25, 0.9]}\n",
}
LINE = "small.py, line 6"
MACHINES = pytest.mark.parametrize("machine", RUNS, ids=["equilibria", "orbits", "hybrid"])


def study(folder, plugin, run):
    """The first branch of a run, and the notes about kinks that are stored with it."""
    (folder / "small.py").write_text(plugin)
    (folder / "run.yaml").write_text(f"contwalk: 1\nsystem: ./small.py\n{run}")
    result = cw.run(cw.read_run_file(folder / "run.yaml", output=folder / "run.h5"), figures=False)
    with open_database(folder / "run.h5") as db:
        return result.branches[0], [text for key, text in db.notes().items() if key.startswith("kink")]


def studied(folder, machine, factor, run=""):
    return study(folder, HEAD.format(factor=factor) + machine, run or RUNS[machine])


@pytest.mark.drawn(2)
@MACHINES
@pytest.mark.parametrize(
    ("factor", "what"),
    [
        ("1.0 if p.a < 0.5 else 1.3", "a comparison"),
        ("1.0 if p.a < 0.5 else 1.0 + 1e-4", "a comparison"),  # so little that Newton's method hops across
        ("1.0 + 0.2 * math.floor(2.0 * p.a)", "floor"),
        ("1.0 + 0.3 * np.sign(p.a - 0.5)", "sign"),
    ],
)
def test_a_branch_ends_where_the_field_jumps_with_its_parameter(tmp_path, machine, factor, what):
    branch, notes = studied(tmp_path, machine, factor)
    assert branch.outcome.reason == "plugin_error"
    assert f"the field jumps: {tmp_path / 'small.py'}, line 6 ({what})" in branch.outcome.message
    assert "At a = 0.5, whatever the states are" in branch.outcome.message
    # One step on either side of the jump is all that is left out: the least step is 1e-12, the search 1e-8.
    assert 0.0 < 0.5 - branch["a"].max() < 1e-7
    assert notes == []


@pytest.mark.drawn(2)
@MACHINES
@pytest.mark.parametrize(
    ("factor", "what"), [("1.0 + abs(p.a - 0.5)", "abs"), ("max(1.0, 0.5 + p.a)", "max")]
)
def test_a_corner_of_a_branch_is_told(tmp_path, machine, factor, what):
    branch, (told,) = studied(tmp_path, machine, factor)
    assert branch.outcome.reason == "bound"
    assert f"line 6 ({what})" in told
    assert "At a = 0.5, whatever the states are, slopes of the field jump" in told


@pytest.mark.drawn(2)
@MACHINES
@pytest.mark.parametrize(
    "factor",
    [
        "1.0 if p.b < 0.5 else 2.0",  # of another parameter
        "1.0 + abs(p.a)",  # of one sign
        "p.a if p.a > 0.5 else (p.a - 0.5) + 0.5",  # the same on both sides
        "1.0 + abs(p.a - 0.5)**3",  # no derivative that is used jumps
    ],
)
def test_nothing_is_told_where_nothing_jumps(tmp_path, machine, factor):
    branch, notes = studied(tmp_path, machine, factor)
    assert branch.outcome.status != "failed"
    assert notes == []


def test_a_window_that_both_ends_of_a_step_lie_beside_is_found(tmp_path):
    # Steps are some hundredths long here, and the field is another one between 0.5 and 0.503 only.
    branch, _ = studied(tmp_path, STILL, "1.3 if 0.5 < p.a < 0.503 else 1.0")
    assert branch.outcome.reason == "plugin_error"
    assert LINE in branch.outcome.message


def test_a_choice_that_only_some_states_make_is_found(tmp_path):
    own = "r2 = x[0]**2 + x[1]**2 + (factor(p) * x[0]**4 if x[0] > 0.0 else 0.0)"
    cycle = CYCLE.replace("r2 = x[0]**2 + x[1]**2", own).replace("dx[0] = factor(p) *", "dx[0] =")
    branch, _ = studied(tmp_path, cycle, "1.0 if p.a < 0.5 else 1.3", RUNS[CYCLE])
    assert branch.outcome.reason == "plugin_error"
    assert "whatever the states are" in branch.outcome.message
    assert LINE in branch.outcome.message


def test_a_path_ends_where_its_own_parameter_makes_the_field_jump(tmp_path):
    run = "start: {state: {x: 0.1}}\npath: {from: {a: 0.1, b: 0.0}, to: {a: 0.9, b: 1.0}}\n"
    branch, _ = studied(tmp_path, STILL, "1.0 if p.b < 0.5 else 1.3", run)
    assert branch.outcome.reason == "plugin_error"
    assert "At path = 0.5, whatever the states are" in branch.outcome.message
    assert LINE in branch.outcome.message


@pytest.mark.drawn(1)
@pytest.mark.parametrize("machine", [CYCLE, BOUNCING], ids=["orbits", "hybrid"])
def test_a_period_that_jumps_ends_a_branch_of_forced_orbits(tmp_path, machine):
    forced = machine.replace("factor(p) * ", "").replace("period=lambda p: math.pi", "period=period")
    forced = forced.replace("modes=(Mode", "period=period, modes=(Mode") if machine is CYCLE else forced
    if machine is CYCLE:
        forced = forced.replace("0.1 * x[0]**2", "0.1 * x[0]**2 + 0.1 * math.cos(2.0 * t)")
        forced = forced.replace("p.a * x[0]", "-p.a * x[0]").replace("p.a * x[1]", "-p.a * x[1]")
    plugin = (HEAD + "def period(p):\n    return math.pi * factor(p)\n\n").format(
        factor="1.0 if p.a < 0.5 else 1.01"
    )
    branch, _ = study(tmp_path, plugin + forced, RUNS[machine])
    assert branch.outcome.reason == "plugin_error"
    assert "At a = 0.5, whatever the states are, the period jumps" in branch.outcome.message
    assert LINE in branch.outcome.message


def test_a_corner_too_steep_to_pass_is_named(tmp_path):
    branch, _ = studied(tmp_path, STILL, "1.0 + 1e5 * abs(p.a - 0.5)")
    if branch.outcome.status == "failed":
        assert LINE in branch.outcome.message
    else:
        assert branch.outcome.reason == "bound"
        assert np.ptp(branch["a"]) == pytest.approx(0.8)


FOLD = """\
def field(t, x, p, dx):
    dx[0] = p.a + factor(p) * p.b * x[0] - x[0]**3

SYSTEM = System("small", states=(State("x"),), parameters=(Parameter("a", -1.0), Parameter("b", 1.0)),
    modes=(Mode("m", field),))
"""


@pytest.mark.drawn(1)
@pytest.mark.parametrize(
    ("factor", "reason"),
    [
        ("1.0 if p.b < 1.5 else 1.2", "plugin_error"),
        ("1.0 if p.a < 0.75 else 1.2", "plugin_error"),
        ("1.0 + 0.1 * abs(p.b - 1.5)", ""),
    ],
)
def test_curves_in_two_parameters_tell_it_too(tmp_path, factor, reason):
    run = (
        "start: {state: {x: -1.3}}\ncontinue: {parameter: a, range: [-1.0, 1.0]}\n"
        "loci: {with: b, range: [0.8, 2.0]}\n"
    )
    (tmp_path / "small.py").write_text(HEAD.format(factor=factor) + FOLD)
    (tmp_path / "run.yaml").write_text(f"contwalk: 1\nsystem: ./small.py\n{run}")
    result = cw.run(cw.read_run_file(tmp_path / "run.yaml", output=tmp_path / "run.h5"), figures=False)
    curves = [branch for branch in result.branches if branch.info.problem == "locus"]
    assert curves
    with open_database(tmp_path / "run.h5") as db:
        notes = [text for key, text in db.notes().items() if key.startswith("kink")]
    if reason:
        ended = [curve for curve in curves if curve.outcome.reason == reason]
        assert ended
        assert all(LINE in curve.outcome.message for curve in ended)
    else:
        assert any(LINE in text and "b = 1.5" in text for text in notes)

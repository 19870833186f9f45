"""Conditions at soft transitions, and guards that jump in machines that have some."""

from __future__ import annotations

import numpy as np
import pytest

import contwalk as cw

# A driven block with a spring behind a gap and, where declared, a stop on the other side.
PLUGIN = """\
import math
import numpy as np
from contwalk.system import Condition, Mode, Parameter, State, System, Transition

def free(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.force * math.cos(t) - 0.2 * x[1] - x[0]

def pressed(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.force * math.cos(t) - 0.2 * x[1] - x[0] - 4.0 * (x[0] - 0.5)

def gap(t, x, p):
    return 0.5 - x[0]

def stop(t, x, p):
    return 1.2 + x[0]

def rebound(t, x, p, after):
    after[0], after[1] = x[0], -0.6 * x[1]

SYSTEM = System(
    "block",
    states=(State("x"), State("v")),
    parameters=(Parameter("force", 1.0),),
    modes=(Mode("free", free), Mode("pressed", pressed)),
    transitions=(
        Transition("touch", "free", "pressed", gap, role="soft"),
        Transition("lift", "pressed", "free", gap, "rising", role="soft"),
        MORE
    ),
    conditions=(CONDITIONS),
    period=lambda p: 2.0 * math.pi,
)
"""
RUN = """\
contwalk: 1
system: ./block.py
start: {simulate: {state: {x: 0.1, v: 0.3}, until: settled}}
continue: {parameter: force, range: [1.0, 1.4], direction: forward}
diagram: none
events: {AZ: ignore}
output: out.h5
"""
STOP = "Transition('stop', 'free', 'free', stop, reset=rebound),"


def study(folder, conditions, more=""):
    """The branch, and what is told of kinks."""
    (folder / "block.py").write_text(PLUGIN.replace("CONDITIONS", conditions).replace("MORE", more))
    (folder / "run.yaml").write_text(RUN)
    result = cw.run(cw.read_run_file(folder / "run.yaml", output=folder / "out.h5"), figures=False)
    with cw.open_database(folder / "out.h5") as db:
        return result.branches[0], [text for key, text in db.notes().items() if key.startswith("kink")]


def condition(function):
    return f"Condition('gentle', lambda t, x, p: {function}, at='touch'),"


@pytest.mark.drawn(1)
@pytest.mark.parametrize("more", ["", STOP], ids=["soft only", "with a stop"])
def test_a_condition_at_a_soft_transition_is_watched(tmp_path, more):
    branch, told = study(tmp_path, condition("1.2 - p.force"), more)
    (point,) = [point for point in branch.special_points if point.label == "AZ"]
    assert point.parameters["force"] == pytest.approx(1.2, abs=1e-9)
    np.testing.assert_array_equal(branch["admissible"], branch["force"] <= 1.2)
    assert told == []


@pytest.mark.long
@pytest.mark.parametrize("more", ["", STOP], ids=["soft only", "with a stop"])
def test_a_condition_at_a_soft_transition_that_jumps_is_told(tmp_path, more):
    branch, (told,) = study(tmp_path, condition("1.0 if p.force < 1.2 else -1.0"), more)
    np.testing.assert_array_equal(branch["admissible"], branch["force"] < 1.2)
    assert not [point for point in branch.special_points if point.label == "AZ"]
    assert "condition 'gentle' jumps through zero" in told
    assert "(a comparison)" in told


@pytest.mark.long
def test_a_watched_guard_that_jumps_in_a_machine_with_soft_transitions_only_is_told(tmp_path):
    guard = "(3.0 if p.force < 1.2 or x[1] > 0.0 else -3.0) - x[0]"
    watched = f"Transition('near', 'free', 'free', lambda t, x, p: {guard}, role='watched'),"
    _, (told,) = study(tmp_path, "", watched)
    assert "the guard of transition 'near' jumps through zero" in told


def test_a_condition_that_ceases_to_have_a_value_ends_nothing(tmp_path):
    branch, _ = study(tmp_path, condition("1e-3 + math.sqrt(1.2 - p.force)"))
    assert branch.outcome.reason == "bound"
    np.testing.assert_array_equal(branch["admissible"], branch["force"] <= 1.2)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("more", ["", STOP], ids=["soft only", "with a stop"])
def test_a_condition_at_a_soft_transition_that_is_not_a_number_is_told(tmp_path, more):
    branch, told = study(tmp_path, condition("math.sqrt(1.2 - p.force) + 1.0"), more)
    np.testing.assert_array_equal(branch["admissible"], branch["force"] <= 1.2)
    (sentence,) = [text for text in told if "condition 'gentle'" in text]
    assert "is not a number" in sentence
    assert "block.py, line" in sentence


@pytest.mark.long
def test_a_condition_whose_soft_transition_does_not_happen_is_not_missed(tmp_path):
    # The block stays before the gap: at force 1.4 it reaches 7, and the gap here is at 100.
    plugin = PLUGIN.replace("CONDITIONS", condition("math.sqrt(-1.0 - p.force)")).replace("MORE", STOP)
    plugin = plugin.replace("0.5 - x[0]", "100.0 - x[0]").replace("(x[0] - 0.5)", "(x[0] - 100.0)")
    (tmp_path / "block.py").write_text(plugin)
    (tmp_path / "run.yaml").write_text(RUN)
    result = cw.run(cw.read_run_file(tmp_path / "run.yaml", output=tmp_path / "out.h5"), figures=False)
    assert result.branches[0]["admissible"].all()
    with cw.open_database(tmp_path / "out.h5") as db:
        assert not [text for text in db.notes().values() if "is not a number" in text]

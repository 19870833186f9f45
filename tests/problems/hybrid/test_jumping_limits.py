"""Conditions and watched guards that jump through zero along a branch: told with their line, and passed."""

from __future__ import annotations

import numpy as np
import pytest

import contwalk as cw

# A driven block between two stops, with what is declared of it put in.
PLUGIN = """\
import math
import numpy as np
from contwalk.system import Condition, Mode, Parameter, State, System, Transition

def slide(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.force * math.cos(t) - 0.2 * x[1] - 0.1 * x[0]

def right(t, x, p):
    return 1.0 - x[0]

def left(t, x, p):
    return 1.0 + x[0]

def rebound(t, x, p, after):
    after[0] = x[0]
    after[1] = -0.6 * x[1]

SYSTEM = System(
    "block",
    states=(State("x"), State("v")),
    parameters=(Parameter("force", 1.0),),
    modes=(Mode("only", slide),),
    transitions=(
        Transition("right", "only", "only", right, reset=rebound),
        Transition("left", "only", "only", left, reset=rebound),
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
continue: {parameter: force, range: [1.0, 1.2]}
diagram: none
output: out.h5
"""


def study(folder, conditions="", more="", **given):
    """The branch, what is told of kinks, and the line of what was put in."""
    source = PLUGIN.replace("CONDITIONS", conditions).replace("MORE", more)
    (folder / "block.py").write_text(source)
    (folder / "run.yaml").write_text(RUN)
    line = 1 + PLUGIN[: PLUGIN.index("MORE" if more else "CONDITIONS")].count("\n")
    return *walked(folder, **given), line


def walked(folder, overrides=(), resume=False):
    """A branch, and what is told of kinks."""
    given = cw.read_run_file(folder / "run.yaml", list(overrides), output=folder / "out.h5")
    branch = cw.run(given, figures=False, resume=resume).branches[0]
    with cw.open_database(folder / "out.h5") as db:
        return branch, [text for key, text in db.notes().items() if key.startswith("kink")]


def condition(function, side="before"):
    return f"Condition('push', lambda t, x, p: {function}, at='right', side='{side}'),"


def watched(guard):
    return f"Transition('near', 'only', 'only', lambda t, x, p: {guard}, role='watched'),"


@pytest.mark.parametrize(
    ("function", "side", "what"),
    [
        ("1.0 if x[1] < 1.45 else -1.0", "before", "a comparison"),
        ("1e-4 if x[1] < 1.45 else -1e-4", "before", "a comparison"),
        ("1.0 if x[1] > -0.87 else -1.0", "after", "a comparison"),
        ("np.sign(1.45 - x[1])", "before", "sign"),
        ("1.0 if p.force < 1.05 else -1.0", "before", "a comparison"),
        ("0.5 - math.floor(x[1] - 0.45)", "before", "floor"),
    ],
)
def test_a_condition_that_jumps_through_zero_is_told_once(tmp_path, function, side, what):
    branch, (told,), line = study(tmp_path, condition(function, side))
    assert branch.outcome.reason == "bound"
    assert branch["admissible"][0] != branch["admissible"][-1]
    assert not [point for point in branch.special_points if point.label == "AZ"]
    assert f"b1: Its orbits pass a place where condition 'push' jumps through zero: {tmp_path}" in told
    assert f"block.py, line {line} ({what})" in told


@pytest.mark.parametrize(
    ("function", "changes"),
    [
        ("1.45 - x[1]", True),  # located
        ("max(1.45 - x[1], 2.0 * (1.45 - x[1]))", True),
        ("2.0 if x[1] < 1.45 else 1.0", False),  # a jump that is not through zero
        ("1.0 if x[1] < 9.0 else -1.0", False),  # never reached
    ],
)
def test_conditions_that_do_not_are_not(tmp_path, function, changes):
    branch, told, _ = study(tmp_path, condition(function))
    assert told == []
    assert (branch["admissible"][0] != branch["admissible"][-1]) == changes
    assert len([point for point in branch.special_points if point.label == "AZ"]) == int(changes)


def test_a_watched_guard_that_jumps_through_zero_at_an_event_is_told(tmp_path):
    guard = "3.0 - x[0] if math.cos(t) > 0.5 or p.force < 1.1 else x[0] - 3.0"
    branch, (told,), line = study(tmp_path, more=watched(guard))
    assert branch.outcome.reason == "bound"
    assert not np.array_equal(branch["admissible"], np.full(len(branch), branch["admissible"][0]))
    assert "the guard of transition 'near' jumps through zero" in told
    assert f"block.py, line {line} (a comparison)" in told


def test_what_is_told_is_the_same_after_resuming(tmp_path):
    (tmp_path / "whole").mkdir()
    whole, told, _ = study(tmp_path / "whole", condition("1.0 if x[1] < 1.45 else -1.0"))
    short, before, _ = study(
        tmp_path, condition("1.0 if x[1] < 1.45 else -1.0"), overrides=["continue.max_points=3"]
    )
    assert before == []
    assert len(short) < len(whole)
    again, after = walked(tmp_path, resume=True)
    assert np.array_equal(again["force"], whole["force"])
    assert [text.replace(str(tmp_path), "") for text in after] == [
        text.replace(str(tmp_path / "whole"), "") for text in told
    ]

"""Conditions and guards that jump through zero along a branch: told with their line.

Those that only tell something are passed; where the guard of a transition that acts jumps, the branch ends.
"""

from __future__ import annotations

import numpy as np
import pytest
from block_machine import PLUGIN

import contwalk as cw

pytestmark = pytest.mark.slow

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


@pytest.mark.drawn(2)
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


@pytest.mark.drawn(2)
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


JUMPING = [
    "(3.0 if x[1] < 1.45 else -3.0) - x[0]",  # in the middle of legs
    "(3.0 if p.force < 1.05 or x[0] < 0.999 else -3.0) - x[0]",  # right before they end
    "(3.0 if p.force < 1.05 or x[1] > 0.0 else -3.0) - x[0]",  # right after they begin
    "(3.0 if p.force < 1.05 or math.sin(t) > 0.5 else -3.0) - x[0]",  # at an instant
]


@pytest.mark.drawn(1)
@pytest.mark.parametrize("guard", JUMPING)
def test_the_guard_of_another_transition_that_jumps_through_zero_ends_the_branch(tmp_path, guard):
    branch, told, line = study(tmp_path, more=watched(guard).replace("role='watched'", "reset=rebound"))
    assert told == []
    assert (branch.outcome.status, branch.outcome.reason) == ("failed", "plugin_error")
    assert "the guard of transition 'near' jumps through zero" in branch.outcome.message
    assert f"block.py, line {line} (a comparison)" in branch.outcome.message
    assert branch["admissible"].all()
    if "p.force" in guard:
        assert 0.0 < 1.05 - branch["force"].max() < 1e-7


@pytest.mark.drawn(1)
@pytest.mark.parametrize("guard", JUMPING)
def test_a_watched_guard_that_jumps_through_zero_on_a_leg_is_told(tmp_path, guard):
    branch, (told,), line = study(tmp_path, more=watched(guard))
    assert branch.outcome.reason == "bound"
    assert not branch["admissible"].all()
    assert "the guard of transition 'near' jumps through zero" in told
    assert f"block.py, line {line} (a comparison)" in told


@pytest.mark.drawn(1)
@pytest.mark.parametrize(
    "guard",
    [
        "(3.0 if x[1] < 1.45 else 5.0) - x[0]",  # not through zero
        "(t / (2.0 * math.pi) + 0.3) % 1.0 - 2.0",  # a sawtooth that does not come to zero
        "3.0 - max(x[0], 2.0 * x[0])",  # no jump
        "(3.0 if p.force < 1.05 else -9.0) - x[0]",  # never above zero beyond: its event cannot happen
    ],
)
def test_guards_of_other_transitions_that_jump_otherwise_end_nothing(tmp_path, guard):
    branch, told, _ = study(tmp_path, more=watched(guard).replace("role='watched'", "reset=rebound"))
    assert branch.outcome.reason == "bound"
    assert told == []
    assert branch["admissible"].all()


@pytest.mark.long
def test_a_guard_that_is_armed_again_by_its_own_jump_hides_no_event(tmp_path):
    """A stop that is declared for one way of the velocity only: where it is touched, it jumps."""
    source = PLUGIN.replace("CONDITIONS", "").replace("MORE", "")
    source = source.replace("return 1.0 - x[0]", "return 1.0 - x[0] if x[1] > 0.0 else 1.0")
    (tmp_path / "block.py").write_text(source)
    (tmp_path / "run.yaml").write_text(RUN)
    branch, _ = walked(tmp_path, overrides=["continue.range=[1.0, 1.6]"])
    assert branch.outcome.reason == "plugin_error"
    assert "the guard of transition 'right' jumps through zero" in branch.outcome.message
    assert branch["force"].max() == pytest.approx(1.2170636, abs=1e-6)  # its grazing, were it smooth


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

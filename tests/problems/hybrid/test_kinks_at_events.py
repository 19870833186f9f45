"""Guards and resets that are smooth by pieces only, where the events of a branch come to another piece."""

from __future__ import annotations

import numpy as np
import pytest
from arm_machine import ARM

import contwalk as cw

RUN = """\
contwalk: 1
system: ./arm.py
start: {simulate: {state: {q: 0.0, w: 0.5, load: 0.0}, until: settled}}
continue: {parameter: force, range: [1.2, 1.5], max_points: 60, direction: forward}
"""
GUARD, SPEED = "0.6 - x[0]", "-0.5 * speed"
LINES = {"guard": 11, "reset": 16}


def study(folder, guard=GUARD, speed=SPEED):
    """The branch, the load at its last event, and the notes about kinks."""
    (folder / "arm.py").write_text(ARM.replace(GUARD, guard).replace(SPEED, speed))
    (folder / "run.yaml").write_text(RUN)
    result = cw.run(cw.read_run_file(folder / "run.yaml", output=folder / "run.h5"), figures=False)
    with cw.open_database(folder / "run.h5") as db:
        notes = [text for key, text in db.notes().items() if key.startswith("kink")]
    branch = result.branches[0]
    return branch, branch["load"][-1], notes


@pytest.mark.drawn(1)
@pytest.mark.parametrize(
    ("given", "of", "what"),
    [
        ({"speed": f"{SPEED} - (0.0 if x[2] > -0.8 else 0.1)"}, "reset", "a comparison"),  # no orbits beyond
        ({"speed": f"{SPEED} + (0.0 if x[2] > -0.8 else 0.1)"}, "reset", "a comparison"),  # two on both sides
        ({"speed": f"{SPEED} - np.where(x[2] > -0.8, 0.0, 1e-4)"}, "reset", "a comparison"),  # small
        ({"speed": f"{SPEED} - 0.1 * np.sign(x[2] + 0.8)"}, "reset", "sign"),
        ({"speed": f"{SPEED} - 0.1 * math.floor(x[2] + 0.8)"}, "reset", "floor"),
        ({"speed": f"{SPEED} - 0.1 * ((x[2] + 0.8) % 1.0)"}, "reset", "floor"),
        ({"guard": f"{GUARD} - (0.05 if x[2] > -0.8 else 0.0)"}, "guard", "a comparison"),
    ],
)
def test_a_branch_ends_where_its_event_comes_to_a_jump(tmp_path, given, of, what):
    branch, load, _ = study(tmp_path, **given)
    assert (branch.outcome.status, branch.outcome.reason) == ("failed", "plugin_error")
    assert f"the {of} of transition 'pad' jumps" in branch.outcome.message
    assert f"arm.py, line {LINES[of]} ({what})" in branch.outcome.message
    # The last step that is refused is 1e-7 long, in the metric of the branch.
    assert -0.8 < load < -0.8 + 1e-6
    near = branch["force"] > branch["force"][-1] - 1e-3
    assert near.sum() < 12  # points do not pile up: half the way each would take 17
    assert (branch["stable"] == 1).all()


@pytest.mark.long
def test_a_branch_ends_where_a_jump_right_before_an_event_has_hidden_an_earlier_one(tmp_path):
    """The pad is at 0.6 up to a load of -0.8, and at 0.65 then: where that load is reached between both, the
    pad has been passed before.
    """
    branch, load, _ = study(tmp_path, guard=f"{GUARD} + (0.05 if x[2] > -0.8 else 0.0)")
    assert branch.outcome.reason == "plugin_error"
    assert "the guard of transition 'pad' jumps through zero" in branch.outcome.message
    assert f"arm.py, line {LINES['guard']} (a comparison)" in branch.outcome.message
    # Backwards from the event to 0.6: its speed changes by 0.04 at most on the way.
    rate = 0.5 * (0.625 - load)
    assert load - rate * 0.05 / branch["w"][-1] == pytest.approx(-0.8, abs=1e-3)
    assert (branch["stable"] == 1).all()


def test_a_jump_of_the_free_parameter_ends_the_branch_there(tmp_path):
    branch, _, _ = study(tmp_path, speed=f"{SPEED} if p.force < 1.4 else -0.45 * x[1]")
    assert branch.outcome.reason == "plugin_error"
    assert 0.0 < 1.4 - branch["force"][-1] < 1e-6


@pytest.mark.drawn(1)
@pytest.mark.parametrize(
    ("given", "of", "what"),
    [
        ({"speed": f"{SPEED} - 0.3 * max(x[2] + 0.8, 0.0)"}, "reset", "max"),
        ({"speed": f"{SPEED} - 0.3 * abs(x[2] + 0.8)"}, "reset", "abs"),
        ({"speed": f"{SPEED} - (0.3 * (x[2] + 0.8) if x[2] < -0.8 else 0.0)"}, "reset", "a comparison"),
        ({"guard": f"{GUARD} + 0.5 * abs(x[2] + 0.8)"}, "guard", "abs"),
    ],
)
def test_slopes_that_jump_at_the_event_are_told_and_passed(tmp_path, given, of, what):
    branch, load, (told,) = study(tmp_path, **given)
    assert branch.outcome.reason == "bound"
    assert load < -0.8
    assert f"slopes of the {of} of transition 'pad' jump" in told
    assert f"arm.py, line {LINES[of]} ({what})" in told


@pytest.mark.drawn(1)
@pytest.mark.parametrize(
    "given",
    [
        {"speed": f"{SPEED} if x[2] > -0.8 else {SPEED} + 3.0 * (x[0] - 0.6)"},  # the same at the event
        {"speed": f"{SPEED} + abs(x[0] - 0.6)"},  # no motion has its event beside the guard
        {"guard": f"({GUARD}) * (2.0 if x[2] > -0.8 else 1.0)"},  # another number, with the same zero
        {"guard": f"({GUARD}) / (1.0 + abs(x[2] + 0.8))"},
        {"speed": f"{SPEED} - 0.3 * max(-5.0 - x[2], 0.0)"},  # never reached
        {"speed": f"{SPEED} if math.cos(t) < 0.9 else 0.1"},
    ],
)
def test_pieces_that_fit_at_the_event_are_none(tmp_path, given):
    branch, load, notes = study(tmp_path, **given)
    assert branch.outcome.reason == "bound"
    assert load < -0.8
    assert notes == []


def test_a_point_beside_a_jump_is_found_again_when_the_run_is_resumed(tmp_path):
    branch, _, _ = study(tmp_path, speed=f"{SPEED} - (0.0 if x[2] > -0.8 else 0.1)")
    given = tmp_path / "run.yaml"
    short = cw.read_run_file(given, ["continue.max_points=9"], output=tmp_path / "short.h5")
    assert len(cw.run(short, figures=False).branches[0]) < len(branch)
    whole = cw.read_run_file(given, output=tmp_path / "short.h5")
    again = cw.run(whole, figures=False, resume=True).branches[0]
    assert again.outcome == branch.outcome
    assert np.array_equal(again["force"], branch["force"])


@pytest.mark.long
def test_a_jump_along_a_path_ends_the_branch_there(tmp_path):
    """Between two parameter sets: what jumps depends on both parameters."""
    speed = f"{SPEED} - (0.0 if p.force - p.lag < 0.85 else 0.1)"
    source = ARM.replace(SPEED, speed)
    source = source.replace('Parameter("force", 1.3),', 'Parameter("force", 1.3), Parameter("lag", 0.5),')
    source = source.replace("0.5 * (x[0] - x[2])", "p.lag * (x[0] - x[2])")
    (tmp_path / "arm.py").write_text(source)
    (tmp_path / "run.yaml").write_text(
        RUN.replace("parameter: force, range: [1.2, 1.5], max_points: 60", "max_points: 200")
        + "path: {from: {force: 1.3, lag: 0.5}, to: {force: 1.4, lag: 0.52}}\n"
    )
    result = cw.run(cw.read_run_file(tmp_path / "run.yaml", output=tmp_path / "run.h5"), figures=False)
    branch = result.branches[0]
    assert branch.outcome.reason == "plugin_error"
    assert f"arm.py, line {LINES['reset']} (a comparison)" in branch.outcome.message
    # force - lag = 0.8 + 0.08 s along it
    assert 0.0 < 0.05 / 0.08 - branch.points["free"][-1, 0] < 1e-5


# Two tanks: the first one is filled up to 1, and then changes places with the second, which leaks.
SWAP = """\
from contwalk.system import Mode, Parameter, State, Symmetry, System, Transition

def fill(t, x, p, dx):
    dx[0] = 1.0
    dx[1] = -p.leak * x[1]

def swapped(t, x, p, image):
    image[0] = x[1]
    image[1] = x[0]{change}

SYSTEM = System(
    "tanks",
    states=(State("first"), State("second")),
    parameters=(Parameter("leak", 2.0),),
    modes=(Mode("on", fill),),
    transitions=(Transition("full", "on", "on", lambda t, x, p: 1.0 - x[0], relabel="swap"),),
    symmetries=(Symmetry("swap", "relabel", swapped),),
)
"""
TANKS = """\
contwalk: 1
system: ./tanks.py
start: {simulate: {state: {first: 0.3, second: 0.8}, until: settled}}
continue: {parameter: leak, range: [1.9, 2.5], max_points: 60, direction: forward}
"""


@pytest.mark.drawn(1)
@pytest.mark.parametrize(
    "change", [" * (1.0 if p.leak < 2.2 else 0.9)", " - (0.0 if p.leak < 2.2 else 1e-3)"]
)
def test_a_jump_of_the_map_that_relabels_is_told(tmp_path, change):
    (tmp_path / "tanks.py").write_text(SWAP.replace("{change}", change))
    (tmp_path / "run.yaml").write_text(TANKS)
    result = cw.run(cw.read_run_file(tmp_path / "run.yaml", output=tmp_path / "run.h5"), figures=False)
    branch = result.branches[0]
    assert branch.outcome.reason == "plugin_error"
    assert "the map of symmetry 'swap' jumps" in branch.outcome.message
    line = 1 + SWAP[: SWAP.index("{change}")].count("\n")
    assert f"tanks.py, line {line} (a comparison)" in branch.outcome.message
    assert 0.0 < 2.2 - branch["leak"][-1] < 1e-6


def test_a_jump_at_the_end_of_a_collapsed_leg_ends_the_branch(tmp_path):
    """The pad holds the arm until it is let go, which is at once here: a leg of no time."""
    source = ARM.replace(SPEED, f"{SPEED} - (0.0 if x[2] > -0.8 else 0.1)")
    source = source.replace(
        'Transition("pad", "free", "free", pad, reset=throw)',
        'Transition("pad", "free", "held", pad), '
        'Transition("throw", "held", "free", lambda t, x, p: x[0] - 0.7, level=True, reset=throw)',
    ).replace('Mode("free", swing)', 'Mode("free", swing), Mode("held", swing)')
    (tmp_path / "arm.py").write_text(source)
    (tmp_path / "run.yaml").write_text(RUN)
    result = cw.run(cw.read_run_file(tmp_path / "run.yaml", output=tmp_path / "run.h5"), figures=False)
    branch = result.branches[0]
    assert branch.info.settings["legs"][1][-1] is True  # collapsed
    assert branch.outcome.reason == "plugin_error"
    assert "the reset of transition 'throw' jumps" in branch.outcome.message
    assert f"arm.py, line {LINES['reset']} (a comparison)" in branch.outcome.message
    assert -0.8 < branch["load"][-1] < -0.8 + 1e-6

"""What a correct run file becomes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from run_file_cases import GOOD, read, write_run

from contwalk.workflow.run_file.reading import FigureSpec, Mark, ReportAt, read_run_file, read_run_text

HEAD = "system: ./rotor.py\n"
CONTINUE = "continue: {parameter: stiffness, range: [1, 3]}\n"
START = "start: {equilibrium: balanced}\n"


def test_a_short_file_is_filled_with_defaults(tmp_path):
    run = read(tmp_path, GOOD)
    assert run.system.name == "rotor"
    assert run.system_reference == "./rotor.py"
    assert run.model == {"masses": 2, "suspension": "isotropic"}
    assert run.parameters == {"stiffness": 2.0, "damping": 0.5, "load": 0.0}
    assert run.accuracy == 1e-8
    assert (run.free, run.range, run.direction, run.max_points) == ("stiffness", (1.0, 3.0), "both", 1000)
    assert run.follow == {"BP", "HB", "PD"}
    assert run.depth == 5
    assert run.events == {"GR": "stop", "OC": "switch", "AZ": "ignore", "BE": "stop"}
    assert run.output == Path("run.h5")
    assert (run.marks, run.figures, run.sweep, run.report_at, run.engine) == ((), (), None, None, {})
    assert run.text == GOOD
    (start,) = run.starts
    assert (start.kind, start.name) == ("equilibrium", "balanced")
    assert start.where.endswith("line 4, key start")
    assert start.parameters == run.parameters


def test_every_key_at_once(tmp_path):
    text = """\
contwalk: 1
system: ./rotor.py
model: {masses: 3}
preset: heavy
parameters: {load: 2.5}
accuracy: 1e-9
start:
  - {equilibrium: [balanced, tilted]}
  - {state: {speed: 2, angle: .5}, parameters: {load: -1.0e-8}}
  - {simulate: {state: {angle: 0, speed: 1}, until: 20}}
  - {from: stored/other.h5, point: b1/HB1}
continue: {parameter: stiffness, range: [1, 3], direction: up, max_points: 50, stop_at: {swing: 2}}
path: null
diagram: {follow: all, depth: 0}
mark: {stiffness: 1.5, max_re: [0.0, extremum]}
events: {GR: switch, AZ: stop}
report_at: {event: touch_down, side: after}
output: there.h5
figures: [multipliers, {bifurcation_diagram: {x: stiffness, y: max_re}}]
sweep: {damping: {from: 0, to: 1, count: 3}}
engine: {step: 0.01, max_step: 0.1, newton_iterations: 8}
"""
    run = read(tmp_path, text)
    assert run.model["masses"] == 3
    assert run.parameters == {"stiffness": 2.0, "damping": 0.25, "load": 2.5}
    assert [start.kind for start in run.starts] == [
        "equilibrium",
        "equilibrium",
        "state",
        "simulate",
        "from",
    ]
    _, tilted, state, simulate, stored = run.starts
    assert tilted.name == "tilted"
    np.testing.assert_array_equal(state.state, [0.5, 2.0])
    assert state.parameters["load"] == -1e-8
    assert state.where.endswith("line 9, key start.1")
    assert simulate.until == 20.0
    assert stored.file == tmp_path / "stored" / "other.h5"
    assert stored.point == "b1/HB1"
    assert stored.given == {"damping": 0.25, "load": 2.5}
    assert (run.direction, run.max_points, run.stop_at) == ("forward", 50, {"swing": (2.0,)})
    assert run.follow == {"LP", "BP", "HB", "PD", "NS", "GR", "OC", "AZ", "BE"}
    assert run.marks == (Mark("stiffness", (1.5,)), Mark("max_re", (0.0,), extremum=True))
    assert run.events == {"GR": "switch", "OC": "switch", "AZ": "stop", "BE": "stop"}
    assert run.report_at == ReportAt(event="touch_down", side="after")
    assert run.output == Path("there.h5")
    assert run.figures == (
        FigureSpec("multipliers"),
        FigureSpec("bifurcation_diagram", {"x": "stiffness", "y": "max_re"}),
    )
    assert run.sweep == ("damping", (0.0, 0.5, 1.0))
    written = GOOD + "sweep: {damping: {from: 0.1, to: 0.7, count: 7}}\n"
    assert read(tmp_path, written).sweep == ("damping", (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7))
    assert run.engine == {"step": 0.01, "max_step": 0.1, "newton_iterations": 8}


@pytest.mark.parametrize("written", ["1e-8", "1.0e-8", "1E-8", "+1.e-8", ".00000001"])
def test_numbers_as_people_write_them(tmp_path, written):
    assert read(tmp_path, GOOD + f"accuracy: {written}\n").accuracy == 1e-8


@pytest.mark.parametrize(
    ("word", "direction"),
    [
        ("both", "both"),
        ("up", "forward"),
        ("forward", "forward"),
        ("down", "backward"),
        ("backward", "backward"),
    ],
)
def test_directions(tmp_path, word, direction):
    assert read(tmp_path, GOOD, f"continue.direction={word}").direction == direction


def test_all_expands_to_every_named_start(tmp_path):
    run = read(tmp_path, HEAD + "start: {equilibrium: all}\n" + CONTINUE)
    assert [(start.name, start.optional) for start in run.starts] == [("balanced", True), ("tilted", True)]


def test_a_stored_point_keeps_its_free_parameter(tmp_path):
    text = HEAD + "parameters: {stiffness: 9, damping: 1}\n" + CONTINUE
    run = read(tmp_path, text + "start: {from: a.h5, point: b2/12}\n")
    assert run.starts[0].given == {"damping": 1.0}
    run = read(tmp_path, text + "start: {from: a.h5, point: b2/12, parameters: {stiffness: 9}}\n")
    assert run.starts[0].given == {"damping": 1.0, "stiffness": 9.0}


def test_a_path_between_a_preset_and_values(tmp_path):
    text = HEAD + START + "parameters: {damping: 1.0}\npath: {from: heavy, to: {load: 7}}\n"
    run = read(tmp_path, text)
    assert run.free == "path"
    assert run.range == (0.0, 1.0)
    assert run.parameter_path == (
        {"stiffness": 2.0, "damping": 0.25, "load": 3.0},
        {"stiffness": 2.0, "damping": 1.0, "load": 7.0},
    )
    assert run.starts[0].parameters == run.parameter_path[0]


def test_a_path_starts_at_the_lower_end_of_its_range(tmp_path):
    text = HEAD + START + "path: {from: {load: 1}, to: {load: 3}}\ncontinue: {range: [0.5, 1]}\n"
    run = read(tmp_path, text + "mark: {path: 0.75, load: 2.5}\n")
    assert run.range == (0.5, 1.0)
    assert run.starts[0].parameters["load"] == 2.0


def test_follow_can_be_one_word(tmp_path):
    assert read(tmp_path, GOOD + "diagram: none\n").follow == frozenset()
    assert read(tmp_path, GOOD + "diagram: {follow: none}\n").follow == frozenset()
    assert read(tmp_path, GOOD + "diagram: {follow: HB}\n").follow == {"HB"}
    assert len(read(tmp_path, GOOD + "diagram: all\n").follow) == 9


def test_a_section_to_report_at(tmp_path):
    run = read(tmp_path, GOOD + "report_at: {section: {angle: 0.3}, direction: falling}\n")
    assert run.report_at == ReportAt(section=("angle", 0.3), direction="falling")


def test_the_output_given_on_the_command_line_wins(tmp_path):
    path = write_run(tmp_path, GOOD + "output: a.h5\n")
    assert read_run_file(path, output="b.h5").output == Path("b.h5")


def test_a_run_file_named_from_its_own_folder(tmp_path, monkeypatch):
    write_run(tmp_path, GOOD)
    monkeypatch.chdir(tmp_path)
    assert read_run_file("run.yaml").path == Path("run.yaml")


def test_a_byte_order_mark_and_foreign_line_ends(tmp_path):
    path = write_run(tmp_path, "")
    path.write_bytes(b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode())
    assert read_run_file(path).range == (1.0, 3.0)


def test_each_swept_value_is_a_study(tmp_path):
    run = read(tmp_path, GOOD + "sweep: {damping: [0.1, 0.2]}\n")
    first, second = run.studies()
    assert (first.sweep, second.sweep) == (None, None)
    assert [study.parameters["damping"] for study in (first, second)] == [0.1, 0.2]
    assert second.starts[0].parameters["damping"] == 0.2
    assert second.starts[0].given["damping"] == 0.2
    assert first.studies() == (first,)


def test_the_same_study_in_other_words(tmp_path):
    run = read(tmp_path, GOOD)
    assert run.same_study(GOOD)
    assert run.same_study(GOOD + "accuracy: 1.0e-08  # the default\noutput: other.h5\nfigures: [machine]\n")
    assert run.same_study(dict(run.data))
    assert not run.same_study(GOOD.replace("3.0", "4.0"))
    assert not run.same_study(GOOD + "sweep: {damping: [0.1]}\n")
    span = "sweep: {damping: {from: 0.1, to: 0.3, count: 3}}\n"
    assert read(tmp_path, GOOD + span).same_study(GOOD + span)  # and without a warning: they are errors here
    assert not run.same_study("nonsense: [")
    assert not run.same_study("nonsense: 1")


def test_config_text_holds_the_overrides(tmp_path):
    run = read(tmp_path, GOOD, "parameters.damping=1e-8", "continue.range=[1,6]", "diagram=none")
    assert not run.same_study(GOOD)
    again = read_run_text(run.config(), run.path)
    assert again.same_study(run.data)
    assert again.range == (1.0, 6.0)
    assert again.parameters["damping"] == 1e-8
    assert read(tmp_path, GOOD).config() == GOOD

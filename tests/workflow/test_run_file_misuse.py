"""Misuse of the run file: each mistake is told with file, line, key and the nearest name."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from run_file_cases import GOOD, PLUGIN, message, write_run

from contwalk.errors import RunFileError
from contwalk.workflow.run_file.reading import read_run_file, read_run_text

# What is appended to the good file (8 is the line of its first line), and what must be said of it.
APPENDED = [
    ("paramters: {}", ["line 8", "key paramters", "unknown key", "Did you mean 'parameters'?"]),
    ("direction: up", ["line 8", "key direction", "is a key of 'continue'"]),
    ("accuracy: fine", ["line 8", "key accuracy", "the text 'fine'", "not a number"]),
    ("accuracy: true", ["line 8", "key accuracy", "is true", "not a number"]),
    ("accuracy: 0", ["line 8", "key accuracy", "to 0.5"]),
    ("accuracy: 0.6", ["line 8", "key accuracy", "to 0.5"]),
    ("accuracy: 1e-15", ["line 8", "key accuracy", "double precision", "1e-14"]),
    ("accuracy: .nan", ["line 8", "key accuracy", "not finite"]),
    ("preset: heavi", ["line 8", "key preset", "Did you mean 'heavy'?"]),
    ("preset: 3", ["line 8", "key preset", "not a text"]),
    ("model: {mases: 2}", ["line 8", "key model", "Did you mean 'masses'?"]),
    ("model: {masses: 0}", ["line 8", "key model", "from 1 up"]),
    ("model: [masses]", ["line 8", "key model", "a list", "not a mapping"]),
    ("path: {from: heavy, to: light}", ["line 6", "key continue.parameter", "path"]),
    ("path: {from: heavy}", ["line 8", "key path.to", "missing"]),
    ("diagram: {follow: [HB, PX]}", ["line 8", "key diagram.follow.1", "'PX'", "Did you mean 'PD'?"]),
    ("diagram: {follow: [hb]}", ["line 8", "Did you mean 'HB'?"]),
    ("diagram: {depth: -1}", ["line 8", "key diagram.depth", "from 0 up"]),
    ("diagram: {dept: 1}", ["line 8", "key diagram.dept", "Did you mean 'depth'?"]),
    ("mark: {stifness: 1}", ["line 8", "key mark.stifness", "Did you mean 'stiffness'?"]),
    ("mark: {damping: 1}", ["line 8", "key mark.damping", "does not change along the branch"]),
    ("mark: {angle: 1}", ["line 8", "key mark.angle", "is a state, not an observable", "swing"]),
    ("mark: {swing: [1, extremun]}", ["line 8", "key mark.swing.1", "extremum"]),
    ("mark: {swing: []}", ["line 8", "key mark.swing", "no value"]),
    ("events: {GR: halt}", ["line 8", "key events.GR", "stop, ignore, switch"]),
    ("events: {HB: stop}", ["line 8", "key events.HB", "GR, OC, AZ"]),
    ("report_at: {event: touchdown}", ["line 8", "key report_at.event", "Did you mean 'touch_down'?"]),
    ("report_at: {}", ["line 8", "key report_at", "either an event or a section"]),
    ("report_at: {event: touch_down, side: left}", ["line 8", "key report_at.side", "before, after"]),
    ("report_at: {event: touch_down, direction: rising}", ["line 8", "belongs to a section"]),
    ("report_at: {section: {angle: 0}, direction: rising, side: after}", ["belongs to an event"]),
    ("report_at: {section: {angle: 0}}", ["line 8", "key report_at", "and a direction"]),
    ("report_at: {section: {angel: 0}, direction: rising}", ["section.angel", "Did you mean 'angle'?"]),
    ("output: ''", ["line 8", "key output", "empty"]),
    ('output: "a\\0b"', ["line 8", "key output", "null character"]),
    ("output: [a.h5]", ["line 8", "key output", "not a text"]),
    ("figures: [bifurcation]", ["line 8", "key figures.0", "Did you mean 'bifurcation_diagram'?"]),
    ("figures: [{machine: {}, eigenvalues: {}}]", ["line 8", "key figures.0", "2 names"]),
    (
        "figures: [{machine: {w: m}}]",
        ["line 8", "key figures.0.machine.w", "unknown key", "x, y, z, xlim, ylim, full, together, file"],
    ),
    (
        "figures: [{machine: {file: a.png}}, {eigenvalues: {file: a.png}}]",
        ["line 8", "key figures.1.eigenvalues.file", "'a.png' is the file of figure 1 too", "of its own"],
    ),
    (
        "figures: [eigenvalues, {machine: {file: a.jpg}}]",
        [
            "line 8",
            "key figures.1.machine.file",
            "'a.jpg' cannot be drawn",
            "format .jpg is not",
            ".png, .svg, .pdf, .pgf",
        ],
    ),
    ("figures: [{machine: {file: plot}}]", ["line 8", "key figures.0.machine.file", "(no suffix)"]),
    ("figures: [{machine: {z: load}}]", ["line 8", "key figures.0.machine.z", "has no third axis"]),
    ("figures: [{machine: {full: true}}]", ["line 8", "figures.0.machine.full", "belongs to multipliers"]),
    ("figures: [{machine: {x: dampin}}]", ["line 8", "figures.0.machine.x", "Did you mean 'damping'?"]),
    ("sweep: {stiffness: [1, 2]}", ["line 8", "key sweep.stiffness", "changes already"]),
    ("sweep: {dampin: [1, 2]}", ["line 8", "key sweep.dampin", "Did you mean 'damping'?"]),
    ("sweep: {damping: [0.5, 2]}", ["line 8", "key sweep.damping", "2 lies outside", "[0, 1]", "N m s"]),
    ("sweep: {damping: [0.5, 0.5]}", ["line 8", "key sweep.damping", "twice"]),
    ("sweep: {damping: {from: 0, to: 1}}", ["line 8", "key sweep.damping.count", "missing"]),
    ("sweep: {damping: {from: 0, to: 1, count: 1e9}}", ["line 8", "key sweep.damping.count", "whole number"]),
    ("sweep: {damping: 0.1, load: 1}", ["line 8", "key sweep", "exactly one"]),
    ("engine: {step: -1}", ["line 8", "key engine.step", "a positive number"]),
    ("engine: {step: 1, max_step: 0.1}", ["line 8", "key engine", "min_step <= step <= max_step"]),
    ("engine: {max_angle: 180}", ["line 8", "key engine.max_angle", "up to 90"]),
    ("engine: {newton_iterations: 2.5}", ["line 8", "key engine.newton_iterations", "whole number"]),
    ("engine: {discretization: spectral}", ["line 8", "key engine.discretization", "shooting"]),
    (
        "engine: {discretization: collocation, method: dop853}",
        ["line 8", "key engine", "collocation and for the integrator dop853", "Remove one of the two"],
    ),
    ("engine: {newton: 2}", ["line 8", "key engine.newton", "unknown key"]),
]


@pytest.mark.parametrize(("line", "said"), APPENDED, ids=[line for line, _ in APPENDED])
def test_a_wrong_line_is_told(tmp_path, line, said):
    text = message(tmp_path, GOOD + line + "\n")
    assert str(tmp_path / "run.yaml") in text
    for words in said:
        assert words in text


# A line of the good file, what it is replaced by, and what must be said.
REPLACED = [
    ("contwalk: 1", "contwalk: 2", ["line 1", "key contwalk", "newer", "Update contwalk"]),
    ("contwalk: 1", "contwalk: 0", ["line 1", "key contwalk"]),
    ("contwalk: 1", "contwalk: true", ["line 1", "key contwalk", "is true"]),
    ("contwalk: 1", "contwalk: '1'", ["line 1", "key contwalk", "the text '1'"]),
    ("system: ./rotor.py\n", "", ["key system", "missing", "plugin"]),
    ("system: ./rotor.py", "system:", ["line 2", "key system", "missing"]),
    ("./rotor.py", "./rotors.py", ["line 2", "key system", "rotors.py", "does not exist"]),
    ("./rotor.py", "no_such_system", ["line 2", "key system", "no installed system"]),
    ("./rotor.py", "5", ["line 2", "key system", "not a text"]),
    (
        "{stiffness: 2.0}",
        "{stifness: 2.0}",
        ["line 3", "key parameters.stifness", "Did you mean 'stiffness'?"],
    ),
    ("{stiffness: 2.0}", "{damping: 2.0}", ["line 3", "parameters.damping", "2", "[0, 1]", "N m s"]),
    ("{stiffness: 2.0}", "{stiffness: yes}", ["line 3", "key parameters.stiffness", "the text 'yes'"]),
    ("{stiffness: 2.0}", "{stiffness: true}", ["line 3", "key parameters.stiffness", "is true"]),
    ("{stiffness: 2.0}", "{stiffness: 2 N m}", ["line 3", "key parameters.stiffness", "the text '2 N m'"]),
    ("{stiffness: 2.0}", "{stiffness: }", ["line 3", "key parameters.stiffness", "is empty"]),
    ("{stiffness: 2.0}", "{stiffness: .inf}", ["line 3", "key parameters.stiffness", "not finite"]),
    ("{stiffness: 2.0}", "{stiffness: 1e999}", ["line 3", "key parameters.stiffness", "not finite"]),
    ("{stiffness: 2.0}", "{stiffness: 1" + 400 * "0" + "}", ["line 3", "not finite"]),
    ("{stiffness: 2.0}", "{stiffness: 1" + 5000 * "0" + "}", ["line 3", "not a number"]),
    ("{stiffness: 2.0}", "[2.0]", ["line 3", "key parameters", "a list", "not a mapping"]),
    ("start: {equilibrium: balanced}\n", "", ["key start", "missing"]),
    (
        "{equilibrium: balanced}",
        "balanced",
        ["line 4", "key start", "the text 'balanced'", "equilibrium: NAME"],
    ),
    ("{equilibrium: balanced}", "[]", ["line 4", "key start", "is an empty list", "equilibrium: NAME"]),
    ("{equilibrium: balanced}", "{}", ["line 4", "key start", "exactly one of equilibrium, state"]),
    ("{equilibrium: balanced}", "{equilibrium: balancd}", ["line 4", "start.equilibrium", "'balanced'?"]),
    ("{equilibrium: balanced}", "{equilibrium: []}", ["line 4", "key start", "no equilibrium"]),
    ("{equilibrium: balanced}", "{equilibrium: [balanced, balanced]}", ["line 4", "listed twice"]),
    ("{equilibrium: balanced}", "{equilibrum: balanced}", ["line 4", "start.equilibrum", "'equilibrium'?"]),
    ("{equilibrium: balanced}", "{equilibrium: balanced, from: a.h5}", ["line 4", "exactly one of"]),
    ("{equilibrium: balanced}", "{state: {angle: 1}}", ["line 4", "key start.state", "no value for speed"]),
    (
        "{equilibrium: balanced}",
        "{state: {angle: 1, sped: 2, speed: 0}}",
        ["line 4", "key start.state.sped", "Did you mean 'speed'?"],
    ),
    ("{equilibrium: balanced}", "{state: {angle: 1, speed: x}}", ["line 4", "start.state.speed", "a number"]),
    ("{equilibrium: balanced}", "{simulate: {until: 3}}", ["line 4", "start.simulate.state", "missing"]),
    (
        "{equilibrium: balanced}",
        "{simulate: {state: {angle: 1, speed: 0}, until: setled}}",
        ["line 4", "key start.simulate.until", "settled"],
    ),
    (
        "{equilibrium: balanced}",
        "{simulate: {state: {angle: 1, speed: 0}, until: -3}}",
        ["line 4", "key start.simulate.until", "positive"],
    ),
    ("{equilibrium: balanced}", "{from: a.h5}", ["line 4", "key start", "no point", "b1/HB1"]),
    ("{equilibrium: balanced}", "{from: a.h5, point: HB1}", ["line 4", "key start.point", "b1/12"]),
    ("{equilibrium: balanced}", "{from: a.h5, point: b1/HX1}", ["line 4", "key start.point", "b1/12"]),
    (
        "{equilibrium: balanced}",
        "{equilibrium: balanced, parameters: {lod: 1}}",
        ["line 4", "key start.parameters.lod", "Did you mean 'load'?"],
    ),
    (
        "{equilibrium: balanced}",
        "\n- {equilibrium: balanced}\n- {equilibrium: tiltd}",
        ["line 6", "key start.1.equilibrium", "'tilted'"],
    ),
    ("  range: [1.0, 3.0]\n", "", ["line 5", "key continue.range", "missing", "[lowest, highest]"]),
    ("[1.0, 3.0]", "[3.0, 1.0]", ["line 7", "key continue.range", "wrong way round", "[lowest, highest]"]),
    ("[1.0, 3.0]", "[2.0, 2.0]", ["line 7", "key continue.range", "empty"]),
    ("[1.0, 3.0]", "[1.0, 1e+200]", ["line 7", "key continue.range", "1e+200", "size", "another unit"]),
    ("[1.0, 3.0]", "[0.0, 1e-200]", ["line 7", "key continue.range", "1e-200", "size", "another unit"]),
    ("[1.0, 3.0]", "[1.0, .inf]", ["line 7", "key continue.range.1", "not finite"]),
    ("[1.0, 3.0]", "[-1.0, 3.0]", ["line 7", "key continue.range", "-1", "bounds", "[0, inf)", "N m"]),
    ("[1.0, 3.0]", "[1.0]", ["line 7", "key continue.range", "two numbers"]),
    ("[1.0, 3.0]", "[1, 2, 3]", ["line 7", "key continue.range", "3 numbers"]),
    ("[1.0, 3.0]", "3", ["line 7", "key continue.range", "not a list"]),
    ("[1.0, 3.0]", "[2.5, 3.0]", ["line 7", "key continue.range", "stiffness = 2,", "[2.5, 3]"]),
    ("parameter: stiffness", "parameter: stifness", ["line 6", "continue.parameter", "'stiffness'?"]),
    ("  parameter: stiffness\n", "", ["line 5", "key continue.parameter", "nothing is continued"]),
    ("  range", "  direction: upward\n  range", ["line 7", "key continue.direction", "Did you mean"]),
    ("  range", "  direction: [up, down]\n  range", ["line 7", "key continue.direction", "a list"]),
    ("  range", "  max_points: 0\n  range", ["line 7", "key continue.max_points", "from 1 up"]),
    ("  range", "  max_points: many\n  range", ["line 7", "key continue.max_points", "whole number"]),
    ("  range", "  stop_at: {swin: 1}\n  range", ["line 7", "continue.stop_at.swin", "'swing'?"]),
    ("  range", "  stop_at: {swing: []}\n  range", ["line 7", "continue.stop_at.swing", "no value"]),
    ("  range", "  rang: [1, 2]\n  range", ["line 7", "key continue.rang", "Did you mean 'range'?"]),
    ("  range", "  accuracy: 1e-9\n  range", ["line 7", "continue.accuracy", "without indentation"]),
]


@pytest.mark.parametrize(("line", "by", "said"), REPLACED, ids=[by[:60] for _, by, _ in REPLACED])
def test_a_wrong_value_is_told(tmp_path, line, by, said):
    assert line in GOOD
    text = message(tmp_path, GOOD.replace(line, by))
    assert str(tmp_path / "run.yaml") in text
    for words in said:
        assert words in text


PATH = "system: ./rotor.py\nstart: {equilibrium: balanced}\npath: {from: heavy, to: light}\n"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (PATH.replace("light", "lite"), ["line 3", "key path.to", "Did you mean 'light'?"]),
        (PATH.replace("light", "{lod: 1}"), ["line 3", "key path.to.lod", "Did you mean 'load'?"]),
        (PATH.replace("light", "{damping: 2}"), ["line 3", "key path.to.damping", "[0, 1]"]),
        (PATH.replace("light", "heavy"), ["line 3", "key path", "same parameters"]),
        (PATH + "continue: {range: [0, 2]}\n", ["line 4", "key continue.range", "within [0, 1]"]),
        (PATH + "sweep: {load: 1}\n", ["line 4", "key sweep.load", "changes already"]),
        (
            PATH.replace("balanced", "balanced, parameters: {load: 1}"),
            ["line 2", "key start.parameters.load", "set by the path"],
        ),
    ],
)
def test_a_wrong_path_is_told(tmp_path, text, said):
    told = message(tmp_path, text)
    for words in said:
        assert words in told


def test_a_swept_parameter_may_not_be_set_by_a_start(tmp_path):
    text = GOOD.replace("balanced}", "balanced, parameters: {load: 1}}") + "sweep: {load: [1, 2]}\n"
    assert "line 4, key start.parameters.load: 'load' is swept" in message(tmp_path, text)


def test_output_never_overwrites_what_the_run_reads(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    start = "{from: old.h5, point: b1/HB1}"
    text = GOOD.replace("{equilibrium: balanced}", start) + "output: old.h5\n"
    assert "line 8, key output" in message(tmp_path, text)
    assert "the run file itself" in message(tmp_path, GOOD + "output: run.yaml\n")


def test_all_problems_are_told_first_one_first(tmp_path):
    text = GOOD.replace("stiffness: 2.0", "stifness: 2.0") + "preset: heavi\nmark: {angel: 1}\n"
    lines = message(tmp_path, text).splitlines()
    assert len(lines) == 3
    for line, number in zip(lines, (3, 8, 9), strict=True):
        assert f"run.yaml, line {number}, key" in line
    assert len(message(tmp_path, GOOD + "accuracy: x\nfigures: 3\nengine: 4\n").splitlines()) == 3


def test_one_mistake_is_told_once(tmp_path):
    for by in ("{equilibrum: balanced}", "{from: a.h5}", "{state: {angle: x, speed: 0}}"):
        text = GOOD.replace("{equilibrium: balanced}", by)
        assert len(message(tmp_path, text).splitlines()) == 1
    assert "Did you mean" not in message(tmp_path, GOOD + "mark: {damping: 1}\n")


def test_very_many_problems_stay_readable(tmp_path):
    text = GOOD + "".join(f"unknown_{i}: 1\n" for i in range(200))
    lines = message(tmp_path, text).splitlines()
    assert len(lines) == 22
    assert lines[-1] == "... and 179 more problems."


@pytest.mark.parametrize("text", ["", "\n\n", "# only a comment\n", "---\n"])
def test_an_empty_file(tmp_path, text):
    assert "run.yaml is empty" in message(tmp_path, text)


@pytest.mark.parametrize("text", ["- 1\n", "hello\n", "5\n"])
def test_a_file_that_is_no_mapping(tmp_path, text):
    assert "line 1" in message(tmp_path, text)


def test_a_missing_file(tmp_path):
    with pytest.raises(RunFileError, match=r"nowhere.yaml does not exist"):
        read_run_file(tmp_path / "nowhere.yaml")


def test_a_directory(tmp_path):
    with pytest.raises(RunFileError, match="is a directory"):
        read_run_file(tmp_path)


def test_a_name_that_no_file_can_have():
    with pytest.raises(RunFileError, match="cannot be read"):
        read_run_file("a\0b.yaml")


@pytest.mark.parametrize(
    ("raw", "said"),
    [
        (b"system: x\nabout: \xff\xfe\n", "line 2: this is not UTF-8"),
        (b"\x89HDF\r\n\x1a\n", "is a database"),
        (b"system: \x00\n", "is not YAML text"),
        (b"a: 1\n" * 400_000, "more than"),
    ],
)
def test_a_file_that_is_no_text(tmp_path, raw, said):
    path = tmp_path / "run.yaml"
    path.write_bytes(raw)
    with pytest.raises(RunFileError, match=said) as caught:
        read_run_file(path)
    assert "run.yaml" in str(caught.value)


def test_a_system_without_named_equilibria(tmp_path):
    start = PLUGIN.index("starts=(")
    (tmp_path / "plain.py").write_text(PLUGIN[:start] + PLUGIN[PLUGIN.index("presets=") :])
    text = GOOD.replace("rotor.py", "plain.py").replace("balanced", "all")
    told = message(tmp_path, text)
    assert "line 4, key start.equilibrium" in told
    assert "names no equilibria" in told


def test_a_plugin_that_does_not_import(tmp_path):
    (tmp_path / "broken.py").write_text("x = 1\ny = x / 0\n")
    told = message(tmp_path, GOOD.replace("rotor.py", "broken.py"))
    assert "run.yaml, line 2, key system" in told
    assert "broken.py, line 2: ZeroDivisionError" in told


def test_a_plugin_whose_build_fails(tmp_path):
    (tmp_path / "broken.py").write_text(
        PLUGIN.replace("    return System(", "    raise KeyError('x')\n    System(")
    )
    told = message(tmp_path, GOOD.replace("rotor.py", "broken.py"))
    assert "run.yaml, line 2, key system" in told
    assert "KeyError" in told


LINES = [
    *GOOD.splitlines(),
    *(line for line, _ in APPENDED),
    "- 1",
    "}",
    "  x: &a [*a]",
    "a: !!map 3",
    "? {}",
]


@given(st.lists(st.sampled_from(LINES), max_size=12), st.text("{}[]:,&*!#-'\"\t 1ae.\n", max_size=6))
@settings(
    max_examples=150,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
def test_whatever_is_written_gives_a_run_or_a_sentence(tmp_path, lines, noise):
    path = write_run(tmp_path, "")
    said = ""
    try:
        read_run_text("\n".join(lines) + "\n" + noise, path)
    except RunFileError as error:  # any other exception fails the test
        said = error.sentence
    assert said == "" or "run.yaml" in said

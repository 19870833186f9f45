"""The file that `contwalk init` writes is valid as it stands, and so is each of its suggestions."""

from __future__ import annotations

import pytest
from run_file_cases import PLUGIN

import contwalk as cw
from contwalk.errors import RunFileError, SystemDefinitionError
from contwalk.system import Mode, Parameter, Start, State, Study, System, load_system
from contwalk.workflow.run_file.model import RunModel
from contwalk.workflow.run_file.reading import read_run_file, read_run_text
from contwalk.workflow.run_file.template import starting_file

BRUSSELATOR = """
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0] = p.A - (p.B + 1.0) * x[0] + x[0] * x[0] * x[1]
    dx[1] = p.B * x[0] - x[0] * x[0] * x[1]

SYSTEM = System(
    name="brusselator",
    states=(State("X", about="activator"), State("Y", about="inhibitor")),
    parameters=(Parameter("A", 1.0, bounds=(0.0, None), about="feed"), Parameter("B", 1.5, unit="1/s")),
    modes=(Mode("smooth", field),),
    reference="Prigogine & Lefever (1968)",
)
"""
FORCED = BRUSSELATOR.replace('reference="', 'period=lambda p: 2.0 / p.B, reference="')


def written(folder, plugin, name="machine.py"):
    """The system of a plugin and the run file written for it."""
    (folder / name).write_text(plugin)
    system = load_system(f"./{name}", None, folder)
    text = starting_file(system, f"./{name}")
    (folder / "run.yaml").write_text(text)
    return system, text


def test_a_family_with_named_equilibria(tmp_path):
    system, text = written(tmp_path, PLUGIN)
    run = read_run_file(tmp_path / "run.yaml")
    assert run.parameters == system.defaults()
    assert run.model == {"masses": 2, "suspension": "isotropic"}
    assert (run.starts[0].kind, run.starts[0].name) == ("equilibrium", "balanced")
    assert run.free == "stiffness"
    assert run.range == (1.0, 4.0)
    for words in ("N m s, [0, 1]", "of the shaft: all", "N m, [0, inf)"):
        assert words in text


def test_a_smooth_system_starts_at_zero(tmp_path):
    written(tmp_path, BRUSSELATOR)
    run = read_run_file(tmp_path / "run.yaml")
    assert run.starts[0].kind == "state"
    assert run.starts[0].state.tolist() == [0.0, 0.0]


def test_a_forced_system_is_simulated_first(tmp_path):
    written(tmp_path, FORCED)
    run = read_run_file(tmp_path / "run.yaml")
    assert (run.starts[0].kind, run.starts[0].until) == ("simulate", "settled")


@pytest.mark.parametrize("plugin", [PLUGIN, BRUSSELATOR, FORCED], ids=["family", "brusselator", "forced"])
def test_every_suggestion_is_valid_and_every_key_is_there(tmp_path, plugin):
    _, text = written(tmp_path, plugin)
    lines = text.splitlines()
    keys = RunModel.known_keys()
    suggested = [i for i, line in enumerate(lines) if line[:2] == "# " and line[2:].split(":")[0] in keys]
    for i in suggested:
        changed = [*lines[:i], lines[i][2:], *lines[i + 1 :]]
        if lines[i].startswith("# path"):
            changed = [line for line in changed if not line.startswith("continue")]
        read_run_text("\n".join(changed), tmp_path / "run.yaml")
    present = {line.removeprefix("# ").split(":")[0] for line in lines}
    assert set(keys) - present <= {"model"}


def test_names_that_yaml_would_take_for_something_else(tmp_path):
    plugin = BRUSSELATOR.replace('"A"', '"null"').replace("p.A", "p.B")
    (tmp_path / "my machine #1.py").write_text(plugin)
    _, text = written(tmp_path, plugin, "my machine #1.py")
    run = read_run_text(text, tmp_path / "run.yaml")
    assert run.free == "null"
    assert run.system_reference == "./my machine #1.py"


def smooth(t, x, p, dx):
    dx[0] = -x[0]


def system_of(*parameters, starts=()):
    return System("s", states=State("x"), parameters=parameters, modes=Mode("m", smooth), starts=starts)


def test_a_parameter_without_room_is_passed_over():
    text = starting_file(system_of(Parameter("a", 1.0, bounds=(1.0, 1.0)), Parameter("b", 0.0)), "s")
    assert "parameter: b, range: [-1.0, 1.0]" in text


def test_the_range_stays_within_the_bounds():
    text = starting_file(system_of(Parameter("a", -0.7, bounds=(-0.8, None))), "s")
    assert "range: [-0.8, -0.35]" in text


def test_an_equilibrium_that_does_not_exist_is_passed_over():
    starts = (Start("no", lambda p: []), Start("yes", lambda p: [[0.0]]))
    text = starting_file(system_of(Parameter("a", 1.0), starts=starts), "s")
    assert 'start: {equilibrium: "yes"}' in text


def test_nothing_to_continue():
    with pytest.raises(RunFileError, match="no parameter that could be continued"):
        starting_file(system_of(), "s")


# -- the systems that come along ---------------------------------------------------------------------------


def run_of(system, tmp_path):
    """The diagram of the run file that `init` writes, and the labels along its first branch."""
    text = starting_file(load_system(system), system)
    assert "depth: 5" in text
    (tmp_path / "run.yaml").write_text(text.replace("depth: 5", "depth: 1"))  # some seconds instead of many
    done = cw.run(cw.read_run_file(tmp_path / "run.yaml", output=tmp_path / "run.h5"), figures=False)
    return done.branches, [p.label for p in done.branches[0].special_points if p.label != "EP"]


@pytest.mark.parametrize(
    ("system", "labels"),
    [
        ("autobalancer", {"BP"}),
        ("bouncing_ball", {"LP", "PD"}),
        ("impact_oscillator", {"GR"}),
    ],
)
def test_along_the_parameter_something_happens(system, labels, tmp_path):
    branches, found = run_of(system, tmp_path)
    assert labels <= set(found)
    assert len(branches) > 1  # what leaves there is followed
    assert not any(branch.outcome.status == "failed" for branch in branches)


def test_the_rimless_wheel_stops_where_it_no_longer_gets_over_its_spokes(tmp_path):
    (branch,), _ = run_of("rimless_wheel", tmp_path)
    assert "homoclinic" in branch.outcome.reason
    assert branch["gamma"].min() < 0.07


@pytest.mark.parametrize("system", ["planar_walker", "walker3d"])
def test_studies_of_walkers_are_valid_run_files(system, tmp_path):
    (tmp_path / "run.yaml").write_text(starting_file(load_system(system), system))
    read = read_run_file(tmp_path / "run.yaml")
    assert read.free == "alpha"
    assert read.range[0] < read.parameters["alpha"] < read.range[1]


def test_a_study_that_names_no_parameter_is_refused():
    with pytest.raises(SystemDefinitionError, match="'b' is not a parameter"):
        System("s", State("x"), Parameter("a", 1.0), Mode("m", smooth), study=Study("b", (0.0, 1.0)))
    with pytest.raises(SystemDefinitionError, match="lower end first"):
        Study("a", (1.0, 0.0))


def test_without_a_start_of_its_own_a_study_takes_the_one_that_is_found():
    study = Study("a", (0.5, 3.0), parameters={"a": 2.0}, events={"GR": "ignore"})
    text = starting_file(System("s", State("x"), Parameter("a", 1.0), Mode("m", smooth), study=study), "s")
    assert "continue: {parameter: a, range: [0.5, 3.0]" in text
    assert "  a: 2.0" in text
    assert "start: {state: {x: 0.0}}" in text
    assert "\nevents: {GR: ignore}" in text


HOPS = """
from contwalk.system import Mode, Parameter, State, System, Transition

def fly(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.g

SYSTEM = System(
    name="hops",
    states=(State("y", unit="m", about="height"), State("v", unit="m/s", about="velocity")),
    parameters=(Parameter("g", 9.81, unit="m/s^2", about="gravity"),),
    modes=(Mode("up", fly), Mode("down", fly)),
    transitions=(
        Transition("apex", "up", "down", lambda t, x, p: x[1]),
        Transition("high", "up", "down", lambda t, x, p: x[0] - 0.5, role="watched"),
        Transition("low", "up", "down", lambda t, x, p: 0.1 - x[0], direction="rising"),
        Transition("lands", "down", "up", lambda t, x, p: x[0], reset=lambda t, x, p, y: fly(t, x, p, y)),
    ),
    reference="none",
)
"""


def test_a_machine_starts_before_the_guards_of_its_first_mode(tmp_path):
    """At zero one guard is on zero: a motion from there would meet no event."""
    _, text = written(tmp_path, HOPS)
    run = read_run_file(tmp_path / "run.yaml")
    y, v = run.starts[0].state
    assert v > 0.0
    assert y > 0.1
    assert "# a guess" in text


def test_states_that_the_first_mode_lacks_are_not_written(tmp_path):
    _, text = written(tmp_path, TABLE)
    assert "start: {simulate: {state: {height: " in text
    assert "push" not in text.partition("start:")[2].partition("\n")[0]
    read_run_file(tmp_path / "run.yaml")


TABLE = """
from contwalk.system import Mode, Parameter, State, System, Transition

def flying(t, x, p, dx):
    dx[0], dx[1] = x[1], -1.0

def touching(t, x, p, dx):
    dx[2] = -p.a * x[2] + 1.0

def lands(t, x, p, x_plus):
    x_plus[2] = -0.5

def leaves(t, x, p, x_plus):
    x_plus[0], x_plus[1] = 0.0, 1.0

SYSTEM = System(
    name="table",
    states=(State("height"), State("speed"), State("push")),
    parameters=(Parameter("a", 1.0),),
    modes=(Mode("flying", flying, states=("height", "speed")), Mode("touching", touching, states=("push",))),
    transitions=(
        Transition("lands", "flying", "touching", lambda t, x, p: x[0], reset=lands),
        Transition("leaves", "touching", "flying", lambda t, x, p: x[2], direction="rising", reset=leaves),
    ),
)
"""

"""Wrong machines with events: what is cheap to see is refused when loading, the check tells the rest."""

from __future__ import annotations

import warnings

import pytest
from checked_plugins import line_of
from hostile_machines import SOUND, WRONG

from contwalk.cli.entry import run
from contwalk.errors import SystemDefinitionError
from contwalk.plugin_check.at_load import load_system
from contwalk.plugin_check.system import check_reference

CONTINUE = """\
contwalk: 1
system: ./wrong.py
start: {{simulate: {{state: {state}, until: settled}}}}
continue: {{parameter: r, range: [0.7, 2.5], max_points: 3}}
diagram: none
output: wrong.h5
"""
SIMULATE = """\
contwalk: 1
system: ./wrong.py
start: {{state: {state}}}
simulate: {{until: 8.0}}
output: motion.h5
"""
RELAY_STATE = "{x: 0.7, y: 0.6}"

# Units and meanings are not what is looked at here.
WORDS = ("No unit is given", "No meaning is given", "It has no reference")


@pytest.fixture
def wrong(tmp_path):
    """Writes a plugin, and gives its path."""

    def written(source):
        path = tmp_path / "wrong.py"
        path.write_text(source, encoding="utf-8")
        return path

    return written


def findings(path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = check_reference(str(path))
    return [each for each in found if not each.sentence.startswith(WORDS)]


@pytest.mark.parametrize("name", SOUND)
def test_sound_machines_pass(name, wrong):
    path = wrong(SOUND[name])
    assert [each for each in findings(path) if each.level != "ok"] == []
    assert load_system(path).name == name


@pytest.mark.drawn(64)
@pytest.mark.parametrize("name", WRONG)
def test_wrong_machine_is_told_with_its_line(name, wrong):
    case = WRONG[name]
    path, lines = wrong(case.source), case.source.splitlines()
    found = [each for each in findings(path) if each.level == case.level and case.said in each.sentence]
    assert found, [each.sentence for each in findings(path) if each.level != "ok"]
    assert found[0].file == str(path)
    assert case.line in lines[found[0].line - 1], lines[found[0].line - 1]
    if not case.refused:
        assert load_system(path)
        return
    with pytest.raises(SystemDefinitionError) as refused:
        load_system(path)
    assert f"{path}, line {found[0].line}: " in refused.value.sentence
    assert case.said in str(refused.value)


def told_by_runs(folder, source, state, capsys):
    """Exit codes of `continue` and `simulate`, and what they say."""
    (folder / "wrong.py").write_text(source, encoding="utf-8")
    (folder / "run.yaml").write_text(CONTINUE.format(state=state), encoding="utf-8")
    (folder / "motion.yaml").write_text(SIMULATE.format(state=state), encoding="utf-8")
    told = []
    for command in (("continue", "run.yaml"), ("simulate", "motion.yaml")):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            code = run((*command, "--no-figures", "--force"))
        told.append((code, " ".join("".join(capsys.readouterr()).split())))
    return told


@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("guard of time without a period", 'Transition("kick"'),
        ("reset of time without a period", 'Transition("cool"'),
    ],
)
def test_clocks_without_a_period_are_refused_before_a_search(name, line, tmp_path, monkeypatch, capsys):
    """A single motion may depend on time in any way; an orbit of it is not looked for."""
    monkeypatch.chdir(tmp_path)
    source = WRONG[name].source
    (code, said), (simulated, _) = told_by_runs(tmp_path, source, RELAY_STATE, capsys)
    assert (code, simulated) == (2, 0)
    assert f"wrong.py, line {line_of(source, line)}: the " in said
    assert not (tmp_path / "wrong.h5").exists()


def test_runs_tell_of_a_stop_with_the_wrong_sign(tmp_path, monkeypatch, capsys):
    """The mass goes on through both stops, with 0.6 of its speed: a machine, but hardly the one meant."""
    monkeypatch.chdir(tmp_path)
    source = WRONG["reset of the wrong sign"].source
    line = line_of(source, "def rebound")
    for code, said in told_by_runs(tmp_path, source, "{x: 0.0, y: 0.5}", capsys):
        assert code == 0
        assert (
            f"its guard goes on through zero, more slowly than it came ({tmp_path}/wrong.py, line {line})"
            in said
        )


def test_runs_do_not_tell_of_a_stop_or_a_push(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name, state in (("stops", "{x: 0.0, y: 0.5}"), ("clock", "{x: 0.0, y: 1.5}")):
        for code, said in told_by_runs(tmp_path, SOUND[name], state, capsys):
            assert code == 0
            assert "goes on through zero" not in said


@pytest.mark.parametrize(
    "name", ["relay of one threshold", "relay without hysteresis", "transitions for ever"]
)
def test_transitions_without_any_time_between_them_are_no_orbit(name, tmp_path, monkeypatch, capsys):
    """They come back at once; a recurrence of no duration was taken for one of a conserving family."""
    monkeypatch.chdir(tmp_path)
    for code, said in told_by_runs(tmp_path, WRONG[name].source, RELAY_STATE, capsys):
        assert code == 1
        assert "More than 100 transitions follow each other at t = 0.22569439" in said
        assert "conserve" not in said


@pytest.mark.parametrize("name", ["guard jumps", "guard with a pole"])
def test_guards_that_jump_are_refused_with_their_line(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    source = WRONG[name].source
    (code, said), _ = told_by_runs(tmp_path, source, "{x: 0.1, y: 0.2}", capsys)
    assert code == 1
    line = line_of(source, "def gap")
    assert f"wrong.py, line {line}: the guard of transition 'hit' jumps through zero" in said


@pytest.mark.parametrize(
    ("name", "line"), [("reset is infinite", "def touch"), ("guard without a value beyond", "def gap")]
)
def test_constants_that_are_not_finite_are_told_with_their_line(name, line, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    source = WRONG[name].source
    for code, said in told_by_runs(tmp_path, source, "{x: 0.1, y: 0.2}", capsys):
        assert code == 1
        assert f"wrong.py, line {line_of(source, line)}: the result is not finite" in said

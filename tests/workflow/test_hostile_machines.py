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
start: {simulate: {state: {x: 0.7, y: 0.6}, until: settled}}
continue: {parameter: r, range: [1.5, 2.5], max_points: 4}
diagram: none
output: wrong.h5
"""

# Units and meanings are not what is looked at here.
WORDS = ("No unit is given", "Its meaning is missing", "It has no reference")


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


def test_clocks_without_a_period_are_refused_before_a_search(tmp_path, monkeypatch, capsys):
    """A single motion may depend on time in any way; an orbit of it is not looked for."""
    for name, line in (
        ("guard of time without a period", 'Transition("kick"'),
        ("reset of time without a period", 'Transition("cool"'),
    ):
        source = WRONG[name].source
        monkeypatch.chdir(tmp_path)
        (tmp_path / "wrong.py").write_text(source, encoding="utf-8")
        (tmp_path / "run.yaml").write_text(CONTINUE, encoding="utf-8")
        assert run(("continue", "run.yaml", "--no-figures")) == 2
        assert f"wrong.py, line {line_of(source, line)}: the " in capsys.readouterr().err
        assert not (tmp_path / "wrong.h5").exists()

"""Wrong machines with events: what is cheap to see is refused when loading, the check tells the rest."""

from __future__ import annotations

import warnings

import pytest
from hostile_machines import SOUND, WRONG

from contwalk.errors import SystemDefinitionError
from contwalk.plugin_check.at_load import load_system
from contwalk.plugin_check.system import check_reference

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

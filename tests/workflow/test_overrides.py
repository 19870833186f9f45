"""`--set KEY=VALUE`: what it changes, and how its mistakes are told."""

from __future__ import annotations

import pytest
from run_file_cases import GOOD, message, read


def test_values_are_put_in(tmp_path):
    run = read(tmp_path, GOOD, "parameters.damping=0.9", "continue.range=[1,6]", "accuracy = 1e-9")
    assert run.parameters["damping"] == 0.9
    assert run.range == (1.0, 6.0)
    assert run.accuracy == 1e-9
    assert run.overrides == ("parameters.damping=0.9", "continue.range=[1,6]", "accuracy = 1e-9")
    assert run.text == GOOD


def test_missing_keys_on_the_way_are_created(tmp_path):
    run = read(tmp_path, GOOD + "diagram:\n", "diagram.depth=2", "mark.swing=[1, extremum]")
    assert run.depth == 2
    assert run.marks[0].extremum


def test_items_of_lists_are_reached_by_position(tmp_path):
    assert read(tmp_path, GOOD, "continue.range.1=7").range == (1.0, 7.0)


def test_later_values_win(tmp_path):
    assert read(tmp_path, GOOD, "accuracy=1e-6", "accuracy=1e-5").accuracy == 1e-5


def test_null_takes_a_key_away(tmp_path):
    run = read(tmp_path, GOOD, "continue=null", "path={from: heavy, to: light}")
    assert run.free == "path"


def test_values_with_equals_signs_and_commas(tmp_path):
    run = read(tmp_path, GOOD, "output=a=b.h5")
    assert str(run.output) == "a=b.h5"


@pytest.mark.parametrize(
    ("override", "said"),
    [
        ("paramters.damping=1", ["key paramters", "Did you mean 'parameters'?"]),
        ("parameters.dampin=1", ["key parameters.dampin", "Did you mean 'damping'?"]),
        ("parameters.damping=2", ["key parameters.damping", "outside the bounds", "[0, 1]"]),
        ("parameters.damping=x", ["key parameters.damping", "the text 'x'"]),
        ("parameters.damping=", ["key parameters.damping", "is empty"]),
        ("continue.range=[6,1]", ["key continue.range", "wrong way round"]),
        ("continue.range=[1,", ["not valid YAML"]),
        ("mark={a: 1, a: 2}", ["given twice"]),
        ("mark=!!python/object:x {}", ["tag"]),
        ("diagram={depth: -1}", ["key diagram.depth", "from 0 up"]),
        ("continue.range.2=1", ["a list of 2", "0 to 1"]),
        ("continue.range.first=1", ["a list of 2", "0 to 1"]),
        ("system.name=x", ["'system' is the text './rotor.py'", "no key 'name'"]),
        ("accuracy", ["not KEY=VALUE"]),
        ("=3", ["not KEY=VALUE"]),
        ("a..b=3", ["not KEY=VALUE"]),
        ("continue. range=3", ["not KEY=VALUE"]),
        ("contwalk=2", ["key contwalk", "newer"]),
    ],
)
def test_mistakes_name_the_override_instead_of_a_line(tmp_path, override, said):
    told = message(tmp_path, GOOD, override)
    assert f"--set {override}" in told
    assert ", line " not in told.splitlines()[0]
    for words in said:
        assert words in told

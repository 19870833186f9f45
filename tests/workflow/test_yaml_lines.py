"""YAML read into plain data: lines, numbers, and what is refused."""

from __future__ import annotations

import pytest

from contwalk.errors import RunFileError
from contwalk.workflow.run_file.document import Document
from contwalk.workflow.run_file.yaml_lines import parse_yaml

BOMB = "a: &a [x, x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{name}: &{name} [{', '.join(10 * ['*' + before])}]\n"
    for before, name in zip("abcdefgh", "bcdefghi", strict=True)
)


def test_values_as_yaml_1_2_reads_them():
    text = "{a: 1e-8, b: .5, c: no, d: on, e: true, f: null, g: 0x10, h: 017, i: -3, j: '1', k: 2020-01-01}"
    data, _ = parse_yaml(text, "x.yaml")
    assert data == {
        "a": 1e-8,
        "b": 0.5,
        "c": "no",
        "d": "on",
        "e": True,
        "f": None,
        "g": 16,
        "h": 17,
        "i": -3,
        "j": "1",
        "k": "2020-01-01",
    }


def test_keys_stay_as_they_are_written():
    data, _ = parse_yaml("{null: 1, true: 2, 3: 4, e: 5, y: 6}", "x.yaml")
    assert list(data) == ["null", "true", "3", "e", "y"]


def test_lines_of_nested_keys():
    _, lines = parse_yaml("a:\n  b: 1\n  c:\n  - 2\n  - d: 3\n", "x.yaml")
    assert lines == {
        ("a",): 1,
        ("a", "b"): 2,
        ("a", "c"): 3,
        ("a", "c", 0): 4,
        ("a", "c", 1): 5,
        ("a", "c", 1, "d"): 5,
    }


def test_where_leaves_out_what_the_data_does_not_have():
    data, lines = parse_yaml("a:\n  b: 1\n", "x.yaml")
    document = Document("x.yaml", data, lines)
    assert document.where(("a", 0, "(list)", "b", 0)) == "x.yaml, line 2, key a.b"
    assert document.where(("a", "missing")) == "x.yaml, line 1, key a.missing"
    assert document.where(("missing",)) == "x.yaml, key missing"


def test_aliases_are_unfolded():
    data, _ = parse_yaml("a: &x [1, 2]\nb: *x\nc: &x 3\nd: *x\n", "x.yaml")
    assert data == {"a": [1, 2], "b": [1, 2], "c": 3, "d": 3}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a: 1\nb: 2\na: 3\n", "line 3, key a: the key is given twice (first in line 1)"),
        ("a:\n  b: 1\n  b: 2\n", "line 3, key a.b: the key is given twice"),
        ("a: 1\nb: [1, 2\nc: 3\n", "line 3: not valid YAML"),
        ("a: 'x\n", "not valid YAML"),
        ("a: b: c\n", "line 1: not valid YAML"),
        ("a:\n\tb: 1\n", "line 2: a tab is used for indentation"),
        ("\ta: 1\n", "line 1: a tab is used for indentation"),
        ("a: 1\n---\nb: 2\n", "line 2: a second document"),
        ("a: *x\n", "line 1: not valid YAML"),
        ("b: 1\na: !!python/object/apply:os.system ['true']\n", "line 2, key a: the tag !!python/object"),
        ("a: !!python/name:os.system\n", "line 1, key a: the tag !!python/name:os.system is not allowed"),
        ("a: !mine 3\n", "line 1, key a: the tag !mine is not allowed"),
        ("!!python/object:x {}\n", "line 1: the tag"),
        ("a: !!set {x}\n", "line 1, key a: the tag !!set"),
        ("a: !!binary aGk=\n", "line 1, key a: the tag !!binary"),
        ("a: !!map 3\n", "line 1, key a: the tag !!map does not fit"),
        ("a: !!float [1]\n", "line 1, key a: the tag !!float does not fit"),
        ("? [1, 2]\n: 3\n", "line 1: a key is a list"),
        ("a: &x {b: 1}\nc: {<<: *x}\n", "line 2, key c: the merge key"),
        ("a: &x [*x]\n", "key a.0: an alias refers to what contains it"),
        (BOMB, "unfolds to more than 20000 values"),
        ("a: " + 30 * "[" + 30 * "]" + "\n", "nested too deeply"),
        ("a: " + 5000 * "[" + "\n", "nested too deeply"),
        ("a: \x07\n", "is not YAML text"),
    ],
)
def test_what_is_refused(text, said):
    with pytest.raises(RunFileError) as caught:
        parse_yaml(text, "x.yaml")
    assert str(caught.value).startswith("x.yaml")
    assert said in str(caught.value)
    assert caught.value.remedy
    assert "\n" not in str(caught.value)

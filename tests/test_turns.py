"""Costly tests take turns: of five draws each tries about a fifth of what they cost."""

from __future__ import annotations

from pathlib import Path

import pytest
from turns import DRAWS, EVERYTHING, HERE, leave_bits_out, listed, table, turn_of, wait_for_their_turn

from tools.durations import COSTLY, TURNS, costly


class Item:
    """What is asked of a test."""

    def __init__(self, nodeid: str) -> None:
        self.nodeid, self.marks = nodeid, list[str]()

    def add_marker(self, mark: pytest.MarkDecorator) -> None:
        self.marks.append(mark.name)


KNOWN = {
    "tests/a.py::test_one": 0,
    "tests/a.py::TestIt::test_two": 1,
    "tests/b.py::test_three": 2,
    "tests/b.py::test_four": 3,
    "tests/b.py::test_five": 4,
}


def waiting(seed: str) -> set[str]:
    items = [Item(node) for node in [*KNOWN, "tests/a.py::test_one[x-1]", "tests/b.py::test_cheap"]]
    wait_for_their_turn(items, seed, KNOWN)
    assert all(item.marks in ([], ["long"]) for item in items)
    return {item.nodeid for item in items if item.marks}


def test_of_five_draws_each_tries_what_the_others_leave():
    first = {"tests/a.py::test_one", "tests/a.py::test_one[x-1]"}
    second, third = {"tests/a.py::TestIt::test_two"}, {"tests/b.py::test_three"}
    every = [first, second, third, {"tests/b.py::test_four"}, {"tests/b.py::test_five"}]
    for draw, tried in enumerate(every, start=1):
        assert waiting(str(draw)) == set().union(*every) - tried
    assert waiting("6") == waiting("1")
    assert waiting(EVERYTHING) == set()
    assert turn_of("any word") in range(DRAWS)


def test_tests_of_last_bits_are_left_out_under_noise_alone():
    items = [Item(node) for node in ("tests/a.py::test_one[x-1]", "tests/a.py::test_other")]
    leave_bits_out(items, "", ["tests/a.py::test_one"])
    assert not any(item.marks for item in items)
    leave_bits_out(items, "1", ["tests/a.py::test_one"])
    assert [item.marks for item in items] == [["skip"], []]


@pytest.mark.parametrize("name", ["turns.txt", "bits.txt"])
def test_the_lists_name_tests_that_exist_once_each(name):
    named = listed(HERE / name)
    assert len(set(named)) == len(named)
    for node in named:
        path, _, test = node.partition("::")
        text = (HERE.parent / path).read_text(encoding="utf-8")
        assert all(f"class {part}" in text or f"def {part}(" in text for part in test.split("::"))


def test_what_takes_turns_is_nothing_that_always_runs():
    always = tuple(listed(HERE / "quick.txt"))
    assert [node for node in table() if node.startswith(always)] == []


def test_the_list_is_written_from_reports(tmp_path: Path):
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "test_it.py").write_text("", encoding="utf-8")
    cases = [("tests.test_it", "test_a[1]", 0.4), ("tests.test_it", "test_a[2]", 0.4)]
    cases += [("tests.test_it.TestIt", "test_b", 2.0), ("tests.test_it", "test_c", 0.5 * COSTLY)]
    told = "".join(f'<testcase classname="{of}" name="{name}" time="{time}"/>' for of, name, time in cases)
    report = tmp_path / "report.xml"
    report.write_text(f"<testsuites><testsuite>{told}</testsuite></testsuites>", encoding="utf-8")
    expected = f"{TURNS}tests/test_it.py::TestIt::test_b\ntests/test_it.py::test_a\n"
    assert costly([report], tmp_path) == expected
    # What another report names already stays where it is.
    assert costly([report, report], tmp_path) == expected

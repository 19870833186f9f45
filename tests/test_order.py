"""Files of tests are given out longest first, and those that are new by the number of their tests."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest
from order import DURATIONS, expected, longest_first, table
from turns import listed

from tools.durations import written

ROOT = Path(__file__).parents[1]


def test_the_table_names_files_that_exist_once_each_longest_first():
    lines = DURATIONS.read_text(encoding="utf-8").splitlines()
    assert len(table()) == len(lines)
    assert [name for name in table() if not (ROOT / name).is_file()] == []
    assert all(before >= after for before, after in pairwise(table().values()))


@pytest.mark.parametrize(("slow", "others", "seconds"), [(3, 0, 15.0), (0, 40, 4.0), (1, 10, 6.0)])
def test_what_is_not_in_the_table_is_expected_by_its_tests(slow, others, seconds):
    assert expected("tests/test_new.py", slow, others, {}) == pytest.approx(seconds, rel=1e-15)  # a rounding
    assert expected("tests/test_new.py", slow, others, {"tests/test_new.py": 2.0}) == 2.0


def test_the_quick_list_names_tests_that_exist_of_each_folder():
    named = [line.partition("::")[::2] for line in listed(ROOT / "tests" / "quick.txt")]
    assert len(set(named)) == len(named)
    for path, test in named:
        place = ROOT / path
        assert place.exists()
        assert not test or f"def {test.split('::')[-1].partition('[')[0]}(" in place.read_text(
            encoding="utf-8"
        )
    folders = {
        path.name for path in (ROOT / "tests").iterdir() if path.is_dir() and any(path.rglob("test_*.py"))
    }
    assert {path.split("/")[1] for path, _ in named} >= folders


def test_tests_of_a_file_stay_together_and_in_their_order():
    tests = [("a", False), ("b", True), ("a", False), ("c", False), ("b", False), ("c", False), ("c", False)]
    order = longest_first([name for name, _ in tests], [slow for _, slow in tests], {"a": 100.0})
    assert [tests[k][0] for k in order] == ["a", "a", "b", "b", "c", "c", "c"]
    assert order == [0, 2, 1, 4, 3, 5, 6]


def test_the_table_is_written_from_reports(tmp_path):
    (tmp_path / "tests").mkdir()
    for name in ("one", "two", "short"):
        (tmp_path / "tests" / f"test_{name}.py").write_text("", encoding="utf-8")
    cases = [("one", 3.0), ("one.TestIt", 1.0), ("two", 60.0), ("short", 1.0), ("gone", 9.0)]
    for k, kept in enumerate((cases[:2], cases[2:])):
        told = "".join(f'<testcase classname="tests.test_{name}" time="{time}"/>' for name, time in kept)
        (tmp_path / f"{k}.xml").write_text(f"<testsuites><testsuite>{told}</testsuite></testsuites>")
    reports = [tmp_path / "0.xml", tmp_path / "1.xml"]
    assert written(reports, tmp_path) == "60 tests/test_two.py\n4 tests/test_one.py\n"

"""Tables that spreadsheets read, and do not compute."""

from __future__ import annotations

import csv

import pytest

from contwalk.storage.csv_files import write_csv

FORMULAS = ("=1+1", '=HYPERLINK("http://x")', "+cmd|' /C calc'!A0", "-2+3", "@SUM(A1)", "\t=1")
OTHERS = ("HB", "c = -1", "-1.5", "-1.5 2.0 -inf", "1e-8", "", "ω", "a,b", 'a "b"', "two\nlines", 7, None)


def read(path):
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.reader(file))


@pytest.mark.parametrize("text", FORMULAS)
def test_no_cell_and_no_head_is_a_formula(tmp_path, text):
    rows = read(write_csv(tmp_path / "x.csv", [text, "y"], [[text, -0.1], [1.0, text]]))
    assert rows == [[f"'{text}", "y"], [f"'{text}", "-0.1"], ["1.0", f"'{text}"]]


def test_control_characters_are_told_by_their_codes(tmp_path):
    path = write_csv(tmp_path / "x.csv", ["a\x1b[31mb"], [["\r=1"], ["\ud800"]])
    assert read(path) == [["a\\x1b[31mb"], ["'\\r=1"], ["\\ud800"]]


def test_everything_else_is_as_it_was(tmp_path):
    (_, row, truth) = read(write_csv(tmp_path / "x.csv", ["x"], [OTHERS, [True, False, 0.1 + 0.2, -1e-300]]))
    assert row == ["" if value is None else str(value) for value in OTHERS]
    assert truth == ["true", "false", "0.30000000000000004", "-1e-300"]

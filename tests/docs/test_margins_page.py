"""The how-to page on margins: its commands from the page alone, and what they find."""

from __future__ import annotations

import csv
import math

import pytest
from code_blocks import blocks, commands, run_command

PAGE = "docs/howto/margins.md"


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    """The page's commands run in their order; the borders that they write, by state and sign."""
    folder = tmp_path_factory.mktemp("margins")
    (folder / "beside_a_wall.py").write_text(blocks(PAGE, "python")[0], encoding="utf-8")
    (folder / "wall.yaml").write_text(blocks(PAGE, "yaml")[0], encoding="utf-8")
    for line in commands(PAGE):
        run_command(line, folder)
    with (folder / "wall_margins.csv").open(newline="", encoding="utf-8") as file:
        return {(row["state"], int(row["sign"])): float(row["border"]) for row in csv.DictReader(file)}


def test_the_borders_are_those_of_the_closed_form(table):
    back = math.exp(0.1 * math.pi / math.sqrt(1.0 - 0.1**2))
    assert table["x", 1] == pytest.approx(1.0, rel=1e-6)
    assert table["x", -1] == pytest.approx(back, rel=1e-6)
    assert f"{back:.6f}" == "1.371276"

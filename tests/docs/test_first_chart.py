"""The tutorial on charts, block by block from the page alone."""

from __future__ import annotations

import json

import pytest
from code_blocks import blocks, commands, run_command, run_python

PAGE = "docs/tutorials/first_chart.md"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The page's files, and its commands run in their order."""
    folder = tmp_path_factory.mktemp("first_chart")
    plugin, _ = blocks(PAGE, "python")
    one, two = blocks(PAGE, "yaml")
    for name, text in (("glycolysis.py", plugin), ("one.yaml", one), ("two.yaml", two)):
        (folder / name).write_text(text, encoding="utf-8")
    for line in commands(PAGE):
        run_command(line, folder)
    return folder


def test_the_hopf_points_are_where_the_page_says(folder):
    shown = json.loads(run_command("contwalk show one.h5 --json", folder))
    (branch,) = shown["branches"]
    found = [p["parameters"]["b"] for p in branch["special_points"] if p["label"] == "HB"]
    assert found == pytest.approx([0.12**0.5, 0.72**0.5], rel=1e-14)
    assert [f"{value:.4f}" for value in found] == ["0.3464", "0.8485"]


def test_both_lie_on_one_curve_that_turns_where_the_page_says(folder):
    shown = json.loads(run_command("contwalk show two.h5 --json --points", folder))
    curves = [branch for branch in shown["branches"] if branch["problem"] == "locus"]
    assert [curve["of"] for curve in curves].count("HB") == 1
    assert {curve["of"] for curve in curves} == {"HB", "UZ"}
    assert any("b1/HB2 lies on branch" in note["text"] for note in shown["notes"])
    hopf = next(curve for curve in curves if curve["of"] == "HB")
    assert max(row["free"][1] for row in hopf["points"]) == pytest.approx(0.125, abs=1e-3)


def test_the_curve_is_what_a_pencil_finds(folder):
    _, script = blocks(PAGE, "python")
    assert float(run_python(script, folder)) < 1e-14


def test_the_figures_are_drawn(folder):
    for name in ("two_locus.png", "chart.png"):
        assert (folder / name).read_bytes().startswith(b"\x89PNG")

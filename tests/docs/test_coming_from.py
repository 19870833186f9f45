"""docs/coming_from/ and docs/start.md: what stands under "Here" runs, and finds what the page says."""

from __future__ import annotations

import json
import re

import pytest
from code_blocks import ROOT, blocks, commands, run_command, run_python

FOLDER = "docs/coming_from"
PAGES = {page.removesuffix(".md"): f"{FOLDER}/{page}" for page in ("auto.md", "matcont.md", "xppaut.md")}
IN_PYTHON = [f"{FOLDER}/{page}" for page in ("bifurcationkit.md", "coco.md", "pydstool.md", "bifpy.md")]


def computed(page, folder):
    """All files of a page, and its commands run in their order."""
    for text in blocks(page, "yaml"):
        name = re.search(r"^output: (\w+)\.h5$", text, re.MULTILINE)
        (folder / f"{name.group(1)}.yaml").write_text(text, encoding="utf-8")
    for line in commands(page):
        run_command(line, folder)


def points(database, folder):
    shown = json.loads(run_command(f"contwalk show {database} --json", folder))
    return [(b["problem"], point) for b in shown["branches"] for point in b["special_points"]]


def values(database, folder, label, parameter, problem="equilibrium"):
    return [
        point["parameters"][parameter]
        for where, point in points(database, folder)
        if (point["label"], where) == (label, problem)
    ]


def test_from_auto(tmp_path):
    computed(PAGES["auto"], tmp_path)
    assert values("brusselator.h5", tmp_path, "HB", "B") == [2.0]
    assert (tmp_path / "brusselator.html").stat().st_size > 10_000
    text = (ROOT / PAGES["auto"]).read_text(encoding="utf-8")
    # verified values: tests/peers/problems/ab.py
    (hopf,), (fold,) = (
        values("ab.h5", tmp_path, label, "p1", problem)
        for label, problem in (("HB", "equilibrium"), ("LP", "periodic_orbit"))
    )
    assert f"p1 = {hopf:.7f}" in text
    assert f"p1 = {fold:.7f}" in text


def test_from_matcont(tmp_path):
    computed(PAGES["matcont"], tmp_path)
    text = (ROOT / PAGES["matcont"]).read_text(encoding="utf-8")
    found = [value for label in ("LP", "HB") for value in values("bykov.h5", tmp_path, label, "q2")]
    assert len(found) == 4
    assert [f"{value:.6f}" for value in found if f"{value:.6f}" not in text] == []
    hopf = [point for _, point in points("bykov.h5", tmp_path) if point["label"] == "HB"]
    assert {point["criticality"] for point in hopf} == {"subcritical"}


def test_from_xppaut(tmp_path):
    (file,) = (block for block in blocks(PAGES["xppaut"], "text") if block.startswith("# Brusselator"))
    (tmp_path / "brusselator.ode").write_text(file, encoding="utf-8")
    computed(PAGES["xppaut"], tmp_path)
    assert values("brusselator.h5", tmp_path, "HB", "b") == [2.0]


@pytest.mark.parametrize("page", IN_PYTHON)
def test_in_python(page, tmp_path):
    """The program is one on all of these pages, and is run for the first."""
    (program,) = blocks(page, "python")
    assert (program,) == tuple(blocks(IN_PYTHON[0], "python"))
    if page == IN_PYTHON[0]:
        assert run_python(program, tmp_path).split() == ["2.0", "supercritical"]
        assert (tmp_path / "brusselator.png").exists()


def test_the_first_five_minutes(tmp_path):
    page = "docs/start.md"
    (text,) = blocks(page, "text")
    (tmp_path / "predators.txt").write_text(text, encoding="utf-8")
    for line in commands(page):
        run_command(line, tmp_path)
    assert (tmp_path / "autobalancer_load.html").exists()
    assert (tmp_path / "predators.html").exists()
    assert len(values("predators.h5", tmp_path, "HB", "K")) == 1

"""The tutorial and the plugin page: every block runs as written and gives what the text says."""

from __future__ import annotations

import json
import re

import pytest
from code_blocks import ROOT, blocks, commands, run_command, run_python

import contwalk as cw
from contwalk.system import load_system

TUTORIAL = "docs/tutorials/first_plugin.md"
PLUGINS = "docs/reference/plugin.md"
# Closed form: T = k X with k = B / (1 + beta) and Da = X / (1 - X) exp(-k X); folds where X (1 - X) = 1 / k,
# the Hopf point where 1 / (1 - X) + 1 + beta = B X. Evaluated with 40 digits.
POINTS = {"LP1": 0.10573897827165065101, "LP2": 0.088931846185772802594, "HB1": 0.13090004482004332464}


@pytest.fixture(scope="module")
def tutorial(tmp_path_factory):
    """The tutorial's directory after all its commands, and their outputs."""
    where = tmp_path_factory.mktemp("tutorial")
    (where / "stirred_tank.py").write_text(blocks(TUTORIAL, "python")[0], encoding="utf-8")
    (where / "ignition.yaml").write_text(blocks(TUTORIAL, "yaml")[0], encoding="utf-8")
    return where, {line: run_command(line, where) for line in commands(TUTORIAL)}


def test_check_finds_nothing_wrong(tutorial):
    _, outputs = tutorial
    assert "0 warnings, 0 errors" in outputs["contwalk systems check stirred_tank.py"]


def test_points_are_those_of_the_table(tutorial):
    where, _ = tutorial
    shown = json.loads(run_command("contwalk show ignition.h5 --json", where))
    found = {p["name"]: p for p in shown["branches"][0]["special_points"] if p["label"] != "EP"}
    assert set(found) == set(POINTS)
    text = (ROOT / TUTORIAL).read_text(encoding="utf-8")
    for name, value in POINTS.items():
        # the claimed error, plus the rounding of the value written here
        assert abs(found[name]["parameters"]["Da"] - value) <= found[name]["error"] + 2e-17
        row = re.search(rf"\| {name} \| ([0-9.]+) \| (\d) → (\d) \|", text)
        assert f"{value:.12g}".rstrip("0") == row[1].rstrip("0")
        assert (found[name]["unstable_before"], found[name]["unstable_after"]) == (int(row[2]), int(row[3]))


def test_more_cooling_does_what_the_text_says(tutorial):
    where, _ = tutorial
    (branch,) = cw.open_database(where / "cooled.h5").branches()
    found = [(p.label, round(p.parameters["Da"], 3), p.criticality) for p in branch.special_points]
    assert [f for f in found if f[0] != "EP"] == [
        ("HB", 0.165, "subcritical"),
        ("HB", 0.337, "supercritical"),
    ]


def test_every_file_the_tutorial_names_is_there(tutorial):
    where, _ = tutorial
    for name in ("ignition_bifurcation_diagram.png", "temperature.png", "eigenvalues.png", "cooled.h5"):
        assert (where / name).stat().st_size > 0
    assert list((where / "tables").glob("*.csv"))


def test_python_version_gives_the_same_points(tutorial):
    where, _ = tutorial
    output = run_python(blocks(TUTORIAL, "python")[1], where)
    for name, value in POINTS.items():
        printed = re.search(rf"^{name} (\S+) (\S+)", output, re.MULTILINE)
        # the claimed error, plus the rounding of the value written here
        assert abs(float(printed[1]) - value) <= float(printed[2]) + 2e-17


def test_mistake_that_the_tutorial_suggests_is_told(tutorial, tmp_path):
    text = blocks(TUTORIAL, "python")[0].replace("dx[TEMPERATURE] =", "dx[CONVERSION] =")
    (tmp_path / "stirred_tank.py").write_text(text, encoding="utf-8")
    with pytest.raises(AssertionError, match=r"does not write dx\[1\]"):
        run_command("contwalk systems check stirred_tank.py", tmp_path)


@pytest.mark.parametrize("number", range(1, len(blocks(PLUGINS, "python"))))
def test_plugins_of_the_reference_pass_the_check(number, tmp_path):
    (tmp_path / "plugin.py").write_text(blocks(PLUGINS, "python")[number], encoding="utf-8")
    assert "0 errors" in run_command("contwalk systems check plugin.py", tmp_path)


def test_imports_of_the_reference(tmp_path):
    run_python(blocks(PLUGINS, "python")[0], tmp_path)


def test_bead_on_a_hoop_has_its_pitchfork(tmp_path):
    (tmp_path / "bead.py").write_text(blocks(PLUGINS, "python")[2], encoding="utf-8")
    system = load_system("bead.py", base=tmp_path)
    problem = cw.Equilibrium(system, system.defaults(), free="omega")
    branch = cw.continue_branch(problem, "lowest", range=(0.5, 6.0))
    (point,) = [p for p in branch.special_points if p.label == "BP"]
    # closed form: omega^2 = g / radius
    assert abs(point.parameters["omega"] - 9.81**0.5) <= 2.0 * point.error
    assert point.criticality == "supercritical"


def test_family_of_the_reference_builds_each_machine(tmp_path):
    (tmp_path / "chain.py").write_text(blocks(PLUGINS, "python")[1], encoding="utf-8")
    for links in (1, 5):
        assert len(load_system("chain.py", {"links": links}, base=tmp_path).states) == links

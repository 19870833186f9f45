"""The page on conserved energy: its machines run as they stand, and do what the page says."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from code_blocks import blocks, run_command
from scipy.special import ellipk

import contwalk as cw

PAGE = "docs/howto/conserved_energy.md"
PLUGINS, STUDIES = ("pendulum", "runner"), ("pendulum", "length", "runner")


@pytest.fixture(scope="module")
def workshop(tmp_path_factory):
    """The folder after all studies of the page."""
    where = tmp_path_factory.mktemp("workshop")
    for name, plugin in zip(PLUGINS, blocks(PAGE, "python"), strict=True):
        (where / f"{name}.py").write_text(plugin, encoding="utf-8")
    for name, study in zip(STUDIES, blocks(PAGE, "yaml"), strict=True):
        (where / f"{name}.yaml").write_text(study, encoding="utf-8")
        run_command(f"contwalk continue {name}.yaml", where)
    return where


def branch_of(workshop, name):
    (branch,) = cw.open_database(workshop / f"{name}.h5").branches()
    return branch


@pytest.mark.parametrize("name", PLUGINS)
def test_plugins_pass_the_check(workshop, name):
    assert "0 warnings, 0 errors" in run_command(f"contwalk systems check {name}.py", workshop)


@pytest.mark.parametrize("name", ["pendulum", "length"])
def test_the_pendulum_has_its_period(workshop, name):
    """4 sqrt(l / g) K(m), m the energy's part of that of the upright position."""
    branch = branch_of(workshop, name)
    assert branch.outcome.reason == "bound"
    assert not [point for point in branch.special_points if point.label not in ("EP", "UZ")]
    for row in branch.points[::9]:
        own = branch.info.parameters | {branch.info.free[0]: float(row["free"][0])}
        m = own["energy"] / (2.0 * 9.81 * own["l"])
        # The accuracy of a run is 1e-8, local errors along a branch are 100 times that; towards the upright
        # position the period changes as 1 / (1 - m).
        true = 4.0 * math.sqrt(own["l"] / 9.81) * float(ellipk(m))
        assert row["period"] == pytest.approx(true, rel=3e-6 / (1.0 - m))


def test_the_runner_is_stable_between_both_points(workshop):
    branch = branch_of(workshop, "runner")
    found = [point for point in branch.special_points if point.label not in ("EP", "UZ")]
    assert [(point.name, round(point.parameters["alpha"], 2)) for point in found] == [
        ("LP1", 66.31),
        ("PD1", 68.85),
    ]
    assert [(point.unstable_before, point.unstable_after) for point in found] == [(1, 0), (0, 1)]
    assert branch.points["spectrum"].shape[1] == 1


def test_without_the_declaration_the_page_s_sentence_is_said(workshop):
    plugin = (workshop / "pendulum.py").read_text(encoding="utf-8")
    (line,) = [line for line in plugin.splitlines() if "conserved=" in line]
    (workshop / "plain.py").write_text(plugin.replace(line, ""), encoding="utf-8")
    study = (workshop / "length.yaml").read_text(encoding="utf-8")
    (workshop / "plain.yaml").write_text(study.replace("pendulum.py", "plain.py"), encoding="utf-8")
    run = cw.run(cw.read_run_file(workshop / "plain.yaml", output=workshop / "plain.h5"), figures=False)
    (branch,) = run.branches
    said = branch.outcome.message
    page = " ".join(blocks_of_quotes())
    start = "Orbits come in a family there, at the same parameters: they differ in q, w."
    assert start in said
    assert start in page
    assert "left vector q +1, w +0.233" in said
    assert "left vector q +1, w +0.233" in page


def blocks_of_quotes():
    """Lines of the page that are indented as what a run says."""
    text = (Path(__file__).parents[2] / PAGE).read_text(encoding="utf-8")
    return [line.strip() for line in text.splitlines() if line.startswith("    ")]

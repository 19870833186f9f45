"""The cookbook: its machines run as they stand, and do what the page says."""

from __future__ import annotations

import math

import numpy as np
import pytest
from code_blocks import ROOT, blocks, commands, run_command

import contwalk as cw
from contwalk.branch import LABELS

COOKBOOK = "docs/howto/cookbook.md"
NAMES = ("kicked", "stick_slip")


@pytest.fixture(scope="module")
def kitchen(tmp_path_factory):
    """The folder after all commands of the page, and their outputs."""
    where = tmp_path_factory.mktemp("cookbook")
    plugins, studies = blocks(COOKBOOK, "python"), blocks(COOKBOOK, "yaml")
    for name, plugin, study in zip(NAMES, plugins, studies, strict=True):
        (where / f"{name}.py").write_text(plugin, encoding="utf-8")
        (where / f"{name}.yaml").write_text(study, encoding="utf-8")
    return where, {line: run_command(line, where) for line in commands(COOKBOOK)}


@pytest.mark.parametrize("name", NAMES)
def test_plugins_pass_the_check(kitchen, name):
    assert "0 warnings, 0 errors" in kitchen[1][f"contwalk systems check {name}.py"]


def test_kicks_come_when_the_clock_says(kitchen):
    (branch,) = cw.open_database(kitchen[0] / "kicked.h5").branches()
    np.testing.assert_allclose(branch["period"], branch["every"], rtol=1e-9)
    (point,) = [p for p in branch.special_points if p.label == "UZ"]
    assert point.parameters["every"] == pytest.approx(6.31, abs=0.01)  # as the page says
    assert branch["amp:angle"].argmax() == pytest.approx(point.index, abs=1)


def test_the_mass_sticks_and_slips_in_the_period_of_the_page(kitchen):
    (branch,) = cw.open_database(kitchen[0] / "stick_slip.h5").branches()
    ratio = 0.4 / branch["belt"]
    period = 2.0 * math.pi - 2.0 * np.arctan(ratio) + 2.0 * ratio
    # Orbits along a branch are solved for to a hundred times the accuracy of 1e-8.
    np.testing.assert_allclose(branch["period"], period, rtol=1e-6)
    # The mass goes farthest while it slides: 0.6 + sqrt(D^2 + V^2).
    np.testing.assert_allclose(branch["max:x"], 0.6 + np.hypot(0.4, branch["belt"]), rtol=1e-6)
    assert set(branch.info.signature) == {"slip", "stick"}


def test_the_glossary_has_every_label():
    page = (ROOT / "docs/reference/glossary.md").read_text(encoding="utf-8")
    rows = [line.split(" | ")[0] for line in page.splitlines() if line.startswith("| ")]
    assert set(LABELS) <= {label for row in rows for label in row.removeprefix("| ").split(", ")}

"""The page on mass matrices: its machines run as they stand, and do what the page says."""

from __future__ import annotations

import csv
import runpy

import numpy as np
import pytest
from code_blocks import blocks, commands, run_command
from peers.machines.double_pendulum import PEER

import contwalk as cw

PAGE = "docs/howto/mass_matrices.md"
STUDIES = ("chain", "five", "shallow_arch")


@pytest.fixture(scope="module")
def workshop(tmp_path_factory):
    """The folder after all commands of the page, and their outputs."""
    where = tmp_path_factory.mktemp("workshop")
    for name, plugin in zip(("chain", "shallow_arch"), blocks(PAGE, "python"), strict=True):
        (where / f"{name}.py").write_text(plugin, encoding="utf-8")
    for name, study in zip(STUDIES, blocks(PAGE, "yaml"), strict=True):
        (where / f"{name}.yaml").write_text(study, encoding="utf-8")
    return where, {line: run_command(line, where) for line in commands(PAGE)}


@pytest.mark.parametrize("name", ["chain", "shallow_arch"])
def test_plugins_pass_the_check(workshop, name):
    assert "0 warnings, 0 errors" in workshop[1][f"contwalk systems check {name}.py"]


def test_two_links_are_the_double_pendulum(workshop):
    """Its special points are known from an independent integration."""
    (branch,) = cw.open_database(workshop[0] / "chain.h5").branches()
    found = [point for point in branch.special_points if point.label in ("LP", "PD")]
    known = sorted(PEER.studies[0].values, key=lambda value: value.value)
    for point, value in zip(sorted(found, key=lambda p: p.parameters["torque"]), known, strict=True):
        assert point.label == value.label
        assert abs(point.parameters["torque"] - value.value) <= point.error + value.rel * value.value


def test_the_energy_of_five_links_stays(workshop):
    """Through impacts without loss: a tolerance of 1e-8 for each of a thousand steps gives 1e-5."""
    with (workshop[0] / "five_trajectory.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    q = np.array([[float(row[f"q{i}"]) for i in range(1, 6)] for row in rows])
    v = np.array([[float(row[f"v{i}"]) for i in range(1, 6)] for row in rows])
    x, y = np.cumsum(np.sin(q), axis=1), -np.cumsum(np.cos(q), axis=1)
    speeds = np.cumsum(np.cos(q) * v, axis=1) ** 2 + np.cumsum(np.sin(q) * v, axis=1) ** 2
    energy = 0.5 * speeds.sum(axis=1) + 9.81 * y.sum(axis=1)
    assert np.abs(energy - energy[0]).max() < 1e-5 * abs(energy[0])
    assert (x[:, -1] > 1.5 - 1e-6).sum() >= 2  # it strikes the wall
    assert x[:, -1].max() < 1.5 + 1e-6


def test_the_arch_snaps_through_where_its_curve_is_level(workshop):
    (branch,) = cw.open_database(workshop[0] / "shallow_arch.h5").branches()
    spring = runpy.run_path(str(workshop[0] / "shallow_arch.py"))["SPRING"]
    level = [x for x in spring.derivative().roots() if 0.0 < x < 3.0]
    found = [point for point in branch.special_points if point.label == "LP"]
    assert len(found) == len(level) == 2
    for point, x in zip(sorted(found, key=lambda p: p.state["x"]), sorted(level), strict=True):
        assert point.state["x"] == pytest.approx(x, rel=1e-12)
        assert point.parameters["load"] == pytest.approx(float(spring(x)), rel=1e-12)

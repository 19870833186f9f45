"""The 3D walker with overlapping feet in the inclination: every special point of its straight gait."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from autobalancer_figures import RUNS, figure_run

from contwalk.branch import Branch, SpecialPoint
from contwalk.workflow.run_file import read_run_file

pytestmark = [pytest.mark.thesis, pytest.mark.slow]

REFERENCE = json.loads((Path(__file__).parent / "walker3d_reference.json").read_text(encoding="utf-8"))
# What the independent implementation is known to.
KNOWN, ENDS = 1e-8, 1e-6


def study() -> tuple[Branch, ...]:
    """The straight gait only: what leaves at the pitchfork is another story."""
    return figure_run("walker3d_overlap_inclination", "diagram.follow=[PD]")


def points(label: str) -> list[SpecialPoint]:
    return [point for branch in study() for point in branch.special_points if point.label == label]


@pytest.mark.parametrize("expected", REFERENCE["overlap"], ids=lambda entry: entry["what"])
def test_special_point(expected):
    found = [
        point
        for point in points(expected["label"])
        if abs(point.parameters["alpha"] / expected["alpha"] - 1.0) < KNOWN
    ]
    assert found, [point.parameters["alpha"] for point in points(expected["label"])]
    for point in found:
        assert point.status == "located"
        assert point.period == pytest.approx(expected["half_period"], rel=1e-6)
        if expected["label"] == "BP":
            assert point.kind == "symmetry-breaking"


@pytest.mark.parametrize("expected", REFERENCE["overlap_ends"], ids=lambda entry: entry["what"][:6])
def test_ends_are_terminal_grazings(expected):
    found = [point for point in points("GR") if point.kind == "terminal"]
    assert min(abs(p.parameters["alpha"] / expected["alpha"] - 1.0) for p in found) < ENDS


def test_all_of_it_is_half_a_stride():
    for branch in study():
        assert branch.info.closure == "mirror"
        assert branch.info.settings["pins"] == ["across", "along"]
        assert not any(name.endswith("loads") for name in branch.info.signature)
        regular = branch.points[~branch.points["special"]]
        assert np.all(np.isfinite(regular["spectrum"][:, 0]))


def test_run_files_are_in_the_table():
    for path in sorted(RUNS.glob("walker3d_*.yaml")):
        assert f"| `{path.stem}` |" in (RUNS / "README.md").read_text(encoding="utf-8")
        assert read_run_file(path).output.name == f"{path.stem}.h5"

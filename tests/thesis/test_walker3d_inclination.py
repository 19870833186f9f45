"""The 3D walker with overlapping feet in the inclination: special points of its straight gait.

What lies on the branches beyond (the second fold, the pitchfork, both ends) takes minutes: the run file
computes it, these tests the part around the printed gait.
"""

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
KNOWN = 1e-8
RANGES = ("[0.066, 0.0801]", "[0.0799, 0.115]")


def study(span: str) -> tuple[Branch, ...]:
    """The straight gait on both sides of the printed one."""
    return figure_run("walker3d_overlap_inclination", f"continue.range={span}", "diagram.follow=[PD]")


def points() -> list[SpecialPoint]:
    return [point for span in RANGES for branch in study(span) for point in branch.special_points]


def reached() -> list[dict]:
    """Those of the reference that lie on the way: not beyond the folds and ends of the lower side."""
    upper = [e for e in REFERENCE["overlap"] if e["alpha"] > 0.08]
    lower = [
        e for e in REFERENCE["overlap"] if e["what"] in ("HOPF", "dip hind22") and e["half_period"] > 0.8
    ]
    return upper + lower


@pytest.mark.parametrize("expected", reached(), ids=lambda entry: f"{entry['what']} {entry['alpha']:.6f}")
def test_special_point(expected):
    found = [
        point
        for point in points()
        if point.label == expected["label"]
        and abs(point.parameters["alpha"] / expected["alpha"] - 1.0) < KNOWN
    ]
    assert found, [(point.label, point.parameters["alpha"]) for point in points()]
    for point in found:
        assert point.status == "located"
        assert point.error < KNOWN * expected["alpha"]
        assert point.period == pytest.approx(expected["half_period"], rel=1e-6)


def test_there_are_enough_of_them():
    assert [entry["label"] for entry in reached()] == ["LP", "GR", "GR", "NS", "GR"]


def test_all_of_it_is_half_a_stride():
    for branch in (branch for span in RANGES for branch in study(span)):
        assert branch.info.closure == "mirror"
        assert branch.info.settings["pins"] == ["across", "along"]
        assert not any(name.endswith("loads") for name in branch.info.signature)
        regular = branch.points[~branch.points["special"]]
        assert np.all(np.isfinite(regular["spectrum"][:, 0]))


def test_run_files_are_in_the_table():
    for path in sorted(RUNS.glob("walker3d_*.yaml")):
        assert f"| `{path.stem}` |" in (RUNS / "README.md").read_text(encoding="utf-8")
        assert read_run_file(path).output.name == f"{path.stem}.h5"

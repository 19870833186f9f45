"""The study of the 3D walker, killed again and again and taken up, finds the same to the last bit."""

from __future__ import annotations

from pathlib import Path

import pytest
from killed_runs import Runs, assert_same, stored

from contwalk.storage import open_database

# Runs of smaller machines are killed without waiting for these.
pytestmark = [pytest.mark.thesis, pytest.mark.slow, pytest.mark.long]

RUNS = Path(__file__).parents[2] / "runs"
# The stable side: a Neimark-Sacker point, two changes of order, and a foot that touches the ground.
STUDY = ("continue.range=[0.0655, 0.0801]", "continue.direction=backward", "diagram.follow=none")
# Reports after which the process ends: within the first branch, right after it, and within the second.
DEATHS = (4, 7, 3)


def test_killed_studies_end_with_the_diagram_of_an_uninterrupted_one(tmp_path):
    runs = Runs(RUNS / "walker3d_overlap_inclination.yaml", tmp_path, STUDY)
    assert runs.ended("whole.h5") == 0
    left = []
    for death in DEATHS:
        assert runs.ended("killed.h5", death) == 9
        left.append(stored(tmp_path / "killed.h5", "hybrid_orbit"))
    assert left == sorted(left)
    assert runs.ended("killed.h5") == 0
    assert_same(tmp_path / "whole.h5", tmp_path / "killed.h5")
    with open_database(tmp_path / "whole.h5") as whole:
        labels = [point.label for branch in whole.branches() for point in branch.special_points]
    assert {"NS", "OC", "GR"} <= set(labels)

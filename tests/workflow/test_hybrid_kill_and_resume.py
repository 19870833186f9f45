"""`kill -9` at random moments of the slope study: --resume ends with the same diagram, bit by bit."""

from __future__ import annotations

from pathlib import Path

import pytest
from killed_runs import Runs, assert_same

from contwalk.storage import open_database

pytestmark = pytest.mark.slow

SLOPE = Path(__file__).resolve().parents[2] / "runs" / "planar_slope.yaml"
# The study with its grazing, its conditions and two doublings, but for the far ends of its branches.
NARROWED = ("continue.range=[0.0525, 0.112]", "diagram.depth=1")


@pytest.fixture(scope="module")
def runs(tmp_path_factory) -> tuple[Runs, float]:
    """The study as processes, run once without interruption, and how long that took."""
    runs = Runs(SLOPE, tmp_path_factory.mktemp("slope"), NARROWED)
    return runs, runs.whole()


@pytest.mark.long
def test_killed_studies_end_as_an_uninterrupted_one(runs):
    runs, seconds = runs
    with open_database(runs.folder / "whole.h5") as db:
        branches = list(db.branches())
    assert [b.info.problem for b in branches] == ["hybrid_orbit"] * 2
    labels = [p.label for b in branches for p in b.special_points]
    assert (labels.count("GR"), labels.count("AZ"), labels.count("PD")) == (3, 2, 2)
    assert runs.killed(seconds, 3, "hybrid_orbit") > 0, "no run was killed after its first point: kill later"


def test_runs_ended_beside_special_points_go_on_to_the_same_diagram(runs):
    """Ended at some reports round the birth of the second branch and its special points."""
    runs, _ = runs
    with open_database(runs.folder / "whole.h5") as db:
        first, second = db.branches()
    # Reports: the rows of a branch, and the ends of it that have none of their own.
    birth = len(first) + sum(p.label == "EP" for p in first.special_points)
    own = [birth + i for i, special in enumerate(second["special"]) if special]
    for output in runs.left((1, birth + 1, own[0], own[-1] + 1)):
        assert runs.ended(output) == 0
        assert_same(runs.folder / "whole.h5", runs.folder / output)

"""`kill -9` at random moments of the slope study: --resume ends with the same diagram, bit by bit."""

from __future__ import annotations

from pathlib import Path

from killed_runs import Runs, assert_same

from contwalk.storage import open_database

SLOPE = Path(__file__).resolve().parents[2] / "runs" / "planar_slope.yaml"
# The study with its grazing, its conditions and two doublings, but for the far ends of its branches.
NARROWED = ("continue.range=[0.0525, 0.112]", "diagram.depth=1")


def test_killed_studies_end_as_an_uninterrupted_one(tmp_path):
    runs = Runs(SLOPE, tmp_path, NARROWED)
    seconds = runs.whole()
    with open_database(tmp_path / "whole.h5") as db:
        branches = list(db.branches())
    assert [b.info.problem for b in branches] == ["hybrid_orbit"] * 2
    labels = [p.label for b in branches for p in b.special_points]
    assert (labels.count("GR"), labels.count("AZ"), labels.count("PD")) == (3, 2, 2)
    assert runs.killed(seconds, 4, "hybrid_orbit") > 0, "no run was killed after its first point: kill later"


def test_runs_ended_beside_special_points_go_on_to_the_same_diagram(tmp_path):
    """Ended at some reports round the birth of the second branch, which is written as a leg longer."""
    runs = Runs(SLOPE, tmp_path, NARROWED)
    assert runs.ended("whole.h5") == 0
    with open_database(tmp_path / "whole.h5") as db:
        first, second = db.branches()
    # Reports: the rows of a branch, and the ends of it that have none of their own.
    birth = len(first) + sum(p.label == "EP" for p in first.special_points)
    own = [birth + i for i, special in enumerate(second["special"]) if special]
    for number in (1, birth, birth + 1, own[0], own[0] + 1, own[-1] + 1):
        output = f"ended_{number}.h5"
        assert runs.ended(output, number) == 9
        assert runs.ended(output) == 0
        assert_same(tmp_path / "whole.h5", tmp_path / output)

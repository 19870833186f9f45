"""`kill -9` at random moments of a cascade of orbits: --resume ends with the same diagram, bit by bit."""

import pytest
from killed_runs import Runs, assert_same

from contwalk.storage import open_database

pytestmark = pytest.mark.slow


RUN = """
contwalk: 1
system: autobalancer
model: {masses: 2}
preset: heavy
parameters: {omega: 5.0}
start: {equilibrium: balanced, parameters: {delta: 0.0065}}
continue: {parameter: delta, range: [0.0030, 0.0065], direction: backward}
diagram: {follow: [HB, PD], depth: 3}
mark: {delta: [0.0045]}
"""
KILLS = 8


@pytest.mark.long
def test_killed_cascades_end_as_an_uninterrupted_one(tmp_path):
    (tmp_path / "run.yaml").write_text(RUN)
    runs = Runs(tmp_path / "run.yaml", tmp_path)
    seconds = runs.whole()
    with open_database(tmp_path / "whole.h5") as db:
        names = [branch.info.origin for branch in db.branches()]
    assert [name.split("/")[-1] for name in names[1:]] == ["HB1", "PD1", "PD1"]
    assert runs.killed(seconds, KILLS, "periodic_orbit") > 0, (
        "no run was killed after its first point: kill later"
    )


@pytest.mark.long
def test_runs_ended_beside_special_points_and_at_births_go_on_to_the_same_diagram(tmp_path):
    """Ended at every third report of the last two branches, where special points and births are dense."""
    (tmp_path / "run.yaml").write_text(RUN)
    runs = Runs(tmp_path / "run.yaml", tmp_path)
    assert runs.ended("whole.h5") == 0
    with open_database(tmp_path / "whole.h5") as db:
        sizes = [len(branch) for branch in db.branches()]
    for output in runs.left(range(sum(sizes[:2]) - 6, sum(sizes), 3)):
        assert runs.ended(output) == 0
        assert_same(tmp_path / "whole.h5", tmp_path / output)

"""Curves of several generations whose run ends on its way: --resume makes the same diagram, bit by bit."""

from __future__ import annotations

import pytest
from demo_ab import AB
from killed_runs import Runs, assert_same

from contwalk.storage import open_database

pytestmark = pytest.mark.slow

RUN = """
system: ./ab.py
start: {state: {u1: 0.0, u2: 0.0}}
parameters: {p1: 0.1, p2: 14.0}
continue: {parameter: p1, range: [0.1, 0.3], max_points: 70}
diagram: {follow: none, depth: 2}
loci: {with: p2, range: [2.0, 30.0], of: [HB], follow: [GH]}
"""


@pytest.mark.long
def test_curves_of_two_generations_go_on_to_the_same_diagram(tmp_path):
    """Ended where the curve of Hopf points begins, where that of folds of cycles does, and far along that.

    There orbits are in more segments and on finer steps than those that a walk begins with, and were solved
    for anew on them.
    """
    (tmp_path / "ab.py").write_text(AB)
    (tmp_path / "run.yaml").write_text(RUN)
    runs = Runs(tmp_path / "run.yaml", tmp_path)
    assert runs.ended("whole.h5") == 0
    with open_database(tmp_path / "whole.h5") as db:
        branches = db.branches()
        notes = db.notes()
    assert [b.info.settings.get("of") for b in branches] == [None, "HB", "LP"]
    folds = branches[-1]
    assert len(folds.unknowns(len(folds) - 1)) > len(folds.unknowns(0))  # more segments
    births = [sum(len(b) + len(b.special_points) for b in branches[:n]) for n in (1, 2)]
    for output in runs.left([*births, births[1] + len(folds) - 4]):
        assert runs.ended(output) == 0
        assert_same(tmp_path / "whole.h5", tmp_path / output)
        with open_database(tmp_path / output) as db:
            assert db.notes() == notes

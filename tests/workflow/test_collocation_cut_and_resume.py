"""Runs with collocation that are cut at reports and go on: the same diagram to the last bit."""

from __future__ import annotations

import contextlib

import pytest
from killed_runs import assert_same
from test_cut_and_resume import Cut, Cutting

from contwalk.storage import open_database
from contwalk.workflow.run_file.reading import read_run_file
from contwalk.workflow.runner import run

pytestmark = pytest.mark.slow

PLUGIN = """
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0] = x[0] - x[0] ** 3 / 3 - x[1] + p.I
    dx[1] = EPS * (x[0] + 0.7 - 0.8 * x[1])

SYSTEM = System(
    name="nerve",
    states=(State("v"), State("w")),
    parameters=(Parameter("I", 0.34),),
    modes=(Mode("smooth", field),),
)
"""
# Along the explosion the orbit is cut anew several times: by `auto` in halves, then where deviations grow.
RUN = """
contwalk: 1
system: ./nerve.py
start: {state: {v: -1.0, w: -0.4}}
continue: {parameter: I, range: [0.28, 0.34], max_points: 90}
diagram: {follow: [HB]}
engine: {discretization: KIND}
"""


@pytest.mark.long
@pytest.mark.parametrize(("kind", "eps"), [("auto", 0.01), ("collocation", 0.04)])
def test_a_cut_run_ends_as_a_whole_one(tmp_path, kind, eps):
    (tmp_path / "nerve.py").write_text(PLUGIN.replace("EPS", str(eps)))
    (tmp_path / "run.yaml").write_text(RUN.replace("KIND", kind))

    def study(output):
        return read_run_file(tmp_path / "run.yaml", output=str(tmp_path / output))

    whole = Cutting(-1)
    run(study("whole.h5"), force=True, reporter=whole, figures=False)
    with open_database(tmp_path / "whole.h5") as db:
        rows = db.branches()[-1].points["unknowns"]
    lengths = [int(row.size - sum(row != row)) for row in rows]
    assert len(set(lengths)) > 2
    changes = [k for k in range(1, len(lengths)) if lengths[k] != lengths[k - 1]]
    total = len(whole.told)
    for left in {total - len(lengths) + k + shift for k in (changes[0], changes[-1]) for shift in (0, 1)}:
        with contextlib.suppress(Cut):
            run(study("cut.h5"), force=True, reporter=Cutting(left), figures=False)
        run(study("cut.h5"), resume=True, figures=False)
        assert_same(tmp_path / "whole.h5", tmp_path / "cut.h5")

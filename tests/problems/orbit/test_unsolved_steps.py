"""Friction that is steep about rest, in one mode: an implicit step across its corner may have no solution.

The motion does not end there, and nothing says that it does.
"""

from __future__ import annotations

import contwalk as cw

PLUGIN = """\
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    slip = x[1] - p.V
    steep = 1e4 * slip
    friction = (1.0 if slip > 0 else -1.0) / (1.0 + abs(slip)) if abs(slip) > 1e-4 else steep
    dx[0] = x[1]
    dx[1] = -x[0] - friction

SYSTEM = System("block", states=(State("x"), State("v")), parameters=(Parameter("V", 0.3),),
    modes=(Mode("only", field),))
"""
RUN = """\
contwalk: 1
system: ./block.py
start: {simulate: {state: {x: 1.0, v: 0.0}, until: settled}}
continue: {parameter: V, range: [0.3, 0.5]}
diagram: none
output: out.h5
"""


def test_a_branch_that_ends_at_a_step_without_solution_says_so(tmp_path):
    (tmp_path / "block.py").write_text(PLUGIN)
    (tmp_path / "run.yaml").write_text(RUN)
    study = cw.read_run_file(tmp_path / "run.yaml", output=tmp_path / "out.h5")
    outcome = cw.run(study, figures=False).branches[0].outcome
    assert outcome.status == "failed"
    assert "grows without bound" not in outcome.message
    said = "An implicit step on the way has no solution, though the motion goes on in shorter ones: the "
    assert f"{said}field is smooth by pieces only within it, {tmp_path}" in outcome.message
    assert "block.py, line 6 (a comparison). Declare two modes" in outcome.message

"""Kinks inside a mode of a machine with events: noticed along legs, not where an event is."""

from __future__ import annotations

import pytest

import contwalk as cw

PLUGIN = """\
import math
import numpy as np
from contwalk.system import Mode, Parameter, State, System, Transition

def flight(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -x[0] - 0.1 * x[1] + p.F * math.cos(p.w * t) + {term}

def bounce(t, x, p, x_plus):
    x_plus[0], x_plus[1] = x[0], -0.8 * x[1]

SYSTEM = System("small", states=(State("y"), State("v")),
    parameters=(Parameter("F", 1.0), Parameter("w", 2.0)),
    modes=(Mode("free", flight),),
    transitions=(Transition("hit", "free", "free", lambda t, x, p: x[0] + 0.2, "falling", bounce),),
    period=lambda p: 2 * math.pi / p.w)
"""
RUN = """\
contwalk: 1
system: ./small.py
start: {simulate: {state: {y: 0.5, v: 0.0}, until: settled}}
continue: {parameter: F, range: [0.9, 1.1], max_points: 3, direction: forward}
"""


def study(folder, term):
    (folder / "small.py").write_text(PLUGIN.format(term=term))
    (folder / "run.yaml").write_text(RUN)
    result = cw.run(cw.read_run_file(folder / "run.yaml", output=folder / "run.h5"), figures=False)
    with cw.open_database(folder / "run.h5") as db:
        notes = [text for key, text in db.notes().items() if key.startswith("kink")]
    return result.branches[0], notes


def test_a_jump_on_a_leg_is_refused_with_its_line(tmp_path):
    branch, _ = study(tmp_path, "(0.05 if x[0] > 0.1 else 0.0)")
    assert branch.outcome.reason == "plugin_error"
    assert "small.py, line 7 (a comparison)" in branch.outcome.message


def test_slopes_that_jump_on_a_leg_are_told(tmp_path):
    branch, (told,) = study(tmp_path, "-0.3 * max(x[0], 0.0)")
    assert len(branch) > 1
    assert "small.py, line 7 (max)" in told


@pytest.mark.parametrize("term", ["-0.3 * max(x[0] + 0.2, 0.0)", "0.1 * abs(x[0] + 5.0)"])
def test_a_choice_that_changes_at_the_event_or_never_is_none(tmp_path, term):
    branch, notes = study(tmp_path, term)
    assert len(branch) > 1
    assert notes == []

"""Periods that are none at some parameters: told with the plugin's line, on branches and at starts."""

from __future__ import annotations

import pytest

import contwalk as cw
from contwalk.errors import NotFinite
from contwalk.problems.forcing import period_at

# A driven mass; with a stop in its way it is a machine with events.
PLUGIN = """\
import math
from contwalk.system import Mode, Parameter, State, System, Transition

def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.r * math.cos(t) - 0.2 * x[1] - x[0]

def bounce(t, x, p, after):
    after[0], after[1] = x[0], -0.6 * x[1]

def period(p):
    return {period}

SYSTEM = System("driven", states=(State("x"), State("y")), parameters=(Parameter("r", 1.0),),
    modes=(Mode("only", field),), transitions=({events}), period=period)
"""
STOP = "Transition('hit', 'only', 'only', lambda t, x, p: 0.5 - x[0], reset=bounce),"
STATE, SETTLED = "{state: {x: 0.0, y: 1.0}}", "{simulate: {state: {x: 0.0, y: 1.0}, until: settled}}"
RUN = """\
contwalk: 1
system: ./driven.py
start: %s
parameters: {r: %s}
continue: {parameter: r, range: [0.8, 1.4], max_points: 60, direction: forward}
diagram: none
"""
NEGATIVE = "2.0 * math.pi if p.r < 1.1 else -1.0"
ROOT = "2.0 * math.pi * math.sqrt(1.1 - p.r) / math.sqrt(1.1 - p.r)"
# Of the function, or of what raises in it.
LINE, INSIDE = "driven.py, line 11: ", "driven.py, line 12: "
CASES = [("", STATE), ("", SETTLED), (STOP, SETTLED)]


def outcome(folder, period, events, start, value):
    (folder / "driven.py").write_text(PLUGIN.format(period=period, events=events))
    (folder / "run.yaml").write_text(RUN % (start, value))
    run_file = cw.read_run_file(folder / "run.yaml", output=folder / "run.h5")
    (branch,) = cw.run(run_file, figures=False).branches
    return branch


@pytest.mark.drawn(3)
@pytest.mark.parametrize(("events", "start"), CASES)
@pytest.mark.parametrize(
    ("period", "line", "value"),
    [(NEGATIVE, INSIDE, "the period jumps: "), (ROOT, LINE, "period(p) is nan at")],
)
def test_a_branch_ends_where_there_is_no_period(tmp_path, period, line, value, events, start):
    branch = outcome(tmp_path, period, events, start, 1.0)
    assert branch.outcome.reason == "plugin_error"
    assert line.rstrip(": ") in branch.outcome.message
    assert value in branch.outcome.message
    assert 0.0 < 1.1 - branch["r"][-1] < 1e-6


@pytest.mark.parametrize(("events", "start"), CASES)
@pytest.mark.parametrize("period", [NEGATIVE, ROOT])
def test_a_start_without_a_period_is_refused(tmp_path, period, events, start):
    branch = outcome(tmp_path, period, events, start, 1.2)
    assert (branch.outcome.reason, len(branch)) == ("plugin_error", 0)
    # With numbers a root of a negative one raises; with symbols it is NaN.
    told = [f"{LINE}period(p) is", f"{INSIDE}ValueError: math domain error"]
    assert any(words in branch.outcome.message for words in told)


def test_a_parameter_that_is_no_number_is_not_the_plugin_s_fault(tmp_path):
    (tmp_path / "driven.py").write_text(PLUGIN.format(period=NEGATIVE, events=""))
    with pytest.raises(NotFinite, match="'r' is nan"):
        period_at(cw.load_system(str(tmp_path / "driven.py")), {"r": float("nan")})

"""A pushed motion whose events do not accumulate, but are thousands of times those of the solution."""

from __future__ import annotations

import pytest

from contwalk.cli.entry import run
from contwalk.storage.trajectory import read_margins

# A clock that ticks once a second; beyond x = 1 it buzzes, ten thousand times a second, until x is below 1/2.
CLOCK = """\
from contwalk.system import Mode, Parameter, State, System, Transition


def runs(t, x, p, dx):
    dx[0] = -p.rate * x[0]
    dx[1] = 1.0


def buzzes(t, x, p, dx):
    dx[0] = -p.rate * x[0]
    dx[1] = p.fast


def begins_again(t, x, p, after):
    after[0] = x[0]
    after[1] = 0.0


def full(t, x, p):
    return x[1] - 1.0


SYSTEM = System(
    "clock",
    states=(State("x", "1", 1.0), State("phase", "1", 1.0)),
    parameters=(Parameter("rate", 1.0, "1/s"), Parameter("fast", 1.0e4, "1/s")),
    modes=(Mode("runs", runs), Mode("buzzes", buzzes)),
    transitions=(
        Transition("tick", "runs", "runs", full, "rising", begins_again),
        Transition("tick", "buzzes", "buzzes", full, "rising", begins_again),
        Transition("trips", "runs", "buzzes", lambda t, x, p: x[0] - 1.0, "rising", level=True),
        Transition("calms", "buzzes", "runs", lambda t, x, p: x[0] - 0.5, "falling", level=True),
    ),
)
"""
RUN = """\
system: ./clock.py
start: {simulate: {state: {x: 0.0, phase: 0.1}, until: 0}}
continue: {parameter: rate, range: [1.0, 1.1], max_points: 2, direction: up}
diagram: none
margins:
  of: {from: clock.h5, point: b1/0}
  instants: [0.3]
  states: x
  survive: {periods: 5}
  accuracy: 1e-6
  farthest: 3
  scan: 0
output: clock.h5
"""


@pytest.mark.parametrize(("fast", "ends"), [(1.0e4, "events_accumulate"), (100.0, "survived")])
def test_thousands_of_events_within_a_period_are_chatter(folder, fast, ends):
    """6931 ticks follow a push to one; with a hundredth of them the motion survives all pushes."""
    (folder / "clock.py").write_text(CLOCK, encoding="utf-8")
    (folder / "clock.yaml").write_text(RUN, encoding="utf-8")
    given = ("clock.yaml", "--set", f"parameters.fast={fast}", "--quiet", "--no-figures")
    assert run(("continue", *given)) == 0
    assert run(("margins", *given)) == 0
    up, down = sorted(read_margins("clock_margins.h5").rows, key=lambda row: -row["sign"])
    assert up["ends"] == ends
    assert up["border"] == (pytest.approx(1.0, rel=1e-5) if ends == "events_accumulate" else None)
    assert (down["ends"], down["border"]) == ("survived", None)

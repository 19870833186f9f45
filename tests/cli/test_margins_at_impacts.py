"""`contwalk margins` right after an event: what a push does there, against closed forms."""

from __future__ import annotations

import math

import pytest

from contwalk.cli.entry import run
from contwalk.storage.trajectory import read_margins

# A ball above a floor that adds a speed at each bounce, below a ceiling that it must not touch.
BOUNCER = """\
from contwalk.system import Mode, Parameter, State, System, Transition


def flies(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.g


def bounces(t, x, p, after):
    after[0] = 0.0
    after[1] = 1.0 - 0.5 * x[1]


SYSTEM = System(
    "bouncer",
    states=(State("h", "m", 1.0), State("v", "m/s", 1.0)),
    parameters=(Parameter("g", 1.0, "m/s^2"),),
    modes=(Mode("flies", flies),),
    transitions=(Transition("bounces", "flies", "flies", lambda t, x, p: x[0], "falling", bounces),),
    fallen=lambda t, x, p: x[0] - 5.0,
)
"""
RUN = """\
system: ./bouncer.py
start: {simulate: {state: {h: 0.1, v: 1.0}, until: settled}}
continue: {parameter: g, range: [1.0, 1.1], max_points: 2, direction: up}
diagram: none
margins:
  of: {from: bouncer.h5, point: b1/0}
  instants: 2
  survive: {periods: 5}
  accuracy: 1e-7
  scan: 0
output: bouncer.h5
"""


def test_a_ball_that_is_pushed_onto_the_floor_bounces(folder):
    """It leaves the floor with 2; what is pushed down to -u bounces with 1 + u / 2, and sqrt(10) touches."""
    (folder / "bouncer.py").write_text(BOUNCER, encoding="utf-8")
    (folder / "bouncer.yaml").write_text(RUN, encoding="utf-8")
    assert run(("continue", "bouncer.yaml", "--no-figures", "--quiet")) == 0
    assert run(("margins", "bouncer.yaml", "--no-figures", "--quiet")) == 0
    found = {
        (r["instant"], r["state"], r["sign"]): r["border"] for r in read_margins("bouncer_margins.h5").rows
    }
    top = math.sqrt(10.0)
    assert found.pop((0, "h", -1)) == pytest.approx(0.0, abs=1e-12)
    assert found == pytest.approx(
        {
            (0, "h", 1): 3.0,
            (0, "v", 1): top - 2.0,
            (0, "v", -1): 2.0 * top,
            (1, "h", 1): 3.0,
            (1, "h", -1): 2.0,
            (1, "v", 1): math.sqrt(6.0),
            (1, "v", -1): math.sqrt(4.0 * (top - 1.0) ** 2 - 4.0),
        },
        rel=1e-6,
    )

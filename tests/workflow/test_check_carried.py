"""Resets that carry another guard past zero, and guards of impacts that accumulate: what the check says."""

from __future__ import annotations

import pytest

from contwalk.plugin_check.system import check_reference

NEURONS = """\
from contwalk.system import Mode, Parameter, State, System, Transition

def field(t, x, p, dx):
    dx[0] = 1.3 - x[0]
    dx[1] = 1.25 - x[1]

def first(t, x, p, after):
    after[0] = 0.0
    after[1] = x[1] + PULSE

def second(t, x, p, after):
    after[0] = x[0] + PULSE
    after[1] = 0.0

SYSTEM = System("pair", states=(State("a"), State("b")), parameters=(), modes=(Mode("rest", field),),
    transitions=(
        Transition("one", "rest", "rest", lambda t, x, p: x[0] - 1.0, "rising", reset=first),
        Transition("two", "rest", "rest", lambda t, x, p: x[1] - 1.0, "rising", reset=second),
    ))
"""
CAM = """\
import math
from contwalk.system import Mode, State, System, Transition

def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -20.0 * (x[0] + 0.5) - 0.2 * x[1]

def gap(t, x, p):
    return x[0] - 0.1 * math.cos(14.0 * t)

def hit(t, x, p, after):
    rate = -1.4 * math.sin(14.0 * t)
    after[0] = x[0]
    after[1] = rate - 0.3 * (x[1] - rate)

SYSTEM = System("cam", states=(State("y"), State("v")), parameters=(), modes=(Mode("flight", field),),
    transitions=(Transition("hit", "flight", "flight", gap, "falling", reset=hit),),
    period=lambda p: 2.0 * math.pi / 14.0)
"""
BELT = """\
import numpy as np
from contwalk.system import Mode, Parameter, State, System, Transition

def slides(sign):
    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -x[0] - 0.4 * sign + np.cos(0.7 * t)
    return field

def sticks(t, x, p, dx):
    dx[0] = 0.2
    dx[1] = 0.0 * x[1]

def load(t, x):
    return x[0] - np.cos(0.7 * t)

def held(t, x, p, after):
    after[0] = x[0]
    after[1] = 0.2

SYSTEM = System("belt", states=(State("x"), State("v")), parameters=(),
    modes=(Mode("slow", slides(-1.0)), Mode("fast", slides(1.0)), Mode("stick", sticks)),
    transitions=(
        Transition("rises", "slow", "stick", lambda t, x, p: x[1] - 0.2, "rising", reset=held),
        Transition("falls", "fast", "stick", lambda t, x, p: x[1] - 0.2, "falling", reset=held),
        Transition("back", "stick", "slow", lambda t, x, p: 0.5 - load(t, x), "falling"LEVEL),
        Transition("on", "stick", "fast", lambda t, x, p: 0.5 + load(t, x), "falling"LEVEL),
    ), period=lambda p: 2.0 * np.pi / 0.7)
"""


def findings(folder, source):
    (folder / "machine.py").write_text(source)
    return check_reference("./machine.py", folder)


@pytest.mark.parametrize(
    ("pulse", "told"),
    [("0.4", ["reset of transition 'one'", "reset of transition 'two'"]), ("-0.4", [])],
)
def test_a_pulse_that_carries_another_guard_past_zero_is_told(tmp_path, pulse, told):
    found = findings(tmp_path, NEURONS.replace("PULSE", pulse))
    carried = [each for each in found if "past zero: that has not passed zero" in each.sentence]
    assert sorted(each.what for each in carried) == told
    places = sorted((each.level, each.line) for each in carried)
    assert places == [("warning", 7), ("warning", 11)][: len(told)]
    assert all("Declare level=True for" in each.sentence for each in carried)


@pytest.mark.parametrize(("level", "told"), [("", True), (", level=True", False)])
def test_a_mode_that_is_entered_with_a_guard_past_zero_is_told(tmp_path, level, told):
    """A mass on a belt comes to rest on it where the load is larger than friction holds."""
    found = findings(tmp_path, BELT.replace("LEVEL", level))
    entered = [each for each in found if "mode 'stick' is entered with the guard of" in each.sentence]
    assert bool(entered) == told
    assert all(each.level == "warning" and "Declare level=True for" in each.sentence for each in entered)


def test_guards_of_impacts_that_accumulate_do_not_jump(tmp_path):
    found = findings(tmp_path, CAM)
    assert [each.sentence for each in found if each.level == "error"] == []

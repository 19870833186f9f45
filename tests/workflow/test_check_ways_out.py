"""What the check says of modes that are never left, of transitions that sampled states miss, and of arguments
in another order."""

from __future__ import annotations

import pytest

from contwalk.plugin_check.findings import Finding
from contwalk.plugin_check.system import check_reference

CONVERTER = """\
from contwalk.system import Mode, Parameter, State, System, Transition

def on(t, x, p, dx):
    dx[0], dx[1] = 1.0 - 0.1 * x[0], 1.0

def off(t, x, p, dx):
    dx[0], dx[1] = -2.0 - 0.1 * x[0], 1.0

def idle(t, x, p, dx):
    dx[1] = 1.0

def half(t, x, p):
    return 0.5 - x[1]

def current(t, x, p):
    return x[0]

def whole(t, x, p):
    return p.T - x[1]

def tick(t, x, p, after):
    after[0], after[1] = x[0], 0.0

SYSTEM = System("converter", states=(State("i"), State("clock")), parameters=(Parameter("T", 1.0),),
    modes=(Mode("on", on), Mode("off", off), Mode("idle", idle, states=("clock",))),
    transitions=(
        Transition("opens", "on", "off", half),
        Transition("empties", "off", "idle", current),
        Transition("tick", "off", "on", whole, reset=tick),
        Transition("tick", "idle", "on", whole, reset=tick),
    ))
"""
# A tank with a heater beside it: the states that are sampled are far from those that the machine comes to.
TANKS = """\
from contwalk.system import Mode, Parameter, State, System, Transition

def tanks(heat):
    def field(t, x, p, dx):
        dx[0] = 0.3 * (x[1] - x[0]) + 0.05 * (10.0 - x[0]) + 4.0 * heat
        dx[1] = 0.3 * (x[0] - x[1]) + 0.05 * (10.0 - x[1])
    return field

SYSTEM = System("tanks", states=(State("near"), State("far")), parameters=(Parameter("wanted", 20.0),),
    modes=(Mode("heats", tanks(1.0)), Mode("waits", tanks(0.0))),
    transitions=(
        Transition("hot", "heats", "waits", lambda t, x, p: x[1] - p.wanted - 1.0, "rising"),
        Transition("cold", "waits", "heats", lambda t, x, p: x[1] - p.wanted + 1.0, "falling"),
    ))
"""
# Prey and a predator that is hunted where there are many: y slides along 0.6.
HUNTED = """\
from contwalk.system import Mode, Parameter, State, System, Transition

def moves(hunted):
    def field(t, x, p, dx):
        dx[0] = x[0] * (1.0 - x[0]) - x[0] * x[1] / (0.1556 + x[0])
        dx[1] = x[1] * (x[0] / (0.1556 + x[0]) - 0.5556 - 0.2 * hunted)
    return field

def slides(t, x, p, dx):
    dx[0] = x[0] * (1.0 - x[0]) - x[0] * x[1] / (0.1556 + x[0])
    dx[1] = 0.0 * x[1]

def level(t, x, p):
    return x[1] - p.many

def growth(t, x, p):
    return x[0] / (0.1556 + x[0]) - 0.5556

def growth_hunted(t, x, p):
    return growth(t, x, p) - 0.2

def stays(t, x, p, after):
    after[0], after[1] = x[0], p.many

SYSTEM = System("hunted", states=(State("x"), State("y")), parameters=(Parameter("many", 0.6),),
    modes=(Mode("few", moves(0.0)), Mode("many_", moves(1.0)), Mode("slides", slides)),
    transitions=(
        Transition("rises", "few", "slides", level, "rising", reset=stays),
        Transition("falls", "many_", "slides", level, "falling", reset=stays),
        Transition("up", "slides", "many_", growth_hunted, "rising", level=True),
        Transition("down", "slides", "few", growth, "falling", level=True),
    ))
"""


def troubles(folder, source: str) -> list[Finding]:
    (folder / "machine.py").write_text(source)
    every = check_reference("./machine.py", folder)
    told = ("No unit is given", "No meaning is given", "It has no reference")
    return [f for f in every if f.level != "ok" and not f.sentence.startswith(told)]


@pytest.mark.parametrize("source", [CONVERTER, TANKS, HUNTED])
def test_nothing_is_said_of_machines_that_go_round(tmp_path, source) -> None:
    assert [f.sentence for f in troubles(tmp_path, source)] == []


def test_a_mode_that_nothing_leads_out_of_is_told(tmp_path) -> None:
    forgotten = '        Transition("tick", "idle", "on", whole, reset=tick),\n'
    (found,) = troubles(tmp_path, CONVERTER.replace(forgotten, ""))
    assert (found.level, found.what) == ("warning", "mode 'idle'")
    assert "'empties' leads to it" in found.sentence
    assert "no transition leads out of it" in found.sentence


def test_a_mode_that_is_meant_to_last_is_not(tmp_path) -> None:
    forgotten = '        Transition("tick", "idle", "on", whole, reset=tick),\n'
    source = CONVERTER.replace(forgotten, "").replace('"idle", idle,', '"idle", idle, "it is broken then",')
    assert troubles(tmp_path, source) == []


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("def current(t, x, p):", "def current(x, t, p):"),
        ("return p.T - x[1]", "return p['T'] - x[1]"),
    ],
)
def test_arguments_of_another_kind_are_told_by_the_form(tmp_path, right, wrong) -> None:
    found = troubles(tmp_path, CONVERTER.replace(right, wrong))[0]
    assert found.level == "error"
    assert "Its form is guard(t, x, p), with parameters as p.name." in found.sentence

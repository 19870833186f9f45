"""Ramps and pulses in guards: orbits whose events come, or would come, by a jump or at a corner are refused.

x' = E - x rests at E, so that the value of E at which the event begins to happen is known.
"""

from __future__ import annotations

import pytest

import contwalk as cw
from contwalk.plugin_check.system import check_reference

PLUGIN = """\
import numpy as np
from contwalk.system import Mode, Parameter, State, System, Transition

def on(t, x, p, dx):
    dx[0] = p.E - x[0]

def off(t, x, p, dx):
    dx[0] = -x[0]

def ramp(t, x, p):
    return x[0] - (GUARD)

SYSTEM = System(
    "converter",
    states=(State("x"),),
    parameters=(Parameter("E", 0.3),),
    modes=(Mode("on", on), Mode("off", off)),
    transitions=(
        Transition("open", "on", "off", ramp, "rising"),
        Transition("close", "off", "on", ramp, "falling"),
    ),
    period=lambda p: 1.0,
)
"""
RUN = """\
contwalk: 1
system: ./converter.py
start: {simulate: {state: {x: 0.2}, until: settled}}
continue: {parameter: E, range: [0.2, MOST]}
diagram: none
output: out.h5
"""
GUARD_LINE = 1 + PLUGIN[: PLUGIN.index("GUARD")].count("\n")


def branch(folder, guard, most=0.6, **given):
    (folder / "converter.py").write_text(PLUGIN.replace("GUARD", guard))
    (folder / "run.yaml").write_text(RUN.replace("MOST", str(most)))
    overrides = [f"parameters.{name}={value}" for name, value in given.items()]
    study = cw.read_run_file(folder / "run.yaml", overrides, output=folder / "out.h5")
    return cw.run(study, figures=False).branches[0]


@pytest.mark.drawn(1)
@pytest.mark.parametrize(
    ("guard", "what"),
    [
        ("0.5 + 0.9 * (t % 1.0)", "jumps through zero"),  # just where the orbit closes
        ("0.7 + 0.2 * np.sign(np.sin(2 * np.pi * (t + 0.1)))", "jumps through zero"),
        ("0.5 + 0.2 * np.floor(3 * (t % 1.0))", "jumps through zero"),
        ("0.5 + 0.2 * abs((t + 0.2) % 1.0 - 0.5)", "comes to zero at a corner"),
        ("0.6 - 0.2 * abs(t % 1.0 - 0.5)", "comes to zero at a corner"),  # where the orbit closes
    ],
)
def test_orbits_without_the_event_end_where_it_begins_to_happen(tmp_path, guard, what):
    found = branch(tmp_path, guard)
    assert found["E"].max() == pytest.approx(0.5, abs=1e-7)
    assert found.outcome.reason == "plugin_error"
    assert f"the guard of transition 'open' {what}: {tmp_path}" in found.outcome.message
    assert f"converter.py, line {GUARD_LINE}" in found.outcome.message


def test_a_smooth_touch_of_a_guard_of_pieces_is_located(tmp_path):
    found = branch(tmp_path, "0.9 - max(0.4 * np.sin(2 * np.pi * t), -9.0)")
    assert "GR1" in [point.name for point in found.special_points]
    assert found.outcome.reason == "grazing"
    assert found["E"].max() == pytest.approx(0.5, abs=1e-9)


def test_a_start_whose_event_is_a_jump_is_refused_with_the_line(tmp_path):
    found = branch(tmp_path, "0.5 + 0.9 * (t % 1.0)", 2.0, E=1.5)
    assert found.outcome.status == "failed"
    assert (
        f"line {GUARD_LINE - 1}: the guard of transition 'open' jumps through zero at t = "
        in found.outcome.message
    )


@pytest.mark.drawn(1)
@pytest.mark.parametrize(
    ("guard", "told"),
    [
        ("0.5 + 0.9 * (t % 1.0)", {"open": "floor"}),
        ("0.7 + 0.2 * np.sign(np.sin(2 * np.pi * t))", {"open": "sign", "close": "sign"}),
        ("0.7 + 0.2 * abs(t % 1.0 - 0.5)", {}),
    ],
)
def test_the_check_tells_of_jumps_in_the_direction_of_the_event(tmp_path, guard, told):
    (tmp_path / "converter.py").write_text(PLUGIN.replace("GUARD", guard))
    found = [
        f for f in check_reference("./converter.py", tmp_path) if "jumps at instants of time" in f.sentence
    ]
    assert [(f.level, f.line) for f in found] == [("warning", GUARD_LINE)] * len(told)
    expected = {f"guard of transition '{name}'": what for name, what in told.items()}
    assert {f.what: f.sentence.split("(")[1].split(")")[0] for f in found} == expected

"""What jumps or has a corner at a value of a parameter, whatever the states are: the check tells it."""

from __future__ import annotations

import pytest

from contwalk.plugin_check.system import check_reference

PLUGIN = """\
import math
import numpy as np
from contwalk.system import Mode, Parameter, State, System, Transition

def period(p):
    return PERIOD

def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -9.81 + 2.0 * math.cos(2.0 * math.pi * t / period(p)) + FIELD

def touch(t, x, p):
    return x[0] - GUARD

def rebound(t, x, p, after):
    after[0] = x[0]
    after[1] = -0.5 * x[1] * RESET

SYSTEM = System(
    "ball", about="a ball on a table", reference="none",
    states=(State("x", unit="m", about="height"), State("v", unit="m/s", about="rate")),
    parameters=(
        Parameter("a", 0.2, unit="1", bounds=(0.0, 1.0), about="in a range"),
        Parameter("b", 1.0, unit="1", about="any"),
    ),
    modes=(Mode("flight", field),),
    transitions=(Transition("touch", "flight", "flight", touch, "falling", reset=rebound),),
    period=period,
)
"""
SMOOTH = {"PERIOD": "1.0", "FIELD": "0.0", "GUARD": "0.0", "RESET": "1.0"}


def warnings(folder, **given):
    source = PLUGIN
    for name, text in {**SMOOTH, **given}.items():
        source = source.replace(name, text)
    (folder / "ball.py").write_text(source)
    found = check_reference("./ball.py", folder)
    assert [f.sentence for f in found if f.level == "error"] == []
    told = [f for f in found if "whatever the states are" in f.sentence]
    assert {f.level for f in told} <= {"warning"}
    return [(f.what, f.line, f.sentence) for f in told]


def line_of(name):
    return 1 + PLUGIN[: PLUGIN.index(name)].count("\n")


@pytest.mark.parametrize(
    ("name", "of"),
    [
        ("PERIOD", "period"),
        ("FIELD", "field of mode 'flight'"),
        ("GUARD", "guard of transition 'touch'"),
        ("RESET", "reset of transition 'touch'"),
    ],
)
def test_a_jump_is_told_with_its_value_and_line(tmp_path, name, of):
    (told,) = [each for each in warnings(tmp_path, **{name: "(1.0 if p.a < 0.3 else 1.2)"}) if each[0] == of]
    assert told[:2] == (of, line_of(name))
    assert told[2].startswith(f"At a = 0.3, whatever the states are, the {of} jumps: a comparison.")


def test_corners_and_parameters_without_bounds_are_told(tmp_path):
    (told,) = warnings(tmp_path, FIELD="abs(p.b - 2.5)")
    assert told[:2] == ("field of mode 'flight'", line_of("FIELD"))
    assert "At b = 2.5, whatever the states are, slopes of the field of mode 'flight' jump: abs." in told[2]


def test_several_values_are_one_finding(tmp_path):
    (told,) = warnings(tmp_path, GUARD="0.01 * math.floor(4.0 * p.a)")
    assert told[2].startswith("At a = 0.25,")
    assert told[2].endswith("So it is at 3 more values.")


@pytest.mark.parametrize(
    "field",
    [
        "(1.0 if p.a < 1.5 else 2.0)",  # beyond its bounds
        "abs(p.a)",  # of one sign there
        "(p.a if p.a > 0.5 else (p.a - 0.5) + 0.5)",  # the same on both sides
        "abs(x[0])",  # of a state
    ],
)
def test_nothing_is_told_where_nothing_changes_with_a_parameter(tmp_path, field):
    assert warnings(tmp_path, FIELD=field) == []

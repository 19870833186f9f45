"""Guards in any units: what is found of a machine does not depend on the size of their numbers."""

from __future__ import annotations

import pytest

import contwalk as cw
from contwalk.plugin_check.system import check_system

PLUGIN = """\
import math
from contwalk.system import Mode, Parameter, State, System, Transition

def field(t, x, p, dx):
    dx[0], dx[1] = x[1], -x[0] - 0.1 * x[1] + p.a * math.cos(2.0 * t)

def guard(t, x, p):
    return UNIT * (x[0] + 0.05)

def reset(t, x, p, x_plus):
    x_plus[0], x_plus[1] = x[0], -0.6 * x[1]

SYSTEM = System("impacting", states=(State("x", scale=1.0), State("v", scale=1.0)),
    parameters=(Parameter("a", 0.5),), modes=(Mode("m", field),), period=lambda p: math.pi,
    transitions=(Transition("hit", "m", "m", guard, reset=reset),))
"""
RUN = """\
contwalk: 1
system: ./impacting.py
start: {simulate: {state: {x: 0.3, v: 0.0}, until: settled}}
continue: {parameter: a, range: [0.1, 0.6]}
diagram: none
output: out.h5
"""


def study(folder, unit):
    (folder / "impacting.py").write_text(PLUGIN.replace("UNIT", unit))
    (folder / "run.yaml").write_text(RUN)
    run = cw.read_run_file(folder / "run.yaml", output=folder / "out.h5")
    return cw.run(run, figures=False, force=True).branches[0]


@pytest.mark.long
@pytest.mark.parametrize("unit", ["1e-300", "1e-200", "1e-12", "1e200", "1e300"])
def test_special_points_and_their_errors_are_those_in_units_of_one(tmp_path, unit):
    known, found = study(tmp_path, "1.0"), study(tmp_path, unit)
    assert [point.label for point in found.special_points] == [point.label for point in known.special_points]
    for one, other in zip(found.special_points, known.special_points, strict=True):
        assert one.status == other.status
        assert one.parameters["a"] == pytest.approx(other.parameters["a"], rel=1e-12)
        assert one.error <= 3.0 * other.error + 1e-15


@pytest.mark.parametrize("unit", ["1e-300", "1e-200", "1e200", "1e300"])
def test_the_check_finds_where_such_a_guard_is_zero(tmp_path, unit):
    (tmp_path / "impacting.py").write_text(PLUGIN.replace("UNIT", unit))
    findings = check_system(cw.load_system(str(tmp_path / "impacting.py")))
    assert not [f for f in findings if f.level != "ok" and "guard" in f.what]

"""Fields that cease to have a value along a branch of orbits without events: told with the plugin's line."""

from __future__ import annotations

import warnings

import pytest

import contwalk as cw

# The oscillator of van der Pol, autonomous or forced.
PLUGIN = """\
import math
import numpy as np
from contwalk.system import Mode, Parameter, State, System

def turns(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = DAMPING * (1.0 - x[0] ** 2) * x[1] - x[0] + FORCE
    dx[1] += WRONG

SYSTEM = System(
    name="oscillator",
    states=(State("x"), State("y")),
    parameters=(Parameter("mu", 0.5),),
    modes=(Mode("all", turns),),
    PERIOD
)
"""
RUN = """\
contwalk: 1
system: ./oscillator.py
start: {simulate: {state: {x: 2.0, y: 0.1}, until: settled}}
continue: {parameter: mu, range: [0.4, 1.6], direction: forward}
diagram: none
output: out.h5
"""
AUTONOMOUS = PLUGIN.replace("DAMPING", "p.mu").replace("FORCE", "0.0").replace("    PERIOD\n", "")
FORCED = PLUGIN.replace("DAMPING", "(0.5 + 0.1 * p.mu)").replace("FORCE", "0.1 * math.cos(t)")
FORCED = FORCED.replace("PERIOD", "period=lambda p: 2.0 * math.pi,")


def branch_of(folder, plugin, wrong):
    source = plugin.replace("WRONG", wrong)
    (folder / "oscillator.py").write_text(source)
    (folder / "run.yaml").write_text(RUN)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = cw.run(cw.read_run_file(folder / "run.yaml", output=folder / "out.h5"), figures=False)
    return result.branches[0], 1 + source[: source.index(wrong)].count("\n")


@pytest.mark.drawn(2)
@pytest.mark.parametrize("plugin", [AUTONOMOUS, FORCED], ids=["autonomous", "forced"])
@pytest.mark.parametrize("wrong", ["1e-3 * math.sqrt(1.1 - p.mu) * x[1]", "1e-9 * math.sqrt(1.1 - p.mu)"])
def test_the_line_is_told_where_the_parameter_leaves_the_domain(tmp_path, plugin, wrong):
    branch, line = branch_of(tmp_path, plugin, wrong)
    assert (branch.outcome.status, branch.outcome.reason) == ("failed", "not_finite")
    assert 0.0 <= 1.1 - branch["mu"].max() < 1e-6
    assert (
        f"The field of mode 'all': {tmp_path}/oscillator.py, line {line}: sqrt of -" in branch.outcome.message
    )


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ("1e-3 * math.sqrt(8.0 - x[1] ** 2)", "sqrt of -"),
        ("0.0 if x[1] < 3.0 else math.nan", "nan is nan"),
        ("0.0 if x[1] < 3.0 else unknown", "NameError"),
    ],
)
def test_the_line_is_told_where_the_motion_leaves_the_domain(tmp_path, wrong, said):
    """Its amplitude grows: between its steps the orbit comes to where the field has no value."""
    branch, line = branch_of(tmp_path, AUTONOMOUS, wrong)
    assert (branch.outcome.status, branch.outcome.reason) == ("failed", "not_finite")
    assert f"The field of mode 'all': {tmp_path}/oscillator.py, line {line}: " in branch.outcome.message
    assert said in branch.outcome.message
    bound = 3.0 if "3.0" in wrong else 8.0**0.5
    # The largest value of a sample lies at the top of a parabola.
    assert branch["max:y"].max() == pytest.approx(bound, rel=1e-2)
    assert branch["max:y"].max() <= bound * (1.0 + 1e-9)


def test_a_field_with_a_value_everywhere_ends_nothing(tmp_path):
    branch, _ = branch_of(tmp_path, AUTONOMOUS, "1e-3 * math.sqrt(1.7 - p.mu)")
    assert branch.outcome.reason == "bound"

"""Branches that come to the edge of the domain of a plugin's function, where its slope is infinite."""

from __future__ import annotations

import pytest

import contwalk as cw

STILL = """\
import math
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0] = {term} - x[0] - x[0]**3

SYSTEM = System("small", states=(State("x"),), parameters=(Parameter("a", 0.6),), modes=(Mode("m", field),))
"""
BOUNCING = """\
import math
from contwalk.system import Mode, Parameter, State, System, Transition

def field(t, x, p, dx):
    dx[0], dx[1] = x[1], -x[0] - 0.1 * x[1] + p.a * math.cos(2.0 * t)

def reset(t, x, p, x_plus):
    x_plus[0], x_plus[1] = x[0], -(0.6 - 0.3 * {term}) * x[1]

SYSTEM = System("small", states=(State("x"), State("v")), parameters=(Parameter("a", 0.5),),
    modes=(Mode("m", field),), period=lambda p: math.pi,
    transitions=(Transition("hit", "m", "m", lambda t, x, p: x[0] + 0.05, reset=reset),))
"""


def ended(folder, plugin, start, low, high=0.6):
    """The branch that goes from `high` down to `low`."""
    (folder / "small.py").write_text(plugin)
    (folder / "run.yaml").write_text(
        f"contwalk: 1\nsystem: ./small.py\nstart: {start}\n"
        f"continue: {{parameter: a, range: [{low}, {high}], direction: backward}}\noutput: out.h5\n"
    )
    run = cw.read_run_file(folder / "run.yaml", output=folder / "out.h5")
    return cw.run(run, figures=False).branches[0]


@pytest.mark.drawn(3)
@pytest.mark.parametrize("low", [0.1, 0.3])
@pytest.mark.parametrize("term", ["math.sqrt(p.a - 0.3)", "10 * math.sqrt(p.a - 0.3)", "(p.a - 0.3)**0.1"])
def test_equilibria_end_at_the_edge_with_the_line(tmp_path, term, low):
    branch = ended(tmp_path, STILL.format(term=term), "{state: {x: 0.1}}", low)
    assert branch.outcome.reason in ("not_finite", "bound")  # a range may end right there
    if branch.outcome.reason == "not_finite":
        assert "small.py, line 5: " in branch.outcome.message
    # Steps that double the way lead from it to the edge in some forty points; the tenth root takes more.
    assert len(branch) < 150
    assert branch["a"].min() == pytest.approx(0.3, abs=1e-10)


def test_equilibria_that_do_grow_without_bound_there_are_told_so(tmp_path):
    branch = ended(tmp_path, STILL.format(term="math.log(p.a - 0.3)"), "{state: {x: 0.1}}", 0.1)
    assert branch.outcome.reason == "unbounded"


@pytest.mark.drawn(1)
@pytest.mark.parametrize("power", [0.5, 0.2, 0.1])
def test_orbits_do_not_pile_up_before_the_edge(tmp_path, power):
    plugin = BOUNCING.format(term=f"(p.a - 0.3)**{power}")
    start = "{simulate: {state: {x: 0.3, v: 0.0}, until: settled}}"
    branch = ended(tmp_path, plugin, start, 0.1)
    assert branch.outcome.reason == "not_finite"
    assert "small.py, line 8: " in branch.outcome.message
    assert branch["a"].min() == pytest.approx(0.3, abs=1e-10)
    assert len(branch) < 150

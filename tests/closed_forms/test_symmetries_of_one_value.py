"""Symmetries that a machine has for one value of its parameter alone: orbits there are not closed up to them.

An oscillator under F cos t is its own image half a period later, and under a cos 2t beside it no longer.
Where it is linear its orbit is the sum of both responses.
"""

import math

import numpy as np
import pytest
from plugin_runs import run_text

import contwalk as cw
from contwalk.errors import StartError

PLUGIN = """
import math
from contwalk.system import Mode, Parameter, State, Symmetry, System, Transition

def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -0.2 * x[1] - 3.0 * x[0] - p.k * x[0] ** 3 + p.F * math.cos(t) + p.a * math.cos(2.0 * t)

def turned(t, x, p, y):
    y[0], y[1] = -x[0], -x[1]

def bounce(t, x, p, after):
    after[0], after[1] = x[0], -0.6 * x[1]

SYSTEM = System(
    "harmonics",
    states=(State("x"), State("v")),
    parameters=(Parameter("F", {force}), Parameter("a", 0.0), Parameter("k", {cubic})),
    modes=(Mode("free", field),),
    transitions=({walls}),
    symmetries=(Symmetry("turned", "spatial", turned, events={events}),),
    period=lambda p: 2.0 * math.pi,
)
"""
WALLS = """
        Transition("up", "free", "free", lambda t, x, p: 1.0 - x[0], reset=bounce),
        Transition("down", "free", "free", lambda t, x, p: 1.0 + x[0], reset=bounce),
"""
SETTLED = "start: {simulate: {state: {x: 0.1, v: 0.0}, until: settled}}\n"
OVER_A = "continue: {parameter: a, range: [0.0, 0.5]}\n"


def written(folder, force, cubic=0.0, hits=False):
    walls = WALLS if hits else ""
    events = {"up": "down", "down": "up"} if hits else {}
    text = PLUGIN.format(force=force, cubic=cubic, walls=walls, events=events)
    (folder / "small.py").write_text(text, encoding="utf-8")


def test_an_orbit_begun_without_a_second_harmonic_is_that_with_one_where_there_is_one(tmp_path):
    written(tmp_path, force=1.0)
    twice = SETTLED.replace("start: ", "start: [").replace("}}\n", "}}, {state: {x: 0.5, v: 0.1}}]\n")
    result = run_text(tmp_path, twice + OVER_A)
    (branch,) = result.branches  # the second start, where the parameter is zero too, is known
    assert branch.info.closure == "full"
    for a, x, v in zip(branch["a"], branch["x"], branch["v"], strict=True):
        response = [1.0 / (3.0 - 1.0 + 0.2j), a / (3.0 - 4.0 + 0.4j)]
        # Told where x passes its middle or at t = 0: the closed form, at the time at which both agree.
        times = np.linspace(0.0, 2.0 * math.pi, 20001)
        place = sum((r * np.exp(1j * k * times)).real for k, r in enumerate(response, 1))
        rate = sum((1j * k * r * np.exp(1j * k * times)).real for k, r in enumerate(response, 1))
        # Between two of these times a motion of rates up to 1 goes 3e-4 at most.
        assert np.min(np.hypot(place - x, rate - v)) < 3e-4


@pytest.mark.slow
def test_a_stored_half_is_the_whole_orbit_where_the_parameter_breaks_the_symmetry(tmp_path):
    written(tmp_path, force=5.0, hits=True)
    over_force = "continue: {parameter: F, range: [4.0, 6.0]}\nmark: {F: 5.5}\n"
    (halves,) = run_text(tmp_path, SETTLED + over_force, "halves").branches
    assert halves.info.closure == "turned"
    again = "start: {from: halves.h5, point: b1/UZ1}\n" + OVER_A
    (stored,) = run_text(tmp_path, again, "stored").branches
    (simulated,) = run_text(tmp_path, SETTLED + OVER_A + "parameters: {F: 5.5}\n", "simulated").branches
    ends = []
    for branch in (stored, simulated):
        assert branch.info.closure == "full"
        assert branch.outcome.reason == "bound"
        ends.append(branch["max_abs"][np.argmax(branch["a"])])
    # Points of a branch are known to about 1e-8, and multipliers to little less.
    assert ends[0] == pytest.approx(ends[1], rel=1e-6)


@pytest.mark.long
def test_no_curve_is_followed_of_orbits_that_would_have_to_keep_it(tmp_path):
    written(tmp_path, force=2.0, cubic=1.0)
    over_force = "continue: {parameter: F, range: [1.0, 30.0]}\ndiagram: none\n"
    (branch,) = run_text(tmp_path, SETTLED + over_force, "broken").branches
    point = next(p for p in branch.special_points if p.kind == "symmetry-breaking")
    curve = f"start: {{from: broken.h5, point: b1/{point.name}}}\n"
    curve += "continue: {parameters: [F, a], range: {F: [1.0, 30.0], a: [-0.3, 0.3]}}\n"
    with pytest.raises((StartError, cw.ContwalkError), match="'turned', which holds at a = 0 and not beside"):
        run_text(tmp_path, curve, "curve")

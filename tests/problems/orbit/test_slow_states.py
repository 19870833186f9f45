"""States that hardly move over an orbit, and far along its branch: the metric weighs them as their way."""

from __future__ import annotations

import math

import numpy as np
import pytest
from plugin_runs import run_text, write_plugin
from small_systems import small_problem

import contwalk as cw
from contwalk.continuation.marks import observer_of
from contwalk.continuation.pseudo_arclength import Earlier, walk
from contwalk.continuation.settings import Settings
from contwalk.diagram.rows import from_row
from contwalk.problems.restoring import problem_of


def burster(t, x, p, dx):
    """A cycle of period 2 pi whose radius is the root of a slow state, which follows the parameter."""
    u, v, slow = x
    r2 = u * u + v * v
    dx[0] = (slow - r2) * u - v
    dx[1] = (slow - r2) * v + u
    dx[2] = p.eps * (p.a - slow + u)


def carried(t, x, p, dx):
    """A circle of radius 0.01 about (a, b a)."""
    u, v = x[0] - p.a, x[1] - p.b * p.a
    grow = 1.0 - 1e4 * (u * u + v * v)
    dx[0] = grow * u - v
    dx[1] = grow * v + u


def cycles(field, states, values, begin, ends, **given):
    system = small_problem(field, states, values, "a").system
    problem = cw.PeriodicOrbit(system, system.defaults(), "a")
    return cw.continue_branch(problem, begin, ends, period=2.0 * math.pi, **given)


def test_a_slow_state_does_not_take_the_whole_arclength():
    """Over an orbit it moves by 1e-5 of what it moves along the branch, which crept to max_points."""
    branch = cycles(burster, "uvs", {"a": 0.25, "eps": 1e-4}, [0.5, 0.0, 0.25], (0.25, 1.0))
    assert branch.outcome.reason == "bound", branch.outcome
    assert len(branch.points) < 450
    np.testing.assert_allclose(branch.points["period"], 2.0 * math.pi, rtol=1e-6)
    # A slow state is the parameter but for its ripple, and weighs as a quarter of the way from the beginning.
    assert branch.points["weights"][-1, 2] == pytest.approx(0.25 * 0.75, rel=1e-2)


@pytest.mark.drawn(1)
@pytest.mark.parametrize(("b", "weights"), [(0.0, (0.025, 0.01)), (1.0, (0.01, 0.01)), (0.5, (0.02, 0.01))])
def test_of_small_cycles_one_state_weighs_as_over_its_orbit(b, weights):
    """Cycles that are carried by ten times their size: what becomes of their size would be hidden else."""
    branch = cycles(carried, "uv", {"a": 1.0, "b": b}, [1.01, b], (1.0, 1.1))
    assert branch.outcome.reason == "bound", branch.outcome
    np.testing.assert_allclose(branch.points["weights"][-1, :2], weights, rtol=2e-2)


def test_ripples_of_a_weak_force_do_not_shorten_the_steps(tmp_path):
    """Orbits that leave a pitchfork, and ripple by 1e-3 of their height: steps were 1e-4 of that."""
    write_plugin(
        tmp_path, "dx[0] = (p.a + 0.01 * math.cos(2.0 * math.pi * t)) * x[0] - x[0] ** 3", "x", a=-0.1
    )
    plugin = tmp_path / "small.py"
    text = plugin.read_text(encoding="utf-8").replace("    modes=", "    period=lambda p: 1.0,\n    modes=")
    plugin.write_text("import math\n" + text, encoding="utf-8")
    result = run_text(tmp_path, "start: {state: {x: 0.0}}\ncontinue: {parameter: a, range: [-0.1, 1.0]}\n")
    _, branch = result.branches
    assert branch.outcome.reason == "bound", branch.outcome
    # Steps of a tenth of a quarter of the way: 260 to each side from 1e-3 of the height.
    assert len(branch.points) < 520
    # By Bernoulli the mean of x^2 over a period is that of the growth, a; x^2 ripples by 0.01 / pi of itself.
    assert branch["max:x"].max() == pytest.approx(1.0, abs=0.01)


def test_a_branch_goes_on_with_the_weights_of_the_whole_one():
    """How far a state has come counts from where the branch began, and not from where a walk was stopped."""
    values, ends = {"a": 0.25, "eps": 1e-3}, (0.25, 1.0)
    system = small_problem(burster, "uvs", values, "a").system
    branch = cycles(burster, "uvs", values, [0.5, 0.0, 0.25], ends, max_points=60)
    rows, stopped = branch.points[~branch.points["special"]], 8
    assert rows["weights"][-1, 2] > 1.5 * rows["weights"][stopped, 2]  # not as its ripple, which is the same
    problem = problem_of(system, branch.info, rows["unknowns"][0, :3])
    begun = from_row(problem, rows[0], 1.0, False)[1]
    place = from_row(problem, rows[stopped], 1.0, False)
    observer, left = observer_of(problem), len(rows) - 1 - stopped
    points = walk(*place, Settings(range=ends), observer, 1.0, left, earlier=Earlier(begun))
    for row, point in zip(rows[stopped + 1 :], points, strict=False):
        sample = point.state.sample
        np.testing.assert_array_equal(sample.z[:-1], row["unknowns"][: len(sample.z) - 1])
        np.testing.assert_array_equal(sample.weights, row["weights"][: len(sample.z)])

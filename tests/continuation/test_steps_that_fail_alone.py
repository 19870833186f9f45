"""Steps of an implicit method that do not converge where each is begun anew are taken in parts, and those
that do not converge from where the step before leads are begun anew."""

from pathlib import Path

import numpy as np
import pytest
from plugin_runs import run_text, write_plugin
from small_systems import small_system

import contwalk as cw


def oregonator(t, x, p, dx):
    dx[0] = (x[0] * (1.0 - x[0]) - p.f * x[1] * (x[0] - p.q) / (x[0] + p.q)) / p.eps
    dx[1] = x[0] - x[1]


@pytest.mark.slow
def test_a_branch_goes_on_where_a_step_alone_does_not_converge():
    system = small_system(oregonator, "xz", {"f": 0.4, "eps": 0.04, "q": 8e-4})
    s = 1.0 - 0.4 - 8e-4  # x = z at rest: x^2 - s x - (1 + f) q = 0
    x = 0.5 * (s + np.sqrt(s * s + 4.0 * 1.4 * 8e-4))
    problem = cw.Equilibrium(system, system.defaults(), "f")
    rest = cw.continue_branch(problem, [x, x], (0.3, 3.0))
    orbits = cw.switch_branch(problem, rest, "HB2", (0.3, 3.0), max_points=125)
    # It ended in the explosion, at its 116th point.
    assert orbits.outcome.reason == "max_points"


ROUND = """
r = (x[0] ** 2 + x[1] ** 2) ** 0.5
turning = p.mu - x[1] / r
dx[0] = x[0] * (1.0 - r * r) - x[1] * turning
dx[1] = x[1] * (1.0 - r * r) + x[0] * turning
"""


@pytest.mark.long
def test_a_cycle_is_followed_to_the_saddle_node_on_it(tmp_path: Path) -> None:
    """On the circle an angle turns at mu - sin(angle), with the period 2 pi / sqrt(mu^2 - 1).

    It ended at periods of 4800, as not finite: a step out of the slow place had no solution.
    """
    write_plugin(tmp_path, ROUND, "xy", mu=1.0001)
    result = run_text(
        tmp_path,
        "start: {simulate: {state: {x: 1.0, y: 0.1}, until: settled}}\n"
        "continue: {parameter: mu, range: [0.5, 1.001], direction: down}\n",
    )
    (branch,) = result.branches
    assert branch.outcome.reason == "homoclinic", branch.outcome.message
    told = branch.outcome.message.split(" at mu = ")[1].split(", by")[0].split(" +- ")
    assert abs(float(told[0]) - 1.0) <= float(told[1])
    exact = 2.0 * np.pi / np.sqrt(branch["mu"] ** 2 - 1.0)
    # mu is known to some roundings, which mu - 1 > 1e-7 makes 1e-8 of the period.
    np.testing.assert_allclose(branch["period"], exact, rtol=1e-6)

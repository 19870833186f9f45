"""Where an orbit begins: where the flow crosses its section well, and right before the jump if it jumps."""

import numpy as np
import pytest
from small_systems import small_problem

import contwalk as cw
from contwalk.problems.orbit.section import better_phase

TIMES = (np.arange(1000) + 0.5) / 1000.0
LENGTHS = np.full(1000, 1e-3)


def jumping(peak, begun=0.0, width=0.004):
    """Speeds of an orbit that is steady but for a jump at `peak`, seen from an instant `begun`."""
    apart = (TIMES + begun - peak + 0.5) % 1.0 - 0.5
    return 1.0 + 200.0 * np.exp(-((apart / width) ** 2))


def test_an_orbit_without_jumps_begins_where_it_is_not_slow():
    speeds = 1.0 + 0.9 * np.cos(2.0 * np.pi * TIMES)
    assert better_phase(TIMES, speeds, LENGTHS) is None
    slow_at_first = 1.0 - 0.98 * np.cos(2.0 * np.pi * TIMES)
    assert better_phase(TIMES, slow_at_first, LENGTHS) == pytest.approx(0.5, abs=2e-3)


@pytest.mark.parametrize("peak", [0.3, 0.77, 0.999])
def test_an_orbit_that_jumps_begins_right_before_its_jump(peak):
    better = better_phase(TIMES, jumping(peak), LENGTHS)
    # It has ten times its mean speed (of 2.4) where the square of (t - peak) / width is log(200 / 23).
    assert better == pytest.approx(peak - 0.004 * np.sqrt(np.log(200.0 / 23.2)), abs=1.5e-3)
    assert better_phase(TIMES, jumping(peak, better), LENGTHS) is None
    assert better_phase(TIMES, jumping(peak, better - 0.01), LENGTHS) is None  # not far from it


def test_an_orbit_that_has_just_jumped_does_not_begin_there():
    better = better_phase(TIMES, jumping(0.5, 0.51), LENGTHS)
    assert better == pytest.approx(0.5 - 0.51 - 0.004 * np.sqrt(np.log(200.0 / 23.2)) + 1.0, abs=1.5e-3)


def reactor(t, x, p, dx):
    rate = p.p1 * (1.0 - x[0]) * np.exp(x[1])
    dx[0] = rate - x[0]
    dx[1] = 18.0 * rate - 4.0 * x[1]


@pytest.mark.slow
@pytest.mark.long
def test_steps_are_long_where_a_jump_comes_later_and_later():
    """AUTO's demo `ab` at p2 = 18: x jumps within a ten thousandth of a period that grows from 3 on. Up to
    its homoclinic end AUTO takes 372 steps; with a section long before the jump a thousand did not do."""
    problem = small_problem(reactor, "uv", {"p1": 0.0}, "p1")
    equilibria = cw.continue_branch(problem, [0.0, 0.0], (0.0, 0.25))
    cycle = cw.switch_branch(problem, equilibria, "HB2", (0.0, 0.25), max_points=300)
    assert cycle.outcome.reason == "homoclinic"
    assert cycle["p1"][-1] == pytest.approx(0.11011357816, abs=1e-9)  # AUTO at period 500

"""Explosions of cycles: deviations grow over millions and are forgotten again."""

import numpy as np
import pytest
from small_systems import labelled, small_problem, small_system

import contwalk as cw
from contwalk.problems.orbit.discretization import Discretization
from contwalk.verification.points import checked_point

# The fold of cycles of AUTO's demo `ab` at p2 = 16, as single shooting finds it.
FOLD = 0.1306373152262


def reactor(t, x, p, dx):
    rate = p.p1 * (1.0 - x[0]) * np.exp(x[1])
    dx[0] = rate - x[0]
    dx[1] = 16.0 * rate - 4.0 * x[1]


def test_the_fold_of_an_explosion_is_located():
    """The parameter moves by 1e-9 while the period falls by a tenth."""
    problem = small_problem(reactor, "uv", {"p1": 0.0}, "p1")
    equilibria = cw.continue_branch(problem, [0.0, 0.0], (0.0, 0.25))
    cycle = cw.switch_branch(problem, equilibria, "HB1", (0.0, 0.25), max_points=300)
    (fold,) = labelled(cycle, "LP", "BP")
    assert fold.status == "located"
    assert abs(fold.parameters["p1"] - FOLD) <= fold.error + 1e-13  # digits of the value above
    counts = cycle["unstable"][~cycle["special"]]
    assert np.all(counts[1 : fold.index // 2] == 1)
    assert counts[-1] == 0


def nerve(t, x, p, dx):
    dx[0] = x[0] - x[0] ** 3 / 3.0 - x[1] + p.I
    dx[1] = 0.08 * (x[0] + 0.7 - 0.8 * x[1])


@pytest.mark.long
def test_a_fold_at_which_the_parameter_stands_still_is_located():
    """FitzHugh-Nagumo: I moves by 1e-11 while the period goes from 66 to 69. The image of an orbit at I under
    (v, w) -> (-v, 7/4 - w) is one at 7/4 - I: the family's two folds add up to that, and have one period."""
    problem = small_problem(nerve, "vw", {"I": 0.0}, "I")
    equilibria = cw.continue_branch(problem, [-1.2, -0.6], (0.0, 2.0))
    cycle = cw.switch_branch(problem, equilibria, "HB1", (0.0, 2.0))
    low, high = labelled(cycle, "LP", "BP")
    assert (low.status, high.status) == ("located", "located")
    values = [fold.parameters["I"] for fold in (low, high)]
    assert abs(sum(values) - 1.75) <= low.error + high.error
    assert low.error + high.error <= 1e-8  # what is asked for
    assert abs(values[0] - 0.3241785225) <= low.error + 5e-11  # the digits that AUTO-07p tells
    # Where the multiplier passes one the period is known as the multiplier is: it grows by 3 in 0.3.
    assert low.period == pytest.approx(high.period, rel=1e-6)
    for fold in (low, high):
        assert abs(fold.spectrum[0] - 1.0) <= 1e-5
        again = checked_point(problem.system, cycle, fold)
        assert not again.failed, again


def steep(t, x, p, dx):
    dx[0] = x[0] - x[0] ** 3 / 3.0 - x[1] + p.I
    dx[1] = 0.01 * (x[0] + 0.7 - 0.8 * x[1])


@pytest.mark.drawn(1)
@pytest.mark.parametrize(
    ("chosen", "told"),
    [
        ({"scheme": "shooting"}, "`engine: {discretization: auto}`"),
        ({"segments": 4}, "`engine: {segments: 16}`"),
        ({}, None),
    ],
    ids=["shooting", "segments", "default"],
)
def test_points_that_growth_uses_up_say_so_with_a_remedy(chosen, told):
    """FitzHugh-Nagumo with eps = 0.01: equal segments creep through the explosion, and never see its end."""
    system = small_system(steep, "vw", {"I": 0.0})
    problem = cw.Equilibrium(system, system.defaults(), "I", discretization=Discretization(**chosen))
    equilibria = cw.continue_branch(problem, [-1.2, -0.6], (0.0, 2.0))
    cycle = cw.switch_branch(problem, equilibria, "HB1", (0.0, 2.0), max_points=80)
    assert cycle.outcome.reason == "max_points"
    if told is None:
        assert "Deviations" not in cycle.outcome.message
    else:
        assert "Deviations grow by" in cycle.outcome.message
        assert told in cycle.outcome.message

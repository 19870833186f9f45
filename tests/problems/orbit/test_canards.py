"""Explosions of cycles: deviations grow over millions and are forgotten again."""

import numpy as np
from small_systems import labelled, small_problem

import contwalk as cw

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

"""Steps of an implicit method that do not converge where each is begun anew are taken in parts."""

import numpy as np
from small_systems import small_system

import contwalk as cw


def oregonator(t, x, p, dx):
    dx[0] = (x[0] * (1.0 - x[0]) - p.f * x[1] * (x[0] - p.q) / (x[0] + p.q)) / p.eps
    dx[1] = x[0] - x[1]


def test_a_branch_goes_on_where_a_step_alone_does_not_converge():
    system = small_system(oregonator, "xz", {"f": 0.4, "eps": 0.04, "q": 8e-4})
    s = 1.0 - 0.4 - 8e-4  # x = z at rest: x^2 - s x - (1 + f) q = 0
    x = 0.5 * (s + np.sqrt(s * s + 4.0 * 1.4 * 8e-4))
    problem = cw.Equilibrium(system, system.defaults(), "f")
    rest = cw.continue_branch(problem, [x, x], (0.3, 3.0))
    orbits = cw.switch_branch(problem, rest, "HB2", (0.3, 3.0), max_points=125)
    # It ended in the explosion, at its 116th point.
    assert orbits.outcome.reason == "max_points"

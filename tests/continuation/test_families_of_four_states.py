"""A family of cycles at one value of the parameter, zero, at which a machine of four states keeps its energy.

Beside the family's own multiplier stands a pair, which keeps to the unit circle until both meet: where steps
make its modulus pass one nothing is told, and where both meet at 1 or -1 a branch leaves.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp
from small_systems import small_problem

import contwalk as cw

RANGE, STIFFER = (-0.5, 0.5), 1.3


def coupled(t, x, p, dx):
    """Two oscillators, coupled as those of Henon and Heiles; mu takes energy away, or brings it."""
    dx[0], dx[1] = x[2], x[3]
    dx[2] = -x[0] - 2.0 * x[0] * x[1] + p.mu * x[2]
    dx[3] = -STIFFER * STIFFER * x[1] - (x[0] ** 2 - x[1] ** 2) + p.mu * x[3]


def half_trace(state, period):
    """Of deviations aside from the cycle along y, by Hill's equation."""

    def rates(t, s):
        y, v, a, b, c, d = s
        return [v, -STIFFER * STIFFER * y + y * y, b, -(1.0 + 2.0 * y) * a, d, -(1.0 + 2.0 * y) * c]

    begun = [state[1], state[3], 1.0, 0.0, 0.0, 1.0]
    end = solve_ivp(rates, (0.0, period), begun, method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    return 0.5 * (end[2] + end[5])


def test_a_pair_on_the_circle_tells_where_it_meets_and_nothing_else():
    problem = small_problem(coupled, "xyuv", {"mu": -0.2}, "mu")
    equilibria = cw.continue_branch(problem, [0.0] * 4, RANGE)
    cycles = cw.switch_branch(problem, equilibria, "HB1", RANGE, max_points=46)
    found = [point for point in cycles.special_points if point.label != "EP"]
    # How far the family is followed is a matter of its steps.
    met = ["BP", "BP", "PD", "PD", "BP", "BP"][: max(5, len(found))]
    assert [point.label for point in found] == met
    assert {point.status for point in found} == {"located"}
    counts = [(point.unstable_before, point.unstable_after) for point in found]
    assert counts == ([(0, 1), (1, 0)] * 3)[: len(met)]
    for point in found:
        told = half_trace(np.array(point.unknowns[:4]), point.period)
        assert abs(told - (1.0 if point.label == "BP" else -1.0)) < 1e-7
    for row in cycles.points[2::6]:
        half = abs(half_trace(row["state"], float(row["period"])))
        assert abs(half - 1.0) < 1e-8 or int(row["unstable"]) == int(half > 1.0)


def test_cycles_born_where_two_pairs_have_one_frequency():
    """As those of Henon and Heiles: the equations of the first order are singular there in two directions."""

    def alike(t, x, p, dx):
        coupled(t, x, p, dx)
        dx[3] += (STIFFER * STIFFER - 1.0) * x[1]

    problem = small_problem(alike, "xyuv", {"mu": -0.2}, "mu")
    equilibria = cw.continue_branch(problem, [0.0] * 4, RANGE)
    cycles = cw.switch_branch(problem, equilibria, "HB1", RANGE, max_points=6)
    assert cycles.outcome.reason == "max_points", cycles.outcome
    assert np.abs(cycles["mu"]).max() < 1e-6
    np.testing.assert_allclose(cycles["period"][0], 2.0 * np.pi, rtol=1e-12)

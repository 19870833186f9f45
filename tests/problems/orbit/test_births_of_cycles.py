"""Cycles leave the Hopf points that they are born at, whatever order their states move with."""

import numpy as np
import pytest
from hopf_systems import hopf_system
from small_systems import labelled, small_problem

import contwalk as cw
from contwalk.numerics.linear import nearest_eigenpair
from contwalk.problems.equilibrium.points.cycle_sizes import CycleSizes

RANGE = (0.5, 1.5)


def slaved(t, x, p, dx):
    """x2 follows with 0.01 times the square of x0: it has no share in the critical vector."""
    dx[0] = (p.lam - 1.0) * x[0] - x[1] - x[0] ** 3
    dx[1] = x[0] + (p.lam - 1.0) * x[1] - x[1] ** 3
    dx[2] = -0.64 * x[2] + 0.01 * x[0] ** 2


def hopf(problem, start):
    """The branch of equilibria and its Hopf point at lam = 1."""
    branch = cw.continue_branch(problem, start, RANGE)
    point = next(p for p in labelled(branch, "HB") if abs(p.parameters["lam"] - 1.0) < 1e-8)
    return branch, point


def test_a_state_that_follows_with_the_square_is_followed():
    problem = small_problem(slaved, "abc", {"lam": 0.8}, "lam")
    branch, point = hopf(problem, [0.0, 0.0, 0.0])
    cycle = cw.switch_branch(problem, branch, point, RANGE)
    assert cycle.outcome.reason == "bound"
    assert cycle["lam"].max() == RANGE[1]
    # x2 turns with the double frequency around its mean: 0.01 a^2 / 2 (1 / 0.64 + cos(...) / |0.64 + 2 i|).
    square = 4.0 / 3.0 * (cycle["lam"][1] - 1.0)
    low, high = (0.005 * square * (1.0 / 0.64 + s / np.hypot(0.64, 2.0)) for s in (-1.0, 1.0))
    # The normal form's next order is a part of the order of the amplitude's square, some 5e-4 here.
    assert 0.99 * low < cycle.points["state"][1, 2] < 1.01 * high


def test_a_circle_beside_a_state_that_grows():
    """W. F. Langford's, ISNM 70 (1984) 285: r' = (z - 0.7) r, so that all of second order moves z alone."""

    def field(t, x, p, dx):
        dx[0] = (x[2] - 0.7) * x[0] - 3.5 * x[1]
        dx[1] = 3.5 * x[0] + (x[2] - 0.7) * x[1]
        square = x[0] ** 2 + x[1] ** 2
        dx[2] = p.lam - 1.0 + 0.95 * x[2] - x[2] ** 3 / 3.0 - square * (1.0 + 0.25 * x[2])

    problem = small_problem(field, "abc", {"lam": 0.2}, "lam")
    born = 1.0 - 0.95 * 0.7 + 0.7**3 / 3.0
    branch = cw.continue_branch(problem, [0.0, 0.0, 1.8], (0.2, 3.0))
    point = next(p for p in labelled(branch, "HB") if abs(p.parameters["lam"] - born) < 1e-8)
    cycle = cw.switch_branch(problem, branch, point, (0.2, 3.0))
    assert cycle.outcome.reason == "bound"
    # With z at rest r^2 (1 + 0.25 z) = lam - born; a torus where the trace 0.95 - z^2 - 0.25 r^2 vanishes.
    (torus,) = labelled(cycle, "NS")
    there = born + (0.95 - 0.7**2) / 0.25 * (1.0 + 0.25 * 0.7)
    assert torus.parameters["lam"] == pytest.approx(there, rel=1e-8)


def test_sizes_of_all_orders():
    """u' = -u + x^2, v' = -2 v + u^2, w' = -w + x^3, z of a pure shift, beside x = 2 rho cos t."""

    def field(t, x, p, dx):
        growth = p.lam - 1.0 - x[0] ** 2 - x[1] ** 2
        dx[0] = growth * x[0] - x[1]
        dx[1] = x[0] + growth * x[1]
        dx[2] = -x[2] + x[0] ** 2
        dx[3] = -2.0 * x[3] + x[2] ** 2
        dx[4] = -x[4] + x[0] ** 3
        dx[5] = -x[5] + 3.0 * (p.lam - 1.0)

    problem = small_problem(field, "abcdef", {"lam": 0.8}, "lam")
    start = [0.0, 0.0, 0.0, 0.0, 0.0, -0.6]
    _, point = hopf(problem, start)
    sizes = CycleSizes(problem, point)(0.01)
    r = 0.1  # the cycle x = r cos t, r^2 = lam - 1
    assert sizes[:2] == pytest.approx([r, r], rel=1e-6)
    # u = r^2 (1 + cos(2 t - ...) / sqrt 5) / 2: half its range and its mean.
    assert sizes[2] == pytest.approx(0.5 * r**2 * (1.0 + 1.0 / np.sqrt(5.0)), rel=1e-3)  # 32 samples
    assert sizes[3] == pytest.approx(r**4 / 8.0, rel=1.0)  # of this order
    assert sizes[4] == pytest.approx(0.75 * r**3 / np.sqrt(2.0), rel=0.2)  # with a third harmonic beside it
    assert sizes[5] == pytest.approx(0.03, rel=1e-9)


def assert_cycle_leaves(seed):
    made = hopf_system(seed)
    problem = cw.Equilibrium(made.system, made.system.defaults(), "lam")
    branch, point = hopf(problem, made.start)
    cycle = cw.switch_branch(problem, branch, point, RANGE, max_points=60)
    assert cycle.outcome.reason in ("bound", "max_points"), (made.equations, cycle.outcome)
    assert np.abs(cycle["lam"] - 1.0).max() > 1e-4, made.equations
    assert not [p for p in cycle.special_points if p.status == "unlocated"], made.equations
    # rho^2 = -rate (lam - 1) / (omega l1) of the deviation's part along the critical vector, |q| = 1.
    c, n = point.coefficients, len(made.start)
    a = problem.jacobian(np.array(point.unknowns))[:n, :n]
    pair = nearest_eigenpair(a, 1j * c["omega"])
    left = pair.left / (pair.left @ (pair.right / np.linalg.norm(pair.right)))
    row = cycle.points[1]
    change = float(row["free"][0]) - 1.0
    rho = np.sqrt(-c["crossing_rate"] * change / (c["omega"] * c["l1"]))
    along = abs(left @ (row["state"] - np.array(point.unknowns)[:n]))
    # The next orders are parts of the order of the amplitude, a fiftieth of the cycle's size.
    assert along == pytest.approx(rho, rel=0.15), made.equations


@pytest.mark.drawn(3)
@pytest.mark.parametrize("seed", range(10))
def test_cycles_of_random_systems(seed):
    assert_cycle_leaves(seed)


def test_a_field_without_value_on_a_part_of_the_first_guess():
    """x1' has a root that exists for x0 > -0.3 only, and the size at a change of one asks for x0 = -1."""

    def field(t, x, p, dx):
        growth = p.lam - 1.0 - x[0] ** 2 - x[1] ** 2
        dx[0] = growth * x[0] - x[1]
        dx[1] = x[0] + growth * x[1]
        dx[2] = np.sqrt(0.3 + x[0]) - np.sqrt(0.3) - x[2]

    problem = small_problem(field, "abc", {"lam": 0.8}, "lam")
    _, point = hopf(problem, [0.0, 0.0, 0.0])
    sizes = CycleSizes(problem, point)(1.0)
    assert sizes[:2] == pytest.approx([1.0, 1.0], rel=1e-6)
    assert np.isfinite(sizes).all()

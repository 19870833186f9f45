"""Linear systems with a known Floquet form x = P(t) exp(B t) x_0: multipliers of 1e12 and 1e-12 in one orbit.

x' = (P' P^-1 + P B P^-1) (x - c(t)) + c'(t) has the orbit c(t); its multipliers are the
eigenvalues of exp(B T).
"""

import math

import numpy as np
import pytest
from invariants import check_orbit_branch
from small_systems import small_system

import contwalk as cw

pytestmark = pytest.mark.slow

PERIOD = 2.0
# What the requirement says: each right to this part of itself.
RELATIVE = 1e-6


def rotating(b, period=PERIOD, turns=1, moving=True):
    """P(t) = rotation of the first two axes by 2 pi turns t / T; the orbit is P(t) (0.3, -1, 2) or zero.

    b(p) gives B, shape (3, 3), as a nested list of plain arithmetic.
    """
    w = 2.0 * math.pi * turns / period

    def field(t, x, p, dx):
        cos, sin = np.cos(w * t), np.sin(w * t)
        centre = (0.3, -1.0, 2.0) if moving else (0.0, 0.0, 0.0)
        matrix = b(p)
        y = (cos * x[0] + sin * x[1], cos * x[1] - sin * x[0], x[2])  # P^-1 x
        z = [sum(matrix[i][j] * (y[j] - centre[j]) for j in range(3)) for i in range(3)]
        dx[0] = cos * z[0] - sin * z[1] - w * x[1]
        dx[1] = sin * z[0] + cos * z[1] + w * x[0]
        dx[2] = z[2]

    return small_system(field, "xyz", {"lam": 1.0}, period=lambda p: period)


def similar(rates):
    """B with given eigenvalues: V diag V^-1, V a fixed matrix that is far from orthogonal."""
    v = np.array([[1.0, 2.0, 0.0], [0.0, 1.0, -1.0], [1.0, 0.5, 3.0]])
    return v @ rates @ np.linalg.inv(v)


# Local errors along a branch are 100 times this, and B is far from normal: its eigenvectors amplify them.
ACCURACY = 1e-10


def walked(system, low=0.9, high=1.1, moving=True, accuracy=ACCURACY):
    problem = cw.PeriodicOrbit(
        system, system.defaults(), "lam", discretization=cw.Discretization(accuracy=accuracy)
    )
    start = [0.3, -1.0, 2.0] if moving else [0.0, 0.0, 0.0]
    branch = cw.continue_branch(problem, start, (low, high))
    check_orbit_branch(branch, problem, every=10)
    assert branch.outcome.reason == "bound"
    return branch


def assert_multipliers(branch, exact):
    for row in branch.points:
        wanted = sorted(exact(float(row["free"][0])), key=lambda v: (-abs(v), -complex(v).imag))
        found = np.array(row["spectrum"])
        np.testing.assert_allclose(found, wanted, rtol=RELATIVE, atol=0.0)
        assert abs(found[0] - wanted[0]) <= row["spectrum_error"]


@pytest.mark.drawn(1)
@pytest.mark.parametrize("moving", [True, False])
@pytest.mark.parametrize("size", [1e3, 1e12])
def test_multipliers_of_far_different_sizes(size, moving):
    """exp(B T) has the eigenvalues size, 1 / size and exp(-lam T)."""
    rate = math.log(size) / PERIOD
    fixed, with_lam = similar(np.diag([rate, -rate, 0.0])), similar(np.diag([0.0, 0.0, -1.0]))

    def b(p):
        return [[fixed[i, j] + p.lam * with_lam[i, j] for j in range(3)] for i in range(3)]

    branch = walked(rotating(b, moving=moving), moving=moving)
    if size > 1e10:
        assert branch.info.settings["segments"] > 1
    assert_multipliers(branch, lambda lam: [size, 1.0 / size, math.exp(-lam * PERIOD)])


@pytest.mark.long
def test_a_complex_pair_far_outside_and_one_far_inside():
    """1e12 exp(+-1.3 i) and 1e-12: the pair's angle is right too."""
    rate = math.log(1e12) / PERIOD
    turning = np.array([[rate, 1.3 / PERIOD, 0.0], [-1.3 / PERIOD, rate, 0.0], [0.0, 0.0, -rate]])
    fixed = similar(turning)

    def b(p):
        return [[p.lam * fixed[i, j] for j in range(3)] for i in range(3)]

    branch = walked(rotating(b))
    assert branch.info.settings["segments"] > 1

    def exact(lam):
        pair = 1e12**lam * np.exp(1.3j * lam)
        return [pair, pair.conjugate(), 1e-12**lam]

    assert_multipliers(branch, exact)


def test_negative_multipliers():
    """P makes half a turn a period: the first two multipliers are those of exp(B T) times -1."""
    rate = math.log(1e5) / PERIOD
    fixed = np.diag([rate, -rate, -0.3])

    def b(p):
        return [[p.lam * fixed[i, j] for j in range(3)] for i in range(3)]

    # Half a turn: B must not mix the first two axes with the third, and the orbit lies on the third.
    w = math.pi / PERIOD

    def field(t, x, p, dx):
        cos, sin = np.cos(w * t), np.sin(w * t)
        y = (cos * x[0] + sin * x[1], cos * x[1] - sin * x[0])
        m = b(p)
        dx[0] = cos * m[0][0] * y[0] - sin * m[1][1] * y[1] - w * x[1]
        dx[1] = sin * m[0][0] * y[0] + cos * m[1][1] * y[1] + w * x[0]
        dx[2] = m[2][2] * (x[2] - 2.0)

    system = small_system(field, "xyz", {"lam": 1.0}, period=lambda p: PERIOD)
    problem = cw.PeriodicOrbit(
        system, system.defaults(), "lam", discretization=cw.Discretization(accuracy=ACCURACY)
    )
    branch = cw.continue_branch(problem, [0.0, 0.0, 2.0], (0.9, 1.1))
    check_orbit_branch(branch, problem, every=10)
    assert_multipliers(branch, lambda lam: [-(1e5**lam), -(1e-5**lam), math.exp(-0.3 * lam * PERIOD)])


@pytest.mark.drawn(1)
@pytest.mark.parametrize("segments", [1, 2, 5, 16])
def test_any_number_of_segments_gives_the_same(segments):
    fixed = similar(np.diag([2.0, -1.0, -0.2]))

    def b(p):
        return [[p.lam * fixed[i, j] for j in range(3)] for i in range(3)]

    system = rotating(b)
    problem = cw.PeriodicOrbit(
        system,
        system.defaults(),
        "lam",
        discretization=cw.Discretization(accuracy=ACCURACY, segments=segments),
    )
    branch = cw.continue_branch(problem, [0.3, -1.0, 2.0], (0.9, 1.1))
    check_orbit_branch(branch, problem, every=10)
    assert branch.info.settings["segments"] == segments
    assert_multipliers(branch, lambda lam: np.exp(lam * PERIOD * np.array([2.0, -1.0, -0.2])))

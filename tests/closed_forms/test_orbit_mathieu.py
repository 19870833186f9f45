"""Tongues of the damped Mathieu equation x'' + c x' + (a - 2 q cos 2 t) x = 0, against Hill's determinant.

On a border x = sum c_k exp(i k t), with even k for the multiplier 1 and odd k for -1:
(a - k^2 + i c k) c_k = q (c_k-2 + c_k+2). So the borders a(q, c) are the real eigenvalues of an infinite
matrix.
"""

import math

import numpy as np
import pytest
from invariants import check_orbit_branch
from orbit_systems import ACCURACY, assert_met
from small_systems import labelled, small_system

import contwalk as cw

pytestmark = pytest.mark.slow

# c_k falls like (q / 4)^(k/2) / (k/2)!^2: at k = 60 nothing is left of it for q < 10.
HIGHEST = 60


def borders(q, c, odd):
    """Real a, ascending."""
    k = np.arange(-HIGHEST + odd, HIGHEST + 1, 2)
    matrix = np.diag(k**2 - 1j * c * k) + q * (np.eye(len(k), k=1) + np.eye(len(k), k=-1))
    values = np.linalg.eigvals(matrix)
    return np.sort(values[np.abs(values.imag) < 1e-10].real)


def mathieu(cubic=0.0, **values):
    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -p.c * x[1] - (p.a - 2.0 * p.q * np.cos(2.0 * t)) * x[0] - cubic * x[0] * x[0] * x[0]

    given = {"a": 2.5, "q": 1.0, "c": 0.1, **values}
    return small_system(field, ["x", "v"], given, period=lambda p: math.pi)


def expected(q, c, low, high):
    """Borders in the range with their labels, in their order: -1 doubles the period, 1 is met by
    another orbit.
    """
    known = [("BP", a) for a in borders(q, c, 0)] + [("PD", a) for a in borders(q, c, 1)]
    return sorted([(label, a) for label, a in known if low < a < high], key=lambda pair: pair[1])


def test_the_determinant_itself():
    """Without damping: characteristic values of NIST DLMF section 28.6(i) at q = 1, to the digits
    known of them.
    """
    # a_0(1), b_1(1), a_1(1), b_2(1), a_2(1): Abramowitz & Stegun, table 20.1 and McLachlan's tables.
    np.testing.assert_allclose(borders(1.0, 0.0, 0)[:1], [-0.4551386041], atol=1e-9)
    np.testing.assert_allclose(borders(1.0, 0.0, 1)[:2], [-0.1102488170, 1.8591080725], atol=1e-9)
    np.testing.assert_allclose(borders(1.0, 0.0, 0)[1:3], [3.9170247730, 4.3713009827], atol=1e-9)


@pytest.mark.drawn(1)
@pytest.mark.parametrize(("q", "c"), [(1.0, 0.1), (2.0, 0.1), (5.0, 0.5), (0.5, 0.05)])
@pytest.mark.parametrize("cubic", [0.0, 1.0])
def test_borders_of_the_first_tongues(q, c, cubic):
    low, high = -0.9 * q - 0.4, 6.0
    problem = cw.PeriodicOrbit(
        system := mathieu(cubic, q=q, c=c),
        system.defaults(),
        "a",
        discretization=cw.Discretization(accuracy=ACCURACY),
    )
    branch = cw.continue_branch(problem, [0.0, 0.0], (low, high))
    wanted = expected(q, c, low, high)
    assert len(wanted) >= 2
    check_orbit_branch(branch, problem)
    points = labelled(branch, "BP", "PD", "NS", "LP")
    assert [p.label for p in points] == [label for label, _ in wanted]
    for point, (label, a) in zip(points, wanted, strict=True):
        assert_met(point, "a", a)
        critical = 1.0 if label == "BP" else -1.0
        # Liouville: the product of the multipliers is exp(-c pi).
        exact = sorted([critical, critical * math.exp(-c * math.pi)], key=abs, reverse=True)
        np.testing.assert_allclose(point.spectrum, exact, rtol=0, atol=3 * ACCURACY)
        assert abs(point.unstable_after - point.unstable_before) == 1
        if label == "BP":
            assert point.kind == "pitchfork"
        if cubic == 0.0:  # all orbits there are multiples of one: nothing decides to which side
            assert point.criticality is None
    for row in branch.points:
        product = complex(np.prod(row["spectrum"]))
        assert product == pytest.approx(math.exp(-c * math.pi), rel=1e-5)
        assert np.all(row["state"] == 0.0)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("name", ["BP", "PD"])
def test_orbits_leave_the_trivial_one_to_larger_a(name):
    """A hardening cubic adds to a what amplitude takes: orbits born at a border exist below it in a."""
    problem = cw.PeriodicOrbit(
        system := mathieu(1.0, q=2.0, c=0.1),
        system.defaults(),
        "a",
        discretization=cw.Discretization(accuracy=ACCURACY),
    )
    branch = cw.continue_branch(problem, [0.0, 0.0], (-1.5, 6.0))
    point = labelled(branch, name)[-1]
    other = cw.switch_branch(problem, branch, point, (-1.5, 6.0), max_points=40)
    check_orbit_branch(other, problem)
    assert np.all(other["a"] <= point.parameters["a"] + ACCURACY)
    assert other["period"][3] == pytest.approx(math.pi * (2.0 if name == "PD" else 1.0), rel=1e-12)
    assert np.max(np.abs(other["state"])) > 0.05

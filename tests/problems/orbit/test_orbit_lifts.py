"""Lifts of the field over a closure: derivatives of the motion on the same steps, against complex
steps and exact ones.
"""

import math

import numpy as np
import pytest
from small_systems import small_system

from contwalk import flow
from contwalk.problems.orbit.lifts import JET, MIXED, PLAIN, TANGENT
from contwalk.problems.orbit.passage import closure_of
from contwalk.problems.orbit.traced_leg import Closing, ScalarInputs


def oscillator(t, x, p, dx):
    """A quadratic and a cubic term, parameters inside."""
    dx[0] = x[1]
    dx[1] = -p.k * x[0] - 0.1 * x[1] + p.q * x[0] * x[0] - 0.3 * x[0] ** 3


SYSTEM = small_system(oscillator, ["x", "v"], {"k": 1.0, "q": 0.4})
STEPS = np.linspace(0.0, 1.0, 13)
X = np.array([0.7, -0.2])
# T and the free parameter; parameters; their changes along a path.
FIXED = np.array([1.0, 0.4, 0.0, 0.0])


def carried(lift, y, scalars, *directions):
    field = closure_of(SYSTEM, ScalarInputs("k")).field(lift)
    c = field.constants(np.concatenate([scalars, FIXED, *directions]))
    return flow.along(field, c, STEPS, np.asarray(y, dtype=float), "dop853")[-1]


V, W = np.array([0.3, 1.0]), np.array([0.5, -0.4])  # state, (T, k)
SCALARS = np.array([2.0, 1.2])


def displaced(s):
    return carried(PLAIN, X + s * V, SCALARS + s * W)


def richardson(order):
    """A derivative of `displaced` by extrapolated central differences: truncation h^6, rounding 1e-16
    / h^order.
    """
    weights = {
        1: [(1, 0.75), (2, -0.15), (3, 1 / 60)],
        2: [(0, -49 / 18), (1, 1.5), (2, -0.15), (3, 1 / 90)],
        3: [(1, -61 / 30), (2, 169 / 120), (3, -0.3), (4, 7 / 240)],
    }[order]
    h = 0.01
    total = 0.0
    for k, c in weights:
        if k == 0:
            total = total + c * displaced(0.0)
        else:
            total = total + c * (displaced(k * h) + (-1.0) ** order * displaced(-k * h))
    return total / h**order


def test_the_motion_is_in_units_of_its_duration():
    """T x' = T f over 0..1 is x' = f over 0..T."""
    twice = carried(PLAIN, carried(PLAIN, X, [1.0, 1.2]), [1.0, 1.2])
    np.testing.assert_allclose(carried(PLAIN, X, [2.0, 1.2]), twice, rtol=0, atol=1e-12)


def test_the_tangent_lift():
    end = carried(TANGENT, [*X, *V], SCALARS, W)
    assert np.array_equal(end[:2], displaced(0.0))
    np.testing.assert_allclose(end[2:], richardson(1), rtol=0, atol=1e-10)


def test_the_mixed_lift_is_symmetric_and_the_second_derivative():
    end = carried(MIXED, [*X, *V, *V, 0.0, 0.0], SCALARS, W, W)
    assert np.array_equal(end[2:4], end[4:6])
    np.testing.assert_allclose(end[6:], richardson(2), rtol=0, atol=1e-8)
    other, own = np.array([1.0, -0.5]), np.array([0.1, 0.9])
    one = carried(MIXED, [*X, *V, *other, 0.0, 0.0], SCALARS, W, own)
    two = carried(MIXED, [*X, *other, *V, 0.0, 0.0], SCALARS, own, W)
    np.testing.assert_allclose(one[6:], two[6:], rtol=1e-12)


def test_the_jet_lift_is_taylors_series():
    still = np.zeros(2)
    end = carried(JET, [*X, *V, *still, *still], SCALARS, W, still, still)
    np.testing.assert_allclose(end[2:4], richardson(1), rtol=0, atol=1e-10)
    np.testing.assert_allclose(end[4:6], richardson(2), rtol=0, atol=1e-8)
    # Third differences: truncation h^6 = 1e-12 of a ninth derivative, rounding 1e-16 / 1e-6.
    np.testing.assert_allclose(end[6:], richardson(3), rtol=0, atol=1e-6)


def test_the_jet_of_a_curved_start():
    """x_0 + s v + s^2 c / 2: the second derivative gains the tangent of c."""
    still, c = np.zeros(2), np.array([0.8, -1.1])
    straight = carried(JET, [*X, *V, *still, *still], SCALARS, W, still, still)
    bent = carried(JET, [*X, *V, *c, *still], SCALARS, W, still, still)
    along = carried(TANGENT, [*X, *c], SCALARS, still)[2:]
    np.testing.assert_allclose(bent[4:6] - straight[4:6], along, rtol=1e-11)


@pytest.mark.parametrize("cycles", [1.0, 2.0])
def test_forced_motions_take_their_duration_from_the_parameters(cycles):
    """x' = cos(w t) over `cycles` periods 2 pi / w from 1: back at 1, and d/dw of that is zero."""

    def field(t, x, p, dx):
        dx[0] = np.cos(p.w * t)

    system = small_system(field, "x", {"w": 3.0}, period=lambda p: 2.0 * math.pi / p.w)
    passage = closure_of(system, ScalarInputs("w"), Closing(periods=cycles))
    assert passage.columns == [("l", 0)]
    lift = passage.field(TANGENT)
    c = lift.constants(np.array([3.0, 3.0, 0.0, 1.0]))
    end = flow.along(lift, c, np.linspace(0.0, 1.0, 41), np.array([1.0, 0.0]), "dop853")[-1]
    np.testing.assert_allclose(end, [1.0, 0.0], rtol=0, atol=1e-12)

"""Numbers that kernels compute in between, by the definitions: run by Python, as they are written."""

from __future__ import annotations

import pytest
from numpy.polynomial import Polynomial

from contwalk.flow import guard_kernel, radau_newton


@pytest.mark.parametrize("zero", [0.02, 0.3, 0.5, 0.77, 0.99])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_zero_of_a_cubic_that_rises_or_falls(zero, sign):
    """t + t^2 / 2 - t^3 / 4 less its value at the zero: told by values and slopes at both ends."""
    cubic = sign * (Polynomial([0.0, 1.0, 0.5, -0.25]) - Polynomial([0.0, 1.0, 0.5, -0.25])(zero))
    slope = cubic.deriv()
    found = guard_kernel._cubic_zero.py_func(cubic(0.0), slope(0.0), cubic(1.0), slope(1.0))
    assert found == pytest.approx(zero, abs=1e-14)


def test_a_rate_of_convergence_is_a_geometric_mean_down_to_rounding():
    """Corrections are in units of rounding: what is below one of them tells nothing."""
    mean = radau_newton._mean_rate.py_func
    assert mean(1e6, 1.0, 4) == pytest.approx(1e-2, rel=1e-14)  # three passes after the first
    assert mean(1e6, 1e-9, 4) == mean(1e6, 1.0, 4)
    assert mean(1e4, 1e2, 2) == pytest.approx(1e-2, rel=1e-14)
    assert mean(1e6, 1.0, 1) == mean(0.5, 0.1, 3) == 0.0

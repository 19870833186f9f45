"""The gamma function's logarithmic derivatives right where their series is taken up, against 30 digits."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from contwalk.fields.special_functions import polygamma

EPSILON = np.finfo(float).eps


@pytest.mark.parametrize("order", [0, 1, 2, 4])
@pytest.mark.parametrize("beyond", [0.0, 0.3, 2.0])
def test_the_series_is_exact_to_some_roundings(order, beyond):
    """From 15 on, and two more for each order; a handful of terms is summed, each rounded."""
    x = 15.0 + 2.0 * order + beyond
    with mpmath.workdps(30):
        exact = float(mpmath.psi(order, x))
    assert polygamma(float(order), x) == pytest.approx(exact, rel=4.0 * EPSILON, abs=0.0)

"""The claim about errors: the estimate is an upper bound of the true error, and not a wild one."""

from __future__ import annotations

import sys
from typing import Any

import mpmath

from contwalk.branch import SpecialPoint

DIGITS = 50
# An estimate may be this much larger than the true error, or than the rounding of the value where that is
# larger.
PESSIMISM = 1000
# Estimates below this are no claim worth disputing: parameters in the tests are not smaller than 1e-12.
NOTHING = 1e-30


def assert_error_claim(point: SpecialPoint, parameter: str, truth: Any) -> None:
    """|value - truth| <= error <= 1000 max(|value - truth|, eps |value|), with `truth` an `mpmath` number."""
    assert point.status == "located"
    assert point.error is not None
    with mpmath.workdps(DIGITS):
        value, error = mpmath.mpf(point.parameters[parameter]), mpmath.mpf(point.error)
        true = abs(value - truth)
        assert true <= error, f"{point.name}: true error {mpmath.nstr(true)}, estimate {point.error}"
        rounding = sys.float_info.epsilon * abs(value)
        most = max(PESSIMISM * max(true, rounding), NOTHING)
        assert error <= most, f"{point.name}: estimate {point.error} for a true error {mpmath.nstr(true)}"

"""Gamma functions and their derivatives, for floats and as machine code.

The derivatives of ln Gamma are the polygamma functions psi_n. An argument is raised to where the asymptotic
series holds (Abramowitz & Stegun, Handbook of Mathematical Functions, 6.3.18, 6.4.11) by recurrence, 6.4.6:

    psi_n(x) = psi_n(x + 1) + (-1)^(n + 1) n! / x^(n + 1)
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

# B_2k / (2k)! for k = 1, 2, ..., 12.
_BERNOULLI = (
    1.0 / 12.0,
    -1.0 / 720.0,
    1.0 / 30240.0,
    -1.0 / 1209600.0,
    1.0 / 47900160.0,
    -691.0 / 1307674368000.0,
    1.0 / 74724249600.0,
    -3617.0 / 10670622842880000.0,
    43867.0 / 5109094217170944000.0,
    -174611.0 / 802857662698291200000.0,
    77683.0 / 14101100039391805440000.0,
    -236364091.0 / 1693824136731743669452800000.0,
)
# From here on, and two more for each derivative, twelve terms of the series are exact to a float's rounding.
_FAR = 15.0
_LOWEST = -1e4  # farther down the recurrence would take long, and every float is near a pole


def polygamma(n: float, x: float) -> float:
    """psi_n(x), the derivative of order n + 1 of ln Gamma; NaN at its poles.

    Parameters
    ----------
    n : float
        A whole number from 0 up.
    x : float
    """
    if not x > _LOWEST or (x <= 0.0 and x == math.floor(x)):
        return math.nan
    factorial = 1.0  # (n - 1)!, or 1
    for k in range(2, int(n)):
        factorial *= k
    whole = factorial * n if n > 0.0 else 1.0  # n!
    recurred = 0.0
    y = x
    while y < _FAR + 2.0 * n:
        power = y
        for _ in range(int(n)):
            power *= y
        recurred += whole / power
        y += 1.0
    power = 1.0  # y^n
    for _ in range(int(n)):
        power *= y
    series = (factorial / power if n > 0.0 else -math.log(y)) + whole / (2.0 * power * y)
    rising = whole  # (2k + n - 1)!
    power *= y * y
    term = n
    for b in _BERNOULLI:
        term += 1.0
        rising *= term
        series += b * rising / power
        term += 1.0
        rising *= term
        power *= y * y
    total = series + recurred
    return total if n % 2.0 == 1.0 else -total


def gamma(x: float) -> float:
    """Gamma(x), as the C library has it, which machine code calls too.

    Raises
    ------
    ValueError
        At a pole, or where it is too large.
    """
    return _finite(_library("tgamma", math.gamma)(x), x)


def lgamma(x: float) -> float:
    """ln |Gamma(x)|; as `gamma`."""
    return _finite(_library("lgamma", math.lgamma)(x), x)


def _finite(value: float, x: float) -> float:
    if math.isfinite(x) and not math.isfinite(value):
        raise ValueError(f"a gamma function has no value at {x:g}")
    return value


@cache
def _library(name: str, otherwise: Callable[[float], float]) -> Callable[[float], float]:
    """A function of the C library; Python's own where that cannot be had."""
    import ctypes.util  # few systems need it, and it imports much

    path = ctypes.util.find_library("m") or ctypes.util.find_library("msvcrt")
    function = getattr(ctypes.CDLL(path), name, None) if path else None
    if function is None:
        return otherwise
    function.restype, function.argtypes = ctypes.c_double, [ctypes.c_double]
    return function


POLYGAMMA = "contwalk_polygamma"


@cache
def _callback() -> Any:
    """`polygamma` as machine code; kept, since others hold its address."""
    import numba

    return numba.cfunc("float64(float64, float64)", error_model="numpy")(polygamma)


def called_in(text: str) -> dict[str, int]:
    """Addresses of the functions above that a text of LLVM IR calls, by the names it calls them."""
    return {POLYGAMMA: _callback().address} if f"@{POLYGAMMA}(" in text else {}

"""Functions of NumPy and SciPy that are put together from others, for stand-ins and arrays of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from contwalk.fields.complex_numbers import angle
from contwalk.fields.dispatch import dispatch, where
from contwalk.fields.functions import Number


def each(function: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """A function of one number, of an array entry by entry."""

    def call(values: Any) -> Any:
        if np.ndim(values) == 0:
            return function(values)
        given = np.asarray(values, dtype=object)
        result = np.empty(given.shape, dtype=object)
        for index in np.ndindex(given.shape):
            result[index] = function(given[index])
        return result

    return call


def _sinc(x: Any) -> Any:
    """sin(z) / z at z = pi x; where |z| < 1 its series, whose derivatives exist at zero.

    Nested, 1 - z^2 / (2 3) (1 - z^2 / (4 5) (...)): what is left out is below 1e-45, and so it
    is in third derivatives.
    """
    if not isinstance(x, Number):
        return np.sinc(x)
    z = x * (4.0 * dispatch("atan", (0.0 * x + 1.0,)))  # pi, to as many digits as are asked for
    square = z * z
    near = square < 1.0
    series: Any = 1.0
    for k in range(20, 0, -1):
        series = 1.0 - square / (2.0 * k * (2.0 * k + 1.0)) * series
    return where(near, series, dispatch("sin", (z,)) / where(near, 1.0, z))


sinc = each(_sinc)
real = each(lambda z: z.real)
imag = each(lambda z: z.imag)
conjugate = each(lambda z: z.conjugate())
angles = each(angle)


def expit(x: Any) -> Any:
    """1 / (1 + exp(-x)), which does not overflow."""
    return 0.5 + 0.5 * dispatch("tanh", (0.5 * x,))


def rounded_up(x: Any) -> Any:
    """The next whole number from there up."""
    return -dispatch("floor", (-x,))


def clip(x: Any, low: Any = None, high: Any = None) -> Any:
    """`numpy.clip`."""
    x = x if low is None else dispatch("max", (x, low))
    return x if high is None else dispatch("min", (x, high))


def heaviside(x: Any, middle: Any) -> Any:
    """`numpy.heaviside`."""
    return where(x < 0.0, 0.0, where(x == 0.0, middle, 1.0))


def logaddexp(x: Any, y: Any) -> Any:
    """log(exp(x) + exp(y)), which does not overflow."""
    apart = dispatch("abs", (x - y,))
    return dispatch("max", (x, y)) + dispatch("log1p", (dispatch("exp", (-apart,)),))

"""Tables and splines at places that are numbers: `numpy.interp` and what SciPy makes of data.

All are piecewise polynomials. The piece is looked up, by as many comparisons as the logarithm of their
number, and its coefficients are read from a table: the cost does not grow with the data.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from typing import Any

import numpy as np

from contwalk.errors import UnsupportedOperation
from contwalk.fields.dispatch import dispatch, symbolic, where
from contwalk.fields.functions import Number

_Row = Sequence[float] | np.ndarray


def piecewise(x: Number, breaks: _Row, origins: _Row, coefficients: Sequence[_Row] | np.ndarray) -> Any:
    """Piece k, from `breaks[k - 1]` on: the sum of `coefficients[i][k] (x - origins[k])^(m - i)`, i <= m.

    Of n pieces: n - 1 breaks, n origins, and coefficients of shape (m + 1, n).
    """
    piece = x.piece(tuple(map(float, breaks)))

    def entry(values: _Row) -> Any:
        if len(set(values)) == 1 and not math.isnan(values[0]):
            return float(values[0])
        return piece.entry(tuple(map(float, values)))

    deviation = x - entry(origins)
    value: Any = entry(coefficients[0])
    for row in coefficients[1:]:
        value = value * deviation + entry(row)
    return value


def interp(x: Any, xp: Any, fp: Any, left: Any = None, right: Any = None, period: Any = None) -> Any:
    """`numpy.interp`: linear between points (xp, fp), constant beyond them or periodic.

    The values `fp` may be stand-ins, the places `xp` may not.
    """
    if symbolic(xp) or (period is not None and symbolic(period)):
        raise UnsupportedOperation(
            "The places of numpy.interp's points depend on the state or a parameter.",
            "Give numbers as places, and scale the argument instead.",
        )
    places, values = np.asarray(xp, dtype=float).ravel(), np.asarray(fp, dtype=object).ravel()
    if len(places) != len(values) or len(places) == 0:
        raise UnsupportedOperation(
            f"numpy.interp gets {len(places)} places and {len(values)} values.", "Give as many of both."
        )
    if not symbolic(x, values, left, right):
        return np.interp(x, places, values.astype(float), left, right, period)
    if period is not None:
        period = abs(float(period))
        order = np.argsort(places % period, kind="stable")
        places, values = (places % period)[order], values[order]
        places = np.concatenate([[places[-1] - period], places, [places[0] + period]])
        values = np.concatenate([values[-1:], values, values[:1]])
        left = right = None
    if (np.diff(places) <= 0.0).any():
        raise UnsupportedOperation("The places of numpy.interp's points do not increase.", "Sort the points.")
    ends = (values[0] if left is None else left), (values[-1] if right is None else right)
    if np.ndim(x):
        given = np.asarray(x, dtype=object)
        result = np.empty(given.shape, dtype=object)
        for index in np.ndindex(result.shape):
            result[index] = _at(given[index], places, values, ends, period)
        return result
    return _at(x, places, values, ends, period)


def _at(x: Any, places: np.ndarray, values: np.ndarray, ends: tuple[Any, Any], period: float | None) -> Any:
    if period is not None:
        x = x - period * dispatch("floor", (x / period,))
    if isinstance(x, Number) and not symbolic(values, *ends):
        return _from_table(x, places, values.astype(float), ends)
    inside = _between(x, places, values) if len(places) > 1 else values[0]
    return where(x < places[0], ends[0], where(x > places[-1], ends[1], inside))


def _from_table(x: Number, places: np.ndarray, values: np.ndarray, ends: tuple[Any, Any]) -> Any:
    slopes = np.diff(values) / np.diff(places)
    # At the last place the value is still the last one, and beyond it `right`.
    beyond = np.nextafter(places[-1], math.inf)
    last = [] if len(places) == 1 else [places[-1]]
    breaks = [*places[:-1], *last, beyond] if len(places) > 1 else [places[0], beyond]
    rows = [[0.0, *slopes, 0.0, 0.0], [float(ends[0]), *values, float(ends[1])]]
    return piecewise(x, breaks, [places[0], *places, places[-1]], rows)


def _between(x: Any, places: np.ndarray, values: np.ndarray) -> Any:
    if len(places) == 2:
        slope = (values[1] - values[0]) / float(places[1] - places[0])
        return values[0] + slope * (x - float(places[0]))
    middle = len(places) // 2
    below = _between(x, places[: middle + 1], values[: middle + 1])
    return where(x < float(places[middle]), below, _between(x, places[middle:], values[middle:]))


class Spline:
    """A piecewise polynomial of SciPy that understands stand-ins.

    Parameters
    ----------
    own
        A `PPoly`, such as `CubicSpline`, `PchipInterpolator` or `Akima1DInterpolator`; or what makes one.
    """

    def __init__(self, own: Any) -> None:
        self._own = own

    def __call__(self, x: Any, nu: int = 0, extrapolate: Any = None) -> Any:
        if not symbolic(x):
            return self._own(x, nu) if extrapolate is None else self._own(x, nu, extrapolate)
        spline = _polynomials(self._own)
        beyond = spline.extrapolate if extrapolate is None else extrapolate
        spline = spline.derivative(nu) if nu else spline
        given = np.asarray(x, dtype=object)
        result = np.empty((*given.shape, *spline.c.shape[2:]), dtype=object)
        for index in np.ndindex(given.shape):
            for component in np.ndindex(spline.c.shape[2:]):
                coefficients = spline.c[(slice(None), slice(None), *component)]
                result[index + component] = _of_spline(given[index], spline.x, coefficients, beyond)
        return result if result.ndim else result.item()

    def derivative(self, nu: int = 1) -> Spline:
        """The derivative, another spline."""
        return Spline(self._own.derivative(nu))

    def antiderivative(self, nu: int = 1) -> Spline:
        """The integral from the first place on, another spline."""
        return Spline(self._own.antiderivative(nu))

    def __getattr__(self, name: str) -> Any:
        return getattr(self._own, name)


def _polynomials(own: Any) -> Any:
    """The spline as polynomials: coefficients `c`, places `x`, and what happens beyond them."""
    if hasattr(own, "c") and hasattr(own, "x"):
        return own
    PPoly = sys.modules["scipy.interpolate"].PPoly  # the plugin's import: SciPy is no part of contwalk
    if hasattr(own, "tck"):  # a BSpline
        return PPoly.from_spline(own.tck, extrapolate=own.extrapolate)
    return PPoly.from_spline(own._eval_args, extrapolate=own.ext != 1)  # UnivariateSpline


def _of_spline(x: Any, places: np.ndarray, coefficients: np.ndarray, beyond: Any) -> Any:
    if beyond == "periodic":
        period = float(places[-1] - places[0])
        x = x - period * dispatch("floor", ((x - float(places[0])) / period,))
    value = piecewise(x, places[1:-1], places[:-1], coefficients) if isinstance(x, Number) else math.nan
    if beyond:
        return value
    return where((x < float(places[0])) | (x > float(places[-1])), math.nan, value)


def is_spline(value: Any) -> bool:
    """Whether it is a function through data that SciPy has made, and that is one of polynomials."""
    if not type(value).__module__.startswith("scipy.interpolate"):
        return False
    return (hasattr(value, "c") and hasattr(value, "x")) or hasattr(value, "tck") or _is_univariate(value)


def _is_univariate(value: Any) -> bool:
    return hasattr(value, "_eval_args") and getattr(value, "ext", None) in (0, 1)

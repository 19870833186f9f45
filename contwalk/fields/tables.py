"""`numpy.interp` for stand-ins: a table as a tree of choices, as deep as the logarithm of its length."""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.errors import UnsupportedOperation
from contwalk.fields.dispatch import dispatch, symbolic, where


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
        return _between(x, places, values)
    inside = _between(x, places, values) if len(places) > 1 else values[0]
    return where(x < places[0], ends[0], where(x > places[-1], ends[1], inside))


def _between(x: Any, places: np.ndarray, values: np.ndarray) -> Any:
    if len(places) == 2:
        slope = (values[1] - values[0]) / float(places[1] - places[0])
        return values[0] + slope * (x - float(places[0]))
    middle = len(places) // 2
    below = _between(x, places[: middle + 1], values[: middle + 1])
    return where(x < float(places[middle]), below, _between(x, places[middle:], values[middle:]))

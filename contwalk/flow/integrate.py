"""What can be done with a flow, by whichever method."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import ModuleType

import numpy as np

from contwalk.flow.compiled.compiled_field import CompiledField
from contwalk.flow.explicit import runge_kutta as explicit
from contwalk.flow.explicit.several_paths import ADAPTIVE_EACH, adaptive_each
from contwalk.flow.gauss import gauss_collocation as gauss
from contwalk.flow.path import ErrorControl, Path, Tangents
from contwalk.flow.radau import radau_iia as radau

Vector = Sequence[float] | np.ndarray

FAMILIES: tuple[ModuleType, ...] = (explicit, radau, gauss)
"""Modules that integrate, each by the methods that are named in its `TABLEAUS`."""

METHODS = tuple(name for family in FAMILIES for name in family.TABLEAUS)
"""Names of the methods."""


def _family(method: str) -> ModuleType:
    for family in FAMILIES:
        if method in family.TABLEAUS:
            return family
    raise ValueError(f"'{method}' is none of {', '.join(METHODS)}")


def implicit(method: str) -> bool:
    """Whether the steps of a method are solved for, so that the field's Jacobian is needed for them."""
    found: bool = _family(method).IMPLICIT
    return found


def warmup() -> None:
    """Compile what all fields share, or find it compiled in the cache."""
    for family in FAMILIES:
        family.warmup()
    _ = ADAPTIVE_EACH.address


def adaptive(
    field: CompiledField,
    c: np.ndarray,
    t0: float,
    x0: Vector,
    t1: float,
    tolerance: float,
    weights: Vector,
    method: str = "dop853",
) -> Path:
    """The path from (t0, x0) to t1, forwards or backwards, in steps whose estimated errors are allowed.

    Parameters
    ----------
    field : CompiledField
    c : ndarray
        `field.constants(p)`.
    tolerance : float
        Bound of each step's estimated error: root mean square over the states, in units of `weights`.
    weights : array of float, shape (n,)
        Typical magnitudes of the states.
    method : str
        One of `METHODS`.

    Raises
    ------
    ValueError
        If the method is unknown, shapes do not fit, or the tolerance is not positive.
    """
    return controlled(field, c, t0, x0, t1, ErrorControl(tolerance, np.asarray(weights)), method)


def controlled(
    field: CompiledField,
    c: np.ndarray,
    t0: float,
    x0: Vector,
    t1: float,
    control: ErrorControl,
    method: str = "dop853",
) -> Path:
    """As `adaptive`, with all that can be said of how long steps may be.

    Raises
    ------
    ValueError
        As `adaptive`.
    """
    return _family(method).adaptive(field, c, t0, x0, t1, _checked(control), method)


def controlled_each(
    field: CompiledField,
    c: np.ndarray,
    bounds: np.ndarray,
    x0: np.ndarray,
    control: ErrorControl,
    method: str = "dop853",
) -> list[Path]:
    """As `controlled`, of several paths; by explicit methods in one call of compiled code.

    Parameters
    ----------
    bounds : ndarray, shape (m, 2)
        When each path begins, and ends.
    x0 : ndarray, shape (m, n)
        Start of each.

    Raises
    ------
    ValueError
        As `adaptive`.
    """
    family, control = _family(method), _checked(control)
    if family is explicit:
        return adaptive_each(field, c, bounds, x0, control, method)
    times = bounds.tolist()
    return [
        family.adaptive(field, c, t0, x, t1, control, method) for (t0, t1), x in zip(times, x0, strict=True)
    ]


def _checked(control: ErrorControl) -> ErrorControl:
    if not control.tolerance > 0.0:
        raise ValueError("the tolerance is positive")
    return control._replace(weights=np.ascontiguousarray(control.weights, dtype=float))


def adaptive_with_tangents(
    field: CompiledField,
    c: np.ndarray,
    t0: float,
    x0: Vector,
    t1: float,
    control: ErrorControl,
    given: Tangents,
    method: str = "dop853",
) -> tuple[Path, np.ndarray]:
    """The path of `controlled`, its steps chosen for the states alone, and the derivatives of its end.

    They are those of `tangents` on its times, bitwise. Explicit methods take both in one pass: a path on
    which derivatives overflow ends there, "not_finite", though its states may go on.

    Parameters
    ----------
    given : Tangents
        Derivatives of x0; an identity that nothing drives gives the monodromy matrix of a period.

    Returns
    -------
    path : Path
    tangents : ndarray, shape (n, q)

    Raises
    ------
    ValueError
        As `adaptive` and `tangents`.
    """
    if _family(method) is not explicit:
        path = controlled(field, c, t0, x0, t1, control, method)
        return path, tangents(field, c, path.times, x0, *given, method)[1]
    return explicit.adaptive_with_tangents(field, c, t0, x0, t1, _checked(control), given, method)


def along(
    field: CompiledField, c: np.ndarray, times: Vector, x0: Vector, method: str = "dop853"
) -> np.ndarray:
    """The states at given times, shape (s + 1, n), a step from each to the next; NaN after one that fails.

    On the times of a path of `adaptive` these are its states, bitwise.
    """
    return _family(method).along(field, c, times, x0, method)


def tangents(
    field: CompiledField,
    c: np.ndarray,
    times: Vector,
    x0: Vector,
    X0: np.ndarray,
    sources: Sequence[int] | np.ndarray,
    method: str = "dop853",
    every: bool = False,
) -> tuple[np.ndarray, np.ndarray]:
    """The steps of `along`, and their exact derivatives.

    Parameters
    ----------
    X0 : array of float, shape (n, q)
        Derivatives of x0.
    sources : sequence of int, length q
        For each of them the parameter column of the field that drives it, or -1.
    every : bool
        All nodes and not only the last.

    Returns
    -------
    states : ndarray, shape (n,), or (s + 1, n)
    tangents : ndarray, shape (n, q), or (s + 1, n, q)
    """
    return _family(method).tangents(field, c, times, x0, Tangents(X0, sources), method, every)


def along_with_tangents(
    field: CompiledField,
    c: np.ndarray,
    times: Vector,
    x0: np.ndarray,
    X0: np.ndarray,
    sources: Sequence[int] | np.ndarray,
    method: str = "dop853",
) -> tuple[np.ndarray, np.ndarray]:
    """Several paths in one pass: the states of `along` at all their times, bitwise, and the derivatives of
    their ends.

    Parameters
    ----------
    times : array of float, shape (s,)
        Those of the paths, one after the other: where a time is repeated the next path begins.
    x0 : ndarray, shape (m, n)
        Start of each path.
    X0 : array of float, shape (n, q)
        Derivatives of each start.
    sources : sequence of int, length q
        For each of them the parameter column of the field that drives it, or -1.

    Returns
    -------
    states : ndarray, shape (s, n)
    tangents : ndarray, shape (m, n, q)
    """
    return _family(method).along_with_tangents(field, c, times, x0, Tangents(X0, sources), method)


def errors_on(
    field: CompiledField, c: np.ndarray, times: Vector, x0: Vector, method: str, weights: Vector
) -> np.ndarray:
    """Embedded error estimates of the steps of a grid, shape (s,): RMS in units of the weights."""
    return _family(method).errors_on(field, c, times, x0, method, weights)


def interpolation(
    field: CompiledField, c: np.ndarray, times: Vector, states: np.ndarray, method: str = "dop853"
) -> Callable[[Vector], np.ndarray]:
    """As `dense`, of a path that is asked for its states many times: a function of the times.

    Where a time is repeated another path begins, at a state of its own; it is what there is at that time.
    """
    return _family(method).Interpolation(field, c, times, states, method)


def dense(
    field: CompiledField,
    c: np.ndarray,
    times: Vector,
    states: np.ndarray,
    t_values: Vector,
    method: str = "dop853",
) -> np.ndarray:
    """States between the nodes of a path, shape (len(t_values), n); NaN at times outside it.

    Parameters
    ----------
    times, states : ndarray, shapes (s + 1,) and (s + 1, n)
        Those of a `Path`, or of `along`.
    t_values : array of float
    """
    return _family(method).dense(field, c, times, states, t_values, method)

"""Collocation at Gauss points as a method of integration: paths, given steps, and their exact derivatives.

A step is a polynomial of degree s that satisfies the equation at s points; an orbit on such steps is what
orthogonal collocation on their mesh gives, with the unknowns inside each step eliminated (see `step`). The
steps' equations are solved to rounding, so that a path on given steps is a smooth function of its start, and
bitwise the same whether its steps were chosen by error control or are given.

The error of a step is what one more point changes.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from contwalk.flow.compiled.call_memory import CallMemory
from contwalk.flow.compiled.compiled_field import CompiledField
from contwalk.flow.compiled.entry_points import Entry
from contwalk.flow.gauss.gauss_call import GaussCall, GaussControl
from contwalk.flow.path import ErrorControl, Path, Tangents
from contwalk.flow.tableaus.gauss import LEAST_DEGREE, MOST_DEGREE, gauss_points

Vector = Sequence[float] | np.ndarray

TABLEAUS = {f"gauss{2 * degree}": gauss_points(degree) for degree in range(LEAST_DEGREE, MOST_DEGREE)}
"""The methods by their names, which have the order. One degree more tells the errors of each."""

# Whether its steps are solved for, with the Jacobian of the field.
IMPLICIT = True

# Steps for which memory is set aside before it is known how many there are.
_ROOM = 256

_PATHS = Entry("contwalk.flow.gauss.kernel", "gauss_paths", "q", "q")
_ERRORS = Entry("contwalk.flow.gauss.kernel", "gauss_errors", "q", "q")
_ADAPTIVE = Entry("contwalk.flow.gauss.kernel", "gauss_adaptive", "q", "q")


def warmup() -> None:
    """Compile everything, or find it compiled."""
    for entry in (_PATHS, _ERRORS, _ADAPTIVE):
        _ = entry.address


@cache
def _packed(degree: int) -> np.ndarray:
    return gauss_points(degree).packed()


class _Call(CallMemory):
    """The memory of one call, and the record that tells a kernel of it: a field, a degree, and scratch."""

    def __init__(
        self, field: CompiledField, c: np.ndarray, method: str, q: int = 0, estimating: bool = False
    ) -> None:
        n, entries, s = field.n, len(field.col), TABLEAUS[method].degree
        finer = s + 1 if estimating else 0
        sn = max(s, finer) * n
        super().__init__(field)
        self.record = GaussCall(
            **self.field(field, c),
            numbers=self.keep(_packed(s)),
            s=s,
            finer_numbers=self.keep(_packed(finer)) if finer else 0,
            finer=finer,
            scratch=self.keep(np.empty(n + entries + sn * (sn + 3 + q) + n * (3 + q))),
            pivots=self.keep(np.empty(sn, dtype=np.int64)),
            q=q,
        )


def adaptive(
    field: CompiledField, c: np.ndarray, t0: float, x0: Vector, t1: float, bound: ErrorControl, method: str
) -> Path:
    """As `integrate.adaptive`; `evaluations` counts right-hand sides and Jacobians alike."""
    call, control = _Call(field, c, method, estimating=True), GaussControl()
    record = call.record
    record.t1, record.tolerance, record.most = t1, bound.tolerance, bound.max_steps
    record.control = control.address
    call.give(weights=bound.weights)

    def march(times: np.ndarray, states: np.ndarray) -> int:
        call.give(times=times, states=states)
        record.count = len(times)
        return int(_ADAPTIVE(record.address))

    def counted() -> tuple[int, int, int, int]:
        return control.steps, control.evaluations, control.rejected, 0

    return Path.grown(march, t0, x0, _ROOM, counted)[0]


def _marched(
    field: CompiledField,
    c: np.ndarray,
    times: np.ndarray,
    lasts: np.ndarray,
    starts: np.ndarray,
    method: str,
    given: Tangents | None = None,
    every: bool = False,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """States at all times (k, n) of some paths, tangents at their ends (m, n, q), and at all times.

    `lasts` says where in `times` the last one of each path is. NaN from where a step fails.
    """
    start = np.zeros((field.n, 0)) if given is None else np.array(given.start, dtype=float, order="C")
    q = start.shape[1]
    call = _Call(field, c, method, q)
    states = np.full((len(times), field.n), np.nan)
    ends = np.full((len(lasts), field.n, q), np.nan)
    nodes = np.full((len(times) if every else 0, field.n, q), np.nan)
    sources = np.zeros(0, dtype=np.int64) if given is None else np.array(given.sources, dtype=np.int64)
    call.give(times=np.ascontiguousarray(times, dtype=float), lasts=np.array(lasts, dtype=np.int64))
    call.give(starts=np.array(starts, dtype=float, order="C"), states=states)
    call.give(tangents=start, sources=sources, ends=ends, nodes=nodes)
    call.record.count, call.record.paths = len(times), len(lasts)
    _PATHS(call.record.address)
    return states, ends, nodes


def along(field: CompiledField, c: np.ndarray, times: Vector, x0: Vector, method: str) -> np.ndarray:
    """As `integrate.along`."""
    grid = np.asarray(times, dtype=float)
    return _marched(field, c, grid, np.array([len(grid) - 1]), np.array([x0], dtype=float), method)[0]


def errors_on(
    field: CompiledField, c: np.ndarray, times: Vector, x0: Vector, method: str, weights: Vector
) -> np.ndarray:
    """As `integrate.errors_on`: what one more point changes."""
    grid = np.ascontiguousarray(times, dtype=float)
    call, errors = _Call(field, c, method, estimating=True), np.full(len(grid), np.nan)
    call.give(times=grid, starts=np.array(x0, dtype=float), nodes=errors)
    call.give(weights=np.ascontiguousarray(weights, dtype=float))
    call.record.count = len(grid)
    _ERRORS(call.record.address)
    return errors[:-1]


def tangents(
    field: CompiledField, c: np.ndarray, times: Vector, x0: Vector, given: Tangents, method: str, every: bool
) -> tuple[np.ndarray, np.ndarray]:
    """As `integrate.tangents`."""
    grid = np.asarray(times, dtype=float)
    lasts, starts = np.array([len(grid) - 1]), np.array([x0], dtype=float)
    states, ends, nodes = _marched(field, c, grid, lasts, starts, method, given, every)
    return (states, nodes) if every else (states[-1], ends[0])


def along_with_tangents(
    field: CompiledField, c: np.ndarray, times: Vector, x0: np.ndarray, given: Tangents, method: str
) -> tuple[np.ndarray, np.ndarray]:
    """As `integrate.along_with_tangents`."""
    grid = np.asarray(times, dtype=float)
    lasts = np.append(np.flatnonzero(grid[1:] == grid[:-1]), len(grid) - 1)
    states, ends, _ = _marched(field, c, grid, lasts, np.asarray(x0, dtype=float), method, given)
    return states, ends


class Interpolation:
    """The motion between the nodes of a path: a shorter step from the node before, as exact as a step's end.

    The polynomials themselves are of half the order. Arguments as for `dense`; called with times, it gives
    states, shape (len(times), n).
    """

    def __init__(
        self, field: CompiledField, c: np.ndarray, times: Vector, states: np.ndarray, method: str = "gauss10"
    ) -> None:
        self._field, self._c, self._method = field, c, method
        self._grid, self._nodes = np.asarray(times, dtype=float), np.asarray(states, dtype=float)

    def __call__(self, times: Sequence[float] | np.ndarray) -> np.ndarray:
        """States at times; NaN at those outside the path."""
        at, grid, nodes = np.asarray(times, dtype=float), self._grid, self._nodes
        found = np.full((len(at), nodes.shape[1]), np.nan)
        if len(grid) > 1:
            direction = 1.0 if grid[-1] >= grid[0] else -1.0
            places = np.searchsorted(direction * grid, direction * at, side="right") - 1
            step = np.clip(places, 0, len(grid) - 2)
            begin, end = grid[step], grid[step + 1]
            inside = (direction * (at - begin) > 0.0) & (direction * (end - at) >= 0.0)
            pairs = np.column_stack([begin[inside], at[inside]]).ravel()
            lasts = np.arange(1, len(pairs), 2)
            states, _, _ = _marched(self._field, self._c, pairs, lasts, nodes[step[inside]], self._method)
            found[inside] = states[1::2]
            found[at == begin] = nodes[step[at == begin]]
        found[at == grid[-1]] = nodes[-1]
        return found


def dense(
    field: CompiledField, c: np.ndarray, times: Vector, states: np.ndarray, t_values: Vector, method: str
) -> np.ndarray:
    """As `integrate.dense`."""
    return Interpolation(field, c, times, states, method)(t_values)

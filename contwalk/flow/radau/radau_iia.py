"""Radau IIA collocation for stiff flows: L-stable, orders 5 and 9, with exact Jacobians.

Every step's equations are solved to rounding (`radau_step`), so that a path over a given grid is a smooth
function of its start, and bitwise the same whether the grid was chosen by error control or is given.

Source: E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd edition, IV.5 and IV.8.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from itertools import pairwise

import numpy as np

from contwalk.flow.compiled.call_memory import CallMemory
from contwalk.flow.compiled.compiled_field import CompiledField
from contwalk.flow.compiled.entry_points import Entry
from contwalk.flow.path import ErrorControl, Path, Tangents
from contwalk.flow.radau.radau_call import RadauCall, RadauControl, RadauCounts
from contwalk.flow.tableaus.radau import RADAU5, RADAU9, Collocation

Vector = Sequence[float] | np.ndarray

TABLEAUS = {"radau5": RADAU5, "radau9": RADAU9}
# Whether its steps are solved for, with the Jacobian of the field.
IMPLICIT = True

# Steps for which memory is set aside before it is known how many there are.
_ROOM = 512

# Of the error of the embedded formula, in the translation of tolerances (that of RADAU).
SHARE = 0.1

_MARCH = Entry("contwalk.flow.radau.kernel", "radau_march", "q", "q")
_ADAPTIVE = Entry("contwalk.flow.radau.kernel", "radau_adaptive", "q", "q")
_TANGENTS = Entry("contwalk.flow.radau.tangents", "radau_tangents", "q", "q")


def warmup() -> None:
    """Compile everything, or find it compiled."""
    for entry in (_MARCH, _ADAPTIVE, _TANGENTS):
        _ = entry.address


def _measured(tolerance: float, stages: int) -> float:
    """The bound of the embedded estimate that belongs to a tolerance: 0.1 tolerance^((s + 1) / (2 s)).

    The estimate is that of a formula of order s and falls like h^(s + 1), the error itself like h^(2 s). So
    that steps are as long as the error allows, the tolerance is translated as the code RADAU does (E. Hairer,
    G. Wanner, Stiff differential equations solved by Radau methods, J. Comput. Appl. Math. 111 (1999)
    93-111).
    """
    return SHARE * tolerance ** ((stages + 1) / (2 * stages))


def _errors(estimates: np.ndarray, stages: int) -> np.ndarray:
    """Local errors by embedded estimates: the inverse of `_measured`."""
    return (estimates / SHARE) ** (2 * stages / (stages + 1))


class _Call(CallMemory):
    """The memory of one call, and the record that tells a kernel of it: a field, a tableau, and scratch."""

    def __init__(
        self, field: CompiledField, c: np.ndarray, tableau: Collocation, more: int = 0, pivots: int = 0
    ) -> None:
        n, s, entries = field.n, tableau.stages, len(field.col)
        modes, numbers = (s - 1) // 2, _packed(tableau)
        size = 2 * (n + entries) + 5 * s * n + (1 + 2 * modes) * n * n + 5 * n + more
        pivot_size = (1 + modes) * n + pivots
        super().__init__(field)
        self.record = RadauCall(
            **self.field(field, c),
            tableau=self.keep(numbers),
            numbers=len(numbers),
            s=s,
            scratch=self.keep(np.empty(size)),
            size=size,
            pivots=self.keep(np.empty(pivot_size, dtype=np.int64)),
            pivot_size=pivot_size,
        )


@cache
def _packed(tableau: Collocation) -> np.ndarray:
    return tableau.packed()


def adaptive(
    field: CompiledField, c: np.ndarray, t0: float, x0: Vector, t1: float, bound: ErrorControl, method: str
) -> Path:
    """As `integrate.adaptive`; `evaluations` counts right-hand sides and Jacobians alike."""
    call = _Call(field, c, TABLEAUS[method])
    control, counts, record = RadauControl(), RadauCounts(), call.record
    record.t1, record.tolerance, record.most = t1, bound.tolerance, bound.max_steps
    record.allowed = _measured(bound.tolerance, TABLEAUS[method].stages)
    record.control, record.counts = control.address, counts.address
    call.give(weights=bound.weights)

    def march(times: np.ndarray, states: np.ndarray) -> int:
        call.give(times=times, states=states)
        record.steps = len(times) - 1
        return int(_ADAPTIVE(record.address))

    def counted() -> tuple[int, int, int, int]:
        return counts.steps, counts.evaluations + counts.jacobians, counts.rejected, 0

    return Path.grown(march, t0, x0, _ROOM, counted)[0]


def _march(
    field: CompiledField,
    c: np.ndarray,
    times: Vector,
    x0: Vector,
    method: str,
    weights: np.ndarray | None = None,
    errors: np.ndarray | None = None,
    increments: np.ndarray | None = None,
) -> np.ndarray:
    """States of a grid; what was asked for besides is written where it was given."""
    call = _Call(field, c, TABLEAUS[method])
    grid, x = np.ascontiguousarray(times, dtype=float), np.array(x0, dtype=float)
    states = np.full((len(grid), field.n), np.nan)
    call.give(times=grid, x=x, states=states, weights=weights, errors=errors, increments=increments)
    call.record.steps = len(grid) - 1
    _MARCH(call.record.address)
    return states


def along(field: CompiledField, c: np.ndarray, times: Vector, x0: Vector, method: str) -> np.ndarray:
    """As `integrate.along`."""
    return _march(field, c, times, x0, method)


def errors_on(
    field: CompiledField, c: np.ndarray, times: Vector, x0: Vector, method: str, weights: Vector
) -> np.ndarray:
    """As `integrate.errors_on`."""
    errors = np.full((len(times) - 1, 2), np.nan)
    _march(field, c, times, x0, method, np.ascontiguousarray(weights, dtype=float), errors)
    return np.maximum(_errors(errors[:, 0], TABLEAUS[method].stages), errors[:, 1])


def tangents(
    field: CompiledField, c: np.ndarray, times: Vector, x0: Vector, given: Tangents, method: str, every: bool
) -> tuple[np.ndarray, np.ndarray]:
    """As `integrate.tangents`."""
    x, X = np.array(x0, dtype=float), np.array(given.start, dtype=float, order="C")
    count = len(times) if every else 0
    states, nodes = np.full((count, *x.shape), np.nan), np.full((count, *X.shape), np.nan)
    _march_tangents(field, c, times, x, Tangents(X, given.sources), method, (states, nodes))
    return (states, nodes) if every else (x, X)


def along_with_tangents(
    field: CompiledField, c: np.ndarray, times: Vector, x0: np.ndarray, given: Tangents, method: str
) -> tuple[np.ndarray, np.ndarray]:
    """As `integrate.along_with_tangents`."""
    grid, starts = np.asarray(times, dtype=float), np.asarray(x0, dtype=float)
    states = np.full((len(grid), field.n), np.nan)
    ends = np.array([given.start] * len(starts), dtype=float)
    for part, x, X in zip(_paths(grid), starts, ends, strict=True):
        own = Tangents(X, given.sources)
        _march_tangents(field, c, grid[part], x.copy(), own, method, (states[part], np.empty(0)))
    return states, ends


def _march_tangents(
    field: CompiledField,
    c: np.ndarray,
    times: Vector,
    x: np.ndarray,
    given: Tangents,
    method: str,
    nodes: tuple[np.ndarray, np.ndarray],
) -> None:
    """Carry x, shape (n,), and tangents, shape (n, q), over a grid, in place; NaN where a step fails.

    What they are at all its times is written to `nodes`, where these are not empty.
    """
    X = given.start
    n, stages, q, entries = field.n, TABLEAUS[method].stages, X.shape[1], len(field.col)
    sn = stages * n
    more = sn * sn + sn + n + entries + sn * q
    call = _Call(field, c, TABLEAUS[method], more, sn)
    grid, driving = np.ascontiguousarray(times, dtype=float), np.asarray(given.sources, dtype=np.int64)
    call.give(times=grid, x=x, tangents=X, sources=driving, states=nodes[0], nodes=nodes[1])
    call.record.steps, call.record.q = len(grid) - 1, q
    if _TANGENTS(call.record.address) < len(grid) - 1:
        x[:], X[:] = np.nan, np.nan


class Interpolation:
    """The motion between the nodes of a path; its collocation polynomials are made once.

    Arguments as for `dense`; called with times, it gives states, shape (len(times), n).
    """

    def __init__(
        self, field: CompiledField, c: np.ndarray, times: Vector, states: np.ndarray, method: str = "radau9"
    ) -> None:
        self._tableau = TABLEAUS[method]
        self._grid, self._nodes = np.asarray(times, dtype=float), np.asarray(states, dtype=float)
        steps = max(len(self._grid) - 1, 0)
        self._increments = np.full((steps, self._tableau.stages, field.n), np.nan)
        if not steps:
            return
        for part in _paths(self._grid):
            self._made(field, c, method, part)

    def _made(self, field: CompiledField, c: np.ndarray, method: str, part: slice) -> None:
        """Fill in the increments of one path."""
        grid, nodes, found = self._grid[part], self._nodes[part], self._increments[part]
        again = _march(field, c, grid, nodes[0], method, increments=found)
        # Nodes that this march does not meet, of a part of a path for example, are gone on from one by one.
        for step in np.flatnonzero(np.any(again != nodes, axis=1)[:-1]):
            alone = np.full((1, *found.shape[1:]), np.nan)
            _march(field, c, grid[step : step + 2], nodes[step], method, increments=alone)
            found[step] = alone[0]

    def __call__(self, times: Sequence[float] | np.ndarray) -> np.ndarray:
        """States at times; NaN at those outside the path."""
        at, grid, nodes = np.asarray(times, dtype=float), self._grid, self._nodes
        found = np.full((len(at), nodes.shape[1]), np.nan)
        if len(grid) > 1:
            step = _steps(grid, at)
            part = (at - grid[step]) / (grid[step + 1] - grid[step])
            inside = (part >= 0.0) & (part <= 1.0)
            weights, which = _lagrange(self._tableau, part[inside]), step[inside]
            found[inside] = nodes[which] + np.einsum("ks,ksn->kn", weights, self._increments[which])
            # nodes are what the path says, whatever the last bits of a step that is done again
            found[part == 0.0] = nodes[step[part == 0.0]]
        found[at == grid[-1]] = nodes[-1]
        return found


def _paths(grid: np.ndarray) -> list[slice]:
    """The paths in a grid: where a time is repeated the next one begins."""
    begins = np.flatnonzero(grid[1:] == grid[:-1]) + 1
    return [slice(low, high) for low, high in pairwise([0, *begins.tolist(), len(grid)])]


def _steps(grid: np.ndarray, at: np.ndarray) -> np.ndarray:
    """The step that each time lies in, of those outside the nearest."""
    direction = 1.0 if grid[-1] >= grid[0] else -1.0
    return np.clip(np.searchsorted(direction * grid, direction * at, side="right") - 1, 0, len(grid) - 2)


def dense(
    field: CompiledField, c: np.ndarray, times: Vector, states: np.ndarray, t_values: Vector, method: str
) -> np.ndarray:
    """As `integrate.dense`, by the collocation polynomials.

    Their error is of order s + 1 in a method of order 2 s - 1.
    """
    grid, at = np.asarray(times, dtype=float), np.asarray(t_values, dtype=float)
    if len(grid) > 1 and len(at):
        wanted = _steps(grid, at)
        part = slice(wanted.min(), wanted.max() + 2)
        grid, states = grid[part], np.asarray(states)[part]
    return Interpolation(field, c, grid, states, method)(at)


def _lagrange(tableau: Collocation, at: np.ndarray) -> np.ndarray:
    """Values at fractions of a step of the polynomials that are 1 at one node, 0 at the others and at 0."""
    nodes = np.array([0.0, *tableau.nodes])
    values = np.ones((len(at), tableau.stages))
    for j in range(tableau.stages):
        for k, node in enumerate(nodes):
            if k != j + 1:
                values[:, j] *= (at - node) / (nodes[j + 1] - node)
    return values

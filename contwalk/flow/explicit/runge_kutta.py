"""Explicit Runge-Kutta methods: paths with error control, the same steps again, and their exact derivatives.

A path over a given grid is a smooth function of its start, and bitwise the same whether error control has
chosen the grid or the caller.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from contwalk.flow.compiled.addresses import address
from contwalk.flow.compiled.compiled_field import EACH, CompiledField
from contwalk.flow.compiled.entry_points import Entry
from contwalk.flow.explicit import stages
from contwalk.flow.explicit.batched_steps import MARCH_BATCHED, WORTH, Paths, marched
from contwalk.flow.explicit.columns import aligned
from contwalk.flow.explicit.driver_call import MARCH, Call, checked, method_of, times_of, undriven
from contwalk.flow.explicit.explicit_call import FIRST_ROWS, Counts, PolynomialCall, StepControl
from contwalk.flow.path import ErrorControl, Path, Tangents
from contwalk.numerics.distinct import distinct

Vector = Sequence[float] | np.ndarray

# Steps that there is room for at first.
_ROOM = 512

TABLEAUS = stages.TABLEAUS
# Whether its steps are solved for, with the Jacobian of the field.
IMPLICIT = False

# Most numbers that interpolation keeps at once.
_MOST_KEPT = 4_000_000

_DRIVERS = "contwalk.flow.explicit.drivers"
ADAPTIVE = Entry(_DRIVERS, "adaptive", "q", "qdddd")
MARCH_EACH = Entry(_DRIVERS, "march_each", "q", "q")
LEAP = Entry(_DRIVERS, "leap", "q", "qq")
POLYNOMIALS = Entry(_DRIVERS, "polynomials", "q", "q")
INTERPOLATE = Entry(_DRIVERS, "interpolate", "q", "q")


def warmup() -> None:
    """Compile everything that does not depend on the field, or find it compiled."""
    for entry in (ADAPTIVE, MARCH, MARCH_EACH, MARCH_BATCHED, LEAP, POLYNOMIALS, INTERPOLATE, EACH):
        _ = entry.address
    for name in stages.TABLEAUS:
        stages.code(name)


def adaptive(
    field: CompiledField, c: np.ndarray, t0: float, x0: Vector, t1: float, bound: ErrorControl, method: str
) -> Path:
    """As `integrate.adaptive`."""
    call = Call(field, c, method, x0)
    path, _ = _controlled(call, t0, t1, bound)
    call.over()
    return path


def adaptive_with_tangents(
    field: CompiledField,
    c: np.ndarray,
    t0: float,
    x0: Vector,
    t1: float,
    bound: ErrorControl,
    given: Tangents,
    method: str,
) -> tuple[Path, np.ndarray]:
    """As `integrate.adaptive_with_tangents`; of many tangents in two passes, the second one in lanes."""
    start = _tangents(field, given.start)
    q = start.shape[1]
    if q == 0 or start.size >= WORTH:
        path = adaptive(field, c, t0, x0, t1, bound, method)
        return path, tangents(field, c, path.times, x0, given, method, every=False)[1]
    call = Call(field, c, method, x0, q)
    call.tangents(start, given.sources)
    path, nodes = _controlled(call, t0, t1, bound)
    _, derivatives = call.split(nodes[len(path.times) - 1])
    derivatives = derivatives[:, :q].copy()
    call.over()
    return path, derivatives


def _controlled(call: Call, t0: float, t1: float, bound: ErrorControl) -> tuple[Path, np.ndarray]:
    """The path of a call's start, and the vectors at its times, shape (s, length), with room after them."""
    n = call.field.n
    call.weigh(bound.weights)
    control, counts = StepControl(time=t0), Counts()
    call.controlled(control, counts)
    call.record.most_steps, call.record.far_out = bound.max_steps, bound.far_out

    def march(times: np.ndarray, nodes: np.ndarray) -> int:
        call.record.times, call.record.nodes = address(times), address(nodes)
        call.record.room = len(times) - 1
        orders = call.method.error_order, call.method.stable
        return int(ADAPTIVE(call.record.address, t1, bound.tolerance, *orders))

    def counted() -> tuple[int, int, int, int]:
        return counts.steps, counts.evaluations, counts.rejected, counts.stiff

    return Path.grown(march, t0, call.vectors[stages.Y], _ROOM, counted, n)


def along(field: CompiledField, c: np.ndarray, times: Vector, x0: Vector, method: str) -> np.ndarray:
    """As `integrate.along`."""
    call = Call(field, c, method, x0)
    nodes = call.march(times, True)
    call.over()
    return nodes[:, : field.n].copy()


def tangents(
    field: CompiledField, c: np.ndarray, times: Vector, x0: Vector, given: Tangents, method: str, every: bool
) -> tuple[np.ndarray, np.ndarray]:
    """As `integrate.tangents`."""
    start = _tangents(field, given.start)
    q = start.shape[1]
    if q == 0:
        states = along(field, c, times, x0, method)
        return (states, np.empty((len(states), field.n, 0))) if every else (states[-1], start.copy())
    grid = times_of(times)
    if not every and (grid[1:] != grid[:-1]).all():
        state = checked(x0, (field.n,), "start")[None]
        states, derivatives = along_with_tangents(field, c, grid, state, given, method)
        return states[-1].copy(), derivatives[0]
    call = Call(field, c, method, x0, q)
    call.tangents(start, given.sources)
    x, derivatives = call.split(call.march(times, every))
    x, derivatives = x.copy(), derivatives[..., :q].copy()
    call.over()
    return (x, derivatives) if every else (x[0], derivatives[0])


def along_with_tangents(
    field: CompiledField, c: np.ndarray, times: Vector, x0: np.ndarray, given: Tangents, method: str
) -> tuple[np.ndarray, np.ndarray]:
    """As `integrate.along_with_tangents`."""
    start, grid = _tangents(field, given.start), times_of(times)
    q, paths = start.shape[1], 1 + int(np.count_nonzero(grid[1:] == grid[:-1]))
    starts = checked(x0, (paths, field.n), "starts")
    if len(given.sources) != q:
        raise undriven(field, q, given.sources)
    constants = checked(c, (max(field.constant_count, 1),), "constants")
    found = marched(field, Paths(constants, grid, starts, start), given.sources, method)
    if found is not None:
        return found
    call = Call(field, c, method, None, q)
    if q:
        call.drive(q, given.sources)
    vectors = call.give("starts", aligned(paths, call.length))
    x, derivatives = call.split(vectors)
    x[:], derivatives[..., :q] = starts, start
    states = call.give("states", np.empty((len(grid), field.n)))
    call.give("times", grid)
    call.record.room = len(grid) - 1
    MARCH_EACH(call.record.address)
    call.over()
    return states, derivatives[..., :q].copy()


def _tangents(field: CompiledField, given: np.ndarray) -> np.ndarray:
    start = np.asarray(given, dtype=float)
    if start.ndim != 2 or start.shape[0] != field.n:
        raise ValueError(f"tangents of shape {start.shape} for {field.n} states")
    return start


def errors_on(
    field: CompiledField, c: np.ndarray, times: Vector, x0: Vector, method: str, weights: Vector
) -> np.ndarray:
    """As `integrate.errors_on`."""
    call = Call(field, c, method, x0)
    call.weigh(weights)
    errors = call.give("errors", np.empty(max(len(times) - 1, 1)))
    call.march(times, False)
    call.over()
    return errors[: len(times) - 1]


def dense(
    field: CompiledField, c: np.ndarray, times: Vector, states: np.ndarray, t_values: Vector, method: str
) -> np.ndarray:
    """As `integrate.dense`.

    DOP853 interpolates by polynomials of degree 7. Verner's pair takes a shorter step from the node before.
    """
    grid, wanted = times_of(times), np.ascontiguousarray(t_values, dtype=float)
    nodes = checked(states, (len(grid), field.n), "nodes")
    found = np.full((len(wanted), field.n), np.nan)
    direction = 1.0 if grid[-1] >= grid[0] else -1.0
    inside = np.flatnonzero((direction * (wanted - grid[0]) >= 0) & (direction * (grid[-1] - wanted) >= 0))
    if len(grid) == 1:
        found[inside] = nodes[0]
        return found
    call = Call(field, c, method, None)
    call.give("times", grid)
    call.give("nodes", nodes)
    between = _interpolated if call.method.dense else _leapt
    found[inside] = between(call, direction * grid, nodes, direction * wanted[inside], wanted[inside])
    call.over()
    return found


def _steps_of(grid: np.ndarray, at: np.ndarray) -> np.ndarray:
    """On which step of a growing grid each time lies: the last that begins there or before."""
    which = np.searchsorted(grid, at, side="right") - 1
    return np.minimum(np.maximum(which, 0), len(grid) - 2)


def _leapt(call: Call, grid: np.ndarray, nodes: np.ndarray, at: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """A step from the node before to each time; `grid` and `at` grow where the path goes backwards, too."""
    which = _steps_of(grid, at)
    call.give("which", np.ascontiguousarray(which, dtype=np.int64))
    out = call.give("out", np.empty((len(at), call.length)))
    call.record.room = len(at)
    LEAP(call.record.address, address(wanted))
    found = out[:, : call.field.n]
    for node in (which, which + 1):
        met = at == grid[node]
        found[met] = nodes[node[met]]
    return found


def _interpolated(
    call: Call, grid: np.ndarray, nodes: np.ndarray, at: np.ndarray, _: np.ndarray
) -> np.ndarray:
    """The polynomials of the steps, as many at once as memory allows; `grid` and `at` as for `_leapt`."""
    found = np.empty((len(at), call.field.n))
    which = _steps_of(grid, at)
    steps = distinct(which)
    belongs = np.searchsorted(steps, which)
    batch = max(1, _MOST_KEPT // ((FIRST_ROWS + len(call.method.dense)) * call.field.n))
    own = np.zeros(len(grid) - 1, dtype=np.int64)
    for first in range(0, len(steps), batch):
        chosen = np.ascontiguousarray(steps[first : first + batch], dtype=np.int64)
        own[chosen] = np.arange(len(chosen))
        rows = np.flatnonzero((belongs >= first) & (belongs < first + len(chosen)))
        found[rows] = _polynomial(grid, nodes, _coefficients(call, chosen), own, at[rows])
    return found


def _coefficients(call: Call, chosen: np.ndarray) -> np.ndarray:
    """Coefficients of the polynomials of steps, shape (steps, rows, n); the call knows times and nodes."""
    call.give("which", chosen)
    rows = FIRST_ROWS + len(call.method.dense)
    out = call.give("out", np.empty((len(chosen), rows, call.field.n)))
    call.record.room = len(chosen)
    POLYNOMIALS(call.record.address)
    return out


def _polynomial(
    grid: np.ndarray, nodes: np.ndarray, coefficients: np.ndarray, own: np.ndarray, at: np.ndarray
) -> np.ndarray:
    """States at times within a growing grid; `own` tells which of the polynomials is whose step's."""
    return _interpolating(grid, nodes, coefficients, own)(at)


def _interpolating(
    grid: np.ndarray, nodes: np.ndarray, coefficients: np.ndarray, own: np.ndarray
) -> Callable[[np.ndarray], np.ndarray]:
    """As `_polynomial`, a function of the times, which tells machine code of the path once."""
    (_, rows, n), kept = coefficients.shape, (grid, nodes, coefficients, own)
    times, states, given, which = map(address, kept)
    call = PolynomialCall(
        times=times, nodes=states, coefficients=given, which=which, steps=len(grid) - 1, n=n, rows=rows
    )

    def at_times(at: np.ndarray, _kept: Sequence[np.ndarray] = kept) -> np.ndarray:
        out = np.empty((len(at), n))
        call.wanted, call.count, call.out = address(at), len(at), address(out)
        INTERPOLATE(call.address)
        return out

    return at_times


class Interpolation:
    """The motion between the nodes of a path; its polynomials are made once.

    Arguments as for `dense`; called with times, it gives states, shape (len(times), n).
    """

    def __init__(
        self, field: CompiledField, c: np.ndarray, times: Vector, states: np.ndarray, method: str = "dop853"
    ) -> None:
        self._given = field, c, times, states
        self._method = method
        self._grid = times_of(times)
        self._nodes = checked(states, (len(self._grid), field.n), "nodes")
        self._between: Callable[[np.ndarray], np.ndarray] | None = None
        # Where a path begins anew there is no polynomial.
        moves = self._grid[1:] > self._grid[:-1]
        if method_of(method).dense and moves.any():
            call = Call(field, c, method, None)
            call.give("times", self._grid)
            call.give("nodes", self._nodes)
            coefficients = _coefficients(call, np.flatnonzero(moves))
            self._between = _interpolating(self._grid, self._nodes, coefficients, np.cumsum(moves) - 1)
            call.over()

    def __call__(self, times: Vector) -> np.ndarray:
        """States at times within the path."""
        at = np.ascontiguousarray(times, dtype=float)
        return dense(*self._given, at, self._method) if self._between is None else self._between(at)

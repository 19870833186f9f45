"""Explicit Runge-Kutta methods: paths with error control, the same steps again, and their exact derivatives.

A path over a given grid is a smooth function of its start, and bitwise the same whether error control has
chosen the grid or the caller.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from contwalk.flow.compiled.addresses import address
from contwalk.flow.compiled.call_record import CallRecord
from contwalk.flow.compiled.compiled_field import EACH, CompiledField
from contwalk.flow.compiled.entry_points import Entry
from contwalk.flow.explicit import stages
from contwalk.flow.explicit.batched_steps import MARCH_BATCHED, Paths, marched
from contwalk.flow.explicit.columns import aligned, driving, padded
from contwalk.flow.explicit.explicit_call import (
    FIRST_ROWS,
    FULL,
    STATUS,
    Counts,
    ExplicitCall,
    PolynomialCall,
    StepControl,
)
from contwalk.flow.path import ErrorControl, Path, Tangents
from contwalk.flow.tableaus.runge_kutta import RungeKutta
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
MARCH = Entry(_DRIVERS, "march", "q", "q")
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


class Form:
    """What all calls of a method with so many tangents of a field have in common.

    `record` is what a driver is told of it; it is copied, and never written to.
    """

    def __init__(self, field: CompiledField, method: str, columns: int) -> None:
        self.method = _method(method)
        self.start = padded(field.n)
        self.width = padded(columns)
        self.length = self.start + field.n * self.width
        self.vectors = stages.vectors(self.method)
        self._dense = _weights_of(method, self.vectors - stages.FIRST)
        code = stages.code(method)
        self.record = ExplicitCall(
            step=code.addresses["step"],
            error=code.addresses["error"],
            extend=code.addresses.get("extend", 0),
            evaluate=code.addresses["tangent" if columns else "plain"],
            n=field.n,
            length=self.length,
            vectors=self.vectors,
            last_stage=stages.FIRST + self.method.stages - 1,
            dense=address(self._dense),
            rows=len(self._dense),
        )


class Call:
    """The memory of one call, and the record that tells a driver of it."""

    def __init__(
        self, field: CompiledField, c: np.ndarray, method: str, x0: Vector | None, columns: int = 0
    ) -> None:
        form = field.forms.get((method, columns))
        if form is None:
            form = field.forms[method, columns] = Form(field, method, columns)
        self.field, self.method = field, form.method
        self.start, self.width, self.length = form.start, form.width, form.length
        self.vectors = aligned(form.vectors, self.length)
        self._c = _checked(c, (max(field.constant_count, 1),), "constants")
        if x0 is not None:
            self.vectors[stages.Y, : field.n] = _checked(x0, (field.n,), "start")
        self._kept: list[np.ndarray | CallRecord] = []
        self._inverse: np.ndarray | None = None
        self.record = ExplicitCall.from_buffer_copy(form.record)
        self.record.work = address(self.vectors)
        if not columns:
            self.give("problem", np.array([field.rhs_address, address(self._c)], dtype=np.int64))

    def give(self, name: str, array: np.ndarray) -> np.ndarray:
        """Put an array of any shape where the driver finds it: its address into a field of the record."""
        self._kept.append(array)
        setattr(self.record, name, address(array))
        return array

    def controlled(self, control: StepControl, counts: Counts) -> None:
        """Tell the driver where it remembers what error control needs, and where it counts its work."""
        self._kept += [control, counts]
        self.record.control, self.record.counts = control.address, counts.address

    def weigh(self, weights: Vector) -> None:
        """Tell the driver by which magnitudes, shape (n,), errors are measured."""
        n = self.field.n
        given = _checked(weights, (n,), "weights")
        if not (given > 0.0).all():
            raise ValueError("weights are positive")
        if self._inverse is None:
            self._inverse = self.give("inverse_weights", np.zeros(self.length))
        self._inverse[:n] = 1.0 / given

    def tangents(self, x: np.ndarray, sources: Sequence[int] | np.ndarray) -> None:
        """Begin with these tangents, shape (n, q), each driven by its parameter column."""
        self.drive(x.shape[1], sources)
        self.split(self.vectors[stages.Y])[1][:, : x.shape[1]] = x

    def drive(self, q: int, sources: Sequence[int] | np.ndarray) -> None:
        """Tell the driver of q tangents, each driven by its parameter column: `sources`, shape (q,)."""
        field = self.field
        if len(sources) != q:
            raise _undriven(field, q, sources)
        driven = driving(field.k, self.width, sources)
        buffer = np.empty(field.n + len(field.col))
        self._kept += [driven, buffer]
        addresses = [field.rhs_jac_address, address(self._c), field.product_address]
        addresses += [
            self.width // stages.WIDTH,
            address(driven),
            address(buffer),
            field.n,
            self.start,
        ]
        self.give("problem", np.array(addresses, dtype=np.int64))

    def split(self, vectors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """States (.., n) and padded tangents (.., n, width) of vectors, shape (.., length), as views."""
        n, shape = self.field.n, (*vectors.shape[:-1], self.field.n, self.width)
        return vectors[..., :n], vectors[..., self.start :].reshape(shape)

    def march(self, times: Vector, every: bool) -> np.ndarray:
        """Vectors at the s given times, or at the last one: shape (s, length), or (1, length)."""
        grid = self.give("times", _grid(times))
        nodes = np.empty((len(grid) if every else 1, self.length))
        nodes[0] = self.vectors[stages.Y]
        self.give("nodes", nodes)
        self.record.room, self.record.every = len(grid) - 1, every
        MARCH(self.record.address)
        return nodes


def adaptive(
    field: CompiledField, c: np.ndarray, t0: float, x0: Vector, t1: float, bound: ErrorControl, method: str
) -> Path:
    """As `integrate.adaptive`."""
    call = Call(field, c, method, x0)
    call.weigh(bound.weights)
    control, counts = StepControl(time=t0), Counts()
    call.controlled(control, counts)
    call.record.most_steps, call.record.far_out = bound.max_steps, bound.far_out
    times, nodes = np.empty(_ROOM + 1), np.empty((_ROOM + 1, call.length))
    times[0], nodes[0] = t0, call.vectors[stages.Y]
    while True:
        call.record.times, call.record.nodes = address(times), address(nodes)
        call.record.room = len(times) - 1
        answer = ADAPTIVE(
            call.record.address, t1, bound.tolerance, call.method.error_order, call.method.stable
        )
        if answer != FULL:
            break
        times = np.concatenate([times, np.empty(len(times))])
        nodes = np.concatenate([nodes, np.empty_like(nodes)])
    steps = counts.steps
    return Path(
        times=times[: steps + 1].copy(),
        states=nodes[: steps + 1, : field.n].copy(),
        evaluations=counts.evaluations,
        rejected=counts.rejected,
        stiff_fraction=counts.stiff / max(steps, 1),
        status=STATUS[answer],
    )


def along(field: CompiledField, c: np.ndarray, times: Vector, x0: Vector, method: str) -> np.ndarray:
    """As `integrate.along`."""
    call = Call(field, c, method, x0)
    return call.march(times, True)[:, : field.n].copy()


def tangents(
    field: CompiledField,
    c: np.ndarray,
    times: Vector,
    x0: Vector,
    given: Tangents,
    method: str,
    every: bool,
) -> tuple[np.ndarray, np.ndarray]:
    """As `integrate.tangents`."""
    start = _tangents(field, given.start)
    q = start.shape[1]
    if q == 0:
        states = along(field, c, times, x0, method)
        return (states, np.empty((len(states), field.n, 0))) if every else (states[-1], start.copy())
    grid = _grid(times)
    if not every and (grid[1:] != grid[:-1]).all():
        state = _checked(x0, (field.n,), "start")[None]
        states, derivatives = along_with_tangents(field, c, grid, state, given, method)
        return states[-1].copy(), derivatives[0]
    call = Call(field, c, method, x0, q)
    call.tangents(start, given.sources)
    x, derivatives = call.split(call.march(times, every))
    x, derivatives = x.copy(), derivatives[..., :q].copy()
    return (x, derivatives) if every else (x[0], derivatives[0])


def along_with_tangents(
    field: CompiledField, c: np.ndarray, times: Vector, x0: np.ndarray, given: Tangents, method: str
) -> tuple[np.ndarray, np.ndarray]:
    """As `integrate.along_with_tangents`."""
    start, grid = _tangents(field, given.start), _grid(times)
    q, paths = start.shape[1], 1 + int(np.count_nonzero(grid[1:] == grid[:-1]))
    starts = _checked(x0, (paths, field.n), "starts")
    if len(given.sources) != q:
        raise _undriven(field, q, given.sources)
    constants = _checked(c, (max(field.constant_count, 1),), "constants")
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
    return states, derivatives[..., :q].copy()


def _undriven(field: CompiledField, q: int, sources: Sequence[int] | np.ndarray) -> ValueError:
    return ValueError(f"{q} tangents of a field with {field.k} columns are driven by {list(sources)}")


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
    return errors[: len(times) - 1]


def dense(
    field: CompiledField, c: np.ndarray, times: Vector, states: np.ndarray, t_values: Vector, method: str
) -> np.ndarray:
    """As `integrate.dense`.

    DOP853 interpolates by polynomials of degree 7. Verner's pair takes a shorter step from the node before.
    """
    grid, wanted = _grid(times), np.ascontiguousarray(t_values, dtype=float)
    nodes = _checked(states, (len(grid), field.n), "nodes")
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
    (_, rows, n), out = coefficients.shape, np.empty((len(at), nodes.shape[1]))
    call = PolynomialCall(
        times=address(grid),
        nodes=address(nodes),
        coefficients=address(coefficients),
        which=address(own),
        steps=len(grid) - 1,
        n=n,
        rows=rows,
        wanted=address(at),
        count=len(at),
        out=address(out),
    )
    INTERPOLATE(call.address)
    return out


@lru_cache
def _weights_of(name: str, vectors: int) -> np.ndarray:
    """What each stage contributes to the further coefficients, shape (rows, stages)."""
    method = _method(name)
    weights = np.zeros((len(method.dense), vectors))
    for row, entries in zip(weights, method.dense, strict=True):
        for stage, d in entries.items():
            row[stage] = d
    return weights


class Interpolation:
    """The motion between the nodes of a path; its polynomials are made once.

    Arguments as for `dense`; called with times, it gives states, shape (len(times), n).
    """

    def __init__(
        self, field: CompiledField, c: np.ndarray, times: Vector, states: np.ndarray, method: str = "dop853"
    ) -> None:
        self._given = field, c, times, states
        self._method = method
        self._grid = _grid(times)
        self._nodes = _checked(states, (len(self._grid), field.n), "nodes")
        self._coefficients: np.ndarray | None = None
        # Where a path begins anew there is no polynomial.
        moves = self._grid[1:] > self._grid[:-1]
        if _method(method).dense and moves.any():
            call = Call(field, c, method, None)
            call.give("times", self._grid)
            call.give("nodes", self._nodes)
            self._own = np.cumsum(moves) - 1
            self._coefficients = _coefficients(call, np.flatnonzero(moves))

    def __call__(self, times: Vector) -> np.ndarray:
        """States at times within the path."""
        at = np.ascontiguousarray(times, dtype=float)
        if self._coefficients is None:
            return dense(*self._given, at, self._method)
        return _polynomial(self._grid, self._nodes, self._coefficients, self._own, at)


def _method(name: str) -> RungeKutta:
    if name not in stages.TABLEAUS:
        raise ValueError(f"'{name}' is none of {', '.join(stages.TABLEAUS)}")
    return stages.TABLEAUS[name]


def _grid(times: Vector) -> np.ndarray:
    grid = np.ascontiguousarray(times, dtype=float)
    if grid.ndim != 1 or len(grid) == 0:
        raise ValueError(f"a grid of shape {grid.shape}")
    return grid


def _checked(values: Vector, shape: tuple[int, ...], what: str) -> np.ndarray:
    array = np.ascontiguousarray(values, dtype=float)
    if array.shape != shape:
        raise ValueError(f"{what} of shape {array.shape} instead of {shape}")
    return array

"""One call of the drivers of explicit methods: its memory, and the record that tells a driver of it."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from contwalk.flow.compiled.addresses import address
from contwalk.flow.compiled.call_record import CallRecord
from contwalk.flow.compiled.compiled_field import CompiledField
from contwalk.flow.compiled.entry_points import Entry
from contwalk.flow.explicit import stages
from contwalk.flow.explicit.columns import aligned, driving, padded
from contwalk.flow.explicit.explicit_call import Counts, ExplicitCall, StepControl
from contwalk.flow.tableaus.runge_kutta import RungeKutta

Vector = Sequence[float] | np.ndarray

MARCH = Entry("contwalk.flow.explicit.drivers", "march", "q", "q")

# Bytes of vectors up to which calls leave them to each other: beside larger ones, making them takes no time.
_SMALL = 1 << 16
# Numbers that functions of `stages` know of a field at most.
_NUMBERS = 8


class Form:
    """What all calls of a method with so many tangents of a field have in common.

    `record` is what a driver is told of it; it is copied, and never written to. `spare` is memory of calls
    that are over: most calls take less time than it takes to make it.
    """

    def __init__(self, field: CompiledField, method: str, columns: int) -> None:
        self.method = method_of(method)
        self.start = padded(field.n)
        self.width = padded(columns)
        self.length = self.start + field.n * self.width
        self.vectors = stages.vectors(self.method)
        self.spare: list[Memory] = []
        self._dense = weights_of(method, self.vectors - stages.FIRST)
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

    def memory(self) -> Memory:
        """Memory for one call, as if it were new."""
        try:
            spare = self.spare.pop()
        except IndexError:
            spare = Memory(self)
        return spare.cleared(self)


class Memory:
    """What a driver writes to, and the record that tells it of that; one call has it at a time.

    The vectors have the shape (number of vectors, length).
    """

    def __init__(self, form: Form) -> None:
        self.vectors = aligned(form.vectors, form.length)
        self.record, self._problem = ExplicitCall(), (ctypes.c_int64 * _NUMBERS)()
        self._place, self._size = self.record.address, ctypes.sizeof(self.record)
        self._work, self._problem_place = address(self.vectors), ctypes.addressof(self._problem)

    def cleared(self, form: Form) -> Memory:
        """As it was made: nothing is left of the call before, which may have met what is not finite."""
        self.vectors.fill(0.0)
        ctypes.memmove(self._place, form.record.address, self._size)
        self.record.work, self.record.problem = self._work, self._problem_place
        return self

    def given(self, *numbers: int) -> None:
        """What the functions of `stages` are told of the field: addresses, and numbers."""
        self._problem[: len(numbers)] = list(numbers)


class Call:
    """The memory of one call, and the record that tells a driver of it.

    When it is `over` its vectors are another one's: what is to stay is copied before. The constants have the
    shape (c,), a start (n,).
    """

    def __init__(
        self, field: CompiledField, c: np.ndarray, method: str, x0: Vector | None, columns: int = 0
    ) -> None:
        form = field.forms.get((method, columns))
        if form is None:
            form = field.forms[method, columns] = Form(field, method, columns)
        self.field, self.method = field, form.method
        self.start, self.width, self.length = form.start, form.width, form.length
        self._form = form
        self._memory = form.memory()
        self.vectors, self.record = self._memory.vectors, self._memory.record
        self._c = checked(c, (max(field.constant_count, 1),), "constants")
        if x0 is not None:
            self.vectors[stages.Y, : field.n] = checked(x0, (field.n,), "start")
        self._kept: list[np.ndarray | CallRecord] = []
        self._inverse: np.ndarray | None = None
        if not columns:
            self._memory.given(field.rhs_address, address(self._c))

    def over(self) -> None:
        """Leave the memory to another call."""
        if self.vectors.nbytes <= _SMALL:
            self._form.spare.append(self._memory)

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
        given = checked(weights, (n,), "weights")
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
            raise undriven(field, q, sources)
        driven = driving(field.k, self.width, sources)
        buffer = np.empty(field.n + len(field.col))
        self._kept += [driven, buffer]
        at = field.rhs_jac_address, address(self._c), field.product_address
        blocks = self.width // stages.WIDTH
        self._memory.given(*at, blocks, address(driven), address(buffer), field.n, self.start)

    def split(self, vectors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """States (.., n) and padded tangents (.., n, width) of vectors, shape (.., length), as views."""
        n, shape = self.field.n, (*vectors.shape[:-1], self.field.n, self.width)
        return vectors[..., :n], vectors[..., self.start :].reshape(shape)

    def march(self, times: Vector, every: bool) -> np.ndarray:
        """Vectors at the s given times, or at the last one: shape (s, length), or (1, length)."""
        grid = self.give("times", times_of(times))
        nodes = np.empty((len(grid) if every else 1, self.length))
        nodes[0] = self.vectors[stages.Y]
        self.give("nodes", nodes)
        self.record.room, self.record.every = len(grid) - 1, every
        MARCH(self.record.address)
        return nodes


@lru_cache
def weights_of(name: str, vectors: int) -> np.ndarray:
    """What each stage contributes to the further coefficients, shape (rows, stages)."""
    method = method_of(name)
    weights = np.zeros((len(method.dense), vectors))
    for row, entries in zip(weights, method.dense, strict=True):
        for stage, d in entries.items():
            row[stage] = d
    return weights


def method_of(name: str) -> RungeKutta:
    """The method of a name.

    Raises
    ------
    ValueError
        If there is none.
    """
    if name not in stages.TABLEAUS:
        raise ValueError(f"'{name}' is none of {', '.join(stages.TABLEAUS)}")
    return stages.TABLEAUS[name]


def times_of(times: Vector) -> np.ndarray:
    """Times as an array, shape (s,).

    Raises
    ------
    ValueError
        If they are none.
    """
    grid = np.ascontiguousarray(times, dtype=float)
    if grid.ndim != 1 or len(grid) == 0:
        raise ValueError(f"a grid of shape {grid.shape}")
    return grid


def checked(values: Vector, shape: tuple[int, ...], what: str) -> np.ndarray:
    """Numbers as an array of a shape.

    Raises
    ------
    ValueError
        If they have another one.
    """
    array = np.ascontiguousarray(values, dtype=float)
    if array.shape != shape:
        raise ValueError(f"{what} of shape {array.shape} instead of {shape}")
    return array


def undriven(field: CompiledField, q: int, sources: Sequence[int] | np.ndarray) -> ValueError:
    return ValueError(f"{q} tangents of a field with {field.k} columns are driven by {list(sources)}")

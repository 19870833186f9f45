"""Many motions in threads: when each crosses a level, and whether it comes to rest."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass

import numpy as np

from contwalk.flow.compiled.compiled_field import CompiledField
from contwalk.flow.compiled.entry_points import Entry
from contwalk.flow.ensemble.sampling_records import SampleResult, SamplingCall
from contwalk.flow.events.guard import Guard
from contwalk.flow.events.guard_code import OUTPUTS
from contwalk.flow.explicit.stages import FIRST, WIDTH, code, vectors
from contwalk.flow.tableaus.runge_kutta import DOP853

BATCH = 25  # motions to a call: enough to keep threads apart, few enough for a bar that moves
MOST_STEPS = 20_000_000

_BATCH = Entry("contwalk.flow.ensemble.sampling_kernel", "batch", "q", "qqqd")


@dataclass(frozen=True, eq=False)
class Motions:
    """What is to be computed, for k samples.

    Parameters
    ----------
    field : CompiledField
    guard : Guard
        Its crossings of zero, in its direction, are what is measured.
    starts : ndarray, shape (k, n)
    parameters : ndarray, shape (k, m)
    targets : ndarray, shape (k, q, n)
        Where each motion may come to rest; NaN where there are fewer.
    limits : ndarray, shape (k,)
        Times at which they are given up.
    within, periods : ndarray, shape (n,)
        Distances of the stop rule (inf: not looked at), periods of angles (0: none).
    first : bool
        Whether the first crossing is wanted, which ends a motion, or the last one before it rests.
    """

    field: CompiledField
    guard: Guard
    starts: np.ndarray
    parameters: np.ndarray
    targets: np.ndarray
    limits: np.ndarray
    within: np.ndarray
    periods: np.ndarray
    first: bool = False


@dataclass(frozen=True, eq=False)
class Measured:
    """What became of k motions.

    Parameters
    ----------
    crossed_at : ndarray, shape (k,)
        Instant of the crossing; 0 where there was none.
    crossed : ndarray of bool
    ended_at : ndarray
        When it rested, or was given up.
    ended : ndarray of int
        One of `SETTLED`, `TIME_UP`, `NOT_FINITE`, `GIVEN_UP`, `FOUND` of `sampling_records`.
    """

    crossed_at: np.ndarray
    crossed: np.ndarray
    ended_at: np.ndarray
    ended: np.ndarray


def measure(
    motions: Motions,
    tolerance: float,
    weights: np.ndarray,
    threads: int | None = None,
    finished: Callable[[range, Measured], None] | None = None,
) -> Measured:
    """Compute all motions with DOP853; the result does not depend on the number of threads.

    Parameters
    ----------
    motions : Motions
    tolerance : float
        Local error of each step, in units of `weights`.
    weights : ndarray, shape (n,)
    threads : int, optional
        As many as there are processors by default.
    finished : callable, optional
        Given which motions a thread has done, by their places among `motions`, and what became of them, as
        soon as they are done: neighbouring ones, but not in their order. After an interruption it is given
        those that threads were at.
    """
    count = len(motions.starts)
    work = _Work(motions, weights)
    threads = threads or os.cpu_count() or 1
    jobs = deque(range(first, min(first + BATCH, count)) for first in range(0, count, BATCH))
    _BATCH(work.call().address, 0, 0, tolerance)  # compiled before the threads begin
    # each thread has its own record, which is given back when its batch is done
    free = [work.call() for _ in range(threads)]
    running: dict[Future[int], tuple[range, SamplingCall]] = {}

    def take(future: Future[int]) -> None:
        places, own = running.pop(future)
        free.append(own)
        future.result()
        if finished is not None:
            finished(places, work.measured(places))

    try:
        with ThreadPoolExecutor(threads) as pool:
            while jobs or running:
                while jobs and free:
                    places, own = jobs.popleft(), free.pop()
                    running[pool.submit(_BATCH, own.address, places.start, places.stop, tolerance)] = (
                        places,
                        own,
                    )
                done, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in done:
                    take(future)
    finally:
        for future in list(running):  # the pool has waited for them
            take(future)
    return work.measured(range(count))


def warmup() -> None:
    """Compile what does not depend on the field, or find it compiled."""
    _ = _BATCH.address, code("dop853")


class _Work:
    """Arrays that the compiled loop reads and writes."""

    def __init__(self, motions: Motions, weights: np.ndarray) -> None:
        field, guard, n = motions.field, motions.guard, motions.field.n
        self._length = -(-n // WIDTH) * WIDTH
        self._stages = vectors(DOP853) - FIRST
        coefficients = np.zeros((4, self._stages))
        for row, terms in enumerate(DOP853.dense):
            for stage, value in terms.items():
                coefficients[row, stage] = value
        inverse = np.zeros(self._length)
        inverse[:n] = 1.0 / weights
        count = len(motions.starts)
        self.results = np.zeros((count, len(SampleResult._fields_)))
        self._arrays = {
            "inverse_weights": inverse,
            "coefficients": coefficients,
            "within": motions.within,
            "periods": motions.periods,
            "starts": motions.starts,
            "fields": np.array([field.constants(p) for p in motions.parameters]),
            "values": motions.parameters,
            "places": motions.targets,
            "limits": motions.limits,
        }
        self._arrays = {name: np.ascontiguousarray(a, dtype=float) for name, a in self._arrays.items()}
        self._method = code("dop853")  # kept: the code lives as long as the object
        method = self._method.addresses
        self._fixed = {
            "step": method["step"],
            "error": method["error"],
            "extend": method["extend"],
            "evaluate": method["plain"],
            "rhs": field.rhs_address,
            "guard": guard.address,
            "n": n,
            "length": self._length,
            "stages": self._stages,
            "constants": self._arrays["fields"].shape[1],
            "parameters": motions.parameters.shape[1],
            "targets": motions.targets.shape[1],
            "direction": guard.direction,
            "first_only": int(motions.first),
            "most_steps": MOST_STEPS,
            "results": self.results.ctypes.data,
        }
        self._kept: list[np.ndarray] = []

    def measured(self, places: range) -> Measured:
        """What the loop has found of the motions at these k places."""
        at, crossed, ended_at, ended = self.results[places.start : places.stop].T
        return Measured(at.copy(), crossed != 0.0, ended_at.copy(), ended.astype(int))

    def call(self) -> SamplingCall:
        """The record for one thread, with memory of its own."""
        n = self._fixed["n"]
        own = {
            "work": np.zeros((vectors(DOP853), self._length)),
            "dense": np.zeros(7 * n),
            "spare": np.zeros(self._length),
            "speed": np.zeros(self._length),
            "measured": np.zeros(OUTPUTS),
            "problem": np.zeros(2, dtype=np.int64),
        }
        self._kept += own.values()
        addresses = {name: array.ctypes.data for name, array in {**self._arrays, **own}.items()}
        return SamplingCall(**self._fixed, **addresses)

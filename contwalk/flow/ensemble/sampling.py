"""Many motions in threads: when each crosses a level, and whether it comes to rest."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass

import numpy as np

from contwalk.flow.compiled.compiled_field import CompiledField
from contwalk.flow.compiled.entry_points import Entry
from contwalk.flow.ensemble import sampling_plan as plan
from contwalk.flow.events.guard import Guard
from contwalk.flow.events.guard_code import OUTPUTS
from contwalk.flow.explicit.stages import FIRST, WIDTH, code, vectors
from contwalk.flow.tableaus.dop853 import DOP853

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
        One of `SETTLED`, `TIME_UP`, `NOT_FINITE`, `GIVEN_UP`, `FOUND` of `sampling_plan`.
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
    progress: Callable[[int], None] | None = None,
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
    progress : callable, optional
        Told, now and then, how many motions more are done.
    """
    count = len(motions.starts)
    work = _Work(motions, weights)
    threads = threads or os.cpu_count() or 1
    jobs = [(first, min(first + BATCH, count)) for first in range(0, count, BATCH)]
    _BATCH(work.plan().ctypes.data, 0, 0, tolerance)  # compiled before the threads begin
    with ThreadPoolExecutor(threads) as pool:
        # each thread has its own plan, which is given back when its batch is done
        free = [work.plan() for _ in range(threads)]
        running: dict[Future[int], np.ndarray] = {}
        while jobs or running:
            while jobs and free:
                own = free.pop()
                first, last = jobs.pop(0)
                future = pool.submit(_BATCH, own.ctypes.data, first, last, tolerance)
                running[future] = own
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                free.append(running.pop(future))
                if progress is not None:
                    progress(future.result())
    at, crossed, ended_at, ended = work.results.T
    return Measured(at.copy(), crossed != 0.0, ended_at.copy(), ended.astype(int))


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
        self.results = np.zeros((count, plan.RESULT_LENGTH))
        self._arrays = {
            plan.INVERSE_WEIGHTS: inverse,
            plan.COEFFICIENTS: coefficients,
            plan.WITHIN: motions.within,
            plan.PERIODS: motions.periods,
            plan.STARTS: motions.starts,
            plan.FIELDS: np.array([field.constants(p) for p in motions.parameters]),
            plan.VALUES: motions.parameters,
            plan.PLACES: motions.targets,
            plan.LIMITS: motions.limits,
        }
        self._arrays = {place: np.ascontiguousarray(a, dtype=float) for place, a in self._arrays.items()}
        self._method = code("dop853")  # kept: the code lives as long as the object
        method = self._method.addresses
        self._fixed = {
            plan.STEP: method["step"],
            plan.ERROR: method["error"],
            plan.EXTEND: method["extend"],
            plan.EVALUATE: method["plain"],
            plan.RHS: field.rhs_address,
            plan.GUARD: guard.address,
            plan.N: n,
            plan.LENGTH: self._length,
            plan.STAGES: self._stages,
            plan.CONSTANTS: self._arrays[plan.FIELDS].shape[1],
            plan.PARAMETERS: motions.parameters.shape[1],
            plan.TARGETS: motions.targets.shape[1],
            plan.DIRECTION: guard.direction,
            plan.FIRST_ONLY: int(motions.first),
            plan.MOST_STEPS: MOST_STEPS,
            plan.RESULTS: self.results.ctypes.data,
        }
        self._kept: list[np.ndarray] = []

    def plan(self) -> np.ndarray:
        """The array for one thread, with memory of its own."""
        n = self._fixed[plan.N]
        own = {
            plan.WORK: np.zeros((vectors(DOP853), self._length)),
            plan.DENSE: np.zeros(7 * n),
            plan.SPARE: np.zeros(self._length),
            plan.SPEED: np.zeros(self._length),
            plan.MEASURED: np.zeros(OUTPUTS),
            plan.PROBLEM: np.zeros(2, dtype=np.int64),
        }
        self._kept += own.values()
        made = np.zeros(plan.PLAN_LENGTH, dtype=np.int64)
        for place, number in self._fixed.items():
            made[place] = number
        for place, array in {**self._arrays, **own}.items():
            made[place] = array.ctypes.data
        return made

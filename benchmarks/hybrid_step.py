"""Time of one whole step of a walker with the derivative of the map, at the accuracy reached.

    python benchmarks/hybrid_step.py [--repeats 7] [--ways contwalk]

The walker of `systems/planar_walker` goes through two modes, of 6 and of 4 states: from right after a heel
strike over the knee strike to right after the next heel strike. Both events are located, the resets applied,
and deviations carried through by their saltation matrices. SciPy's `solve_ivp` integrates the same machine
code of field and deviations, with the same compiled guards as events.

Each way runs at many tolerances. For each the error that is *reached* is measured (time, state and matrix),
and the CPU time at an error of 1e-6, 1e-9 and 1e-12 is interpolated between them. All runs take turns, so
that a busy machine slows all of them; medians. The reference is computed by another method, arc by arc, at
1e-14.
"""

from __future__ import annotations

import argparse
import ctypes
import math
import os
import platform
import time
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass

import numpy as np
from event_map import StepMap
from orbit_and_monodromy import LEAST_SECONDS, TARGETS, Run, seconds_at

from contwalk.flow.explicit import stages
from contwalk.flow.explicit.driver_call import Call
from contwalk.flow.hybrid.motions import HybridMachine, applied, hybrid_machine
from contwalk.flow.hybrid.saltation import saltation
from contwalk.system import load_system

Result = tuple[float, np.ndarray, np.ndarray]
TOLERANCES = [10.0 ** (-k / 2) for k in range(5, 28)]
BEFORE = np.array([-0.5196, 0.1528388, 0.0, 0.0, -1.933, -2.037, 0.0])
WEIGHTS = np.array([0.5, 0.5, 1.0, 1.0, 2.0, 4.0, 10.0])
COLUMNS = 6
FIRST, SECOND = ("three_link", "knee_strike"), ("two_link", "heel_strike")


@dataclass(frozen=True, eq=False)
class Way:
    """A way to compute a step: `prepare(tolerance)` gives a function that does; `exact` is the answer."""

    name: str
    prepare: Callable[[float], Callable[[], Result]]
    exact: Result
    tolerances: list[float]

    def error(self, found: Result) -> float:
        """The largest of the errors of time, states in units of their weights, and matrix."""
        t, x, matrix = (np.asarray(part) - exact for part, exact in zip(found, self.exact, strict=True))
        size = np.abs(self.exact[2]).max()
        return float(max(abs(t), np.abs(x / WEIGHTS).max(), np.abs(matrix).max() / size))


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--ways", nargs="*", default=[""], help="parts of the names; all by default")
    given = parser.parse_args()
    print(f"python {platform.python_version()}, numpy {np.__version__}, {os.cpu_count()} cores, CPU seconds")
    chosen = [way for way in ways() if any(part in way.name for part in given.ways)]
    measured = [
        [prepared(way.prepare, way.error, tolerance) for tolerance in way.tolerances] for way in chosen
    ]
    for _ in range(given.repeats):
        take_turns(run for runs in measured for run in runs)
    targets = "".join(f"{f'at {target:.0e}':>22}" for target in TARGETS)
    print(f"{'microseconds, and ratio to the first line':44}{targets}{'best reached':>15}")
    base = [seconds_at(measured[0], target) for target in TARGETS]
    for way, runs in zip(chosen, measured, strict=True):
        cells = ""
        for target, unit in zip(TARGETS, base, strict=True):
            seconds = seconds_at(runs, target)
            ratio = f"({seconds / unit:.2f})" if seconds and unit else ""
            cells += f"{f'{1e6 * seconds:.0f} {ratio:>9}' if seconds else '-':>22}"
        print(f"{way.name:44}{cells}{min(run.error for run in runs):>15.0e}")


def prepared(
    prepare: Callable[[float], Callable[[], Result]], error_of: Callable[[Result], float], tolerance: float
) -> Run:
    """A way at a tolerance: the first result tells the error reached, the second how often to repeat it."""
    call = prepare(tolerance)
    error = error_of(call())
    begin = time.process_time()
    call()
    calls = max(1, math.ceil(LEAST_SECONDS / max(time.process_time() - begin, 1e-6)))
    return Run(tolerance, call, error if math.isfinite(error) else math.inf, calls, [])


def take_turns(runs: Iterable[Run]) -> None:
    """Measure each of them once."""
    for run in runs:
        begin = time.process_time()
        for _ in range(run.calls):
            run.call()
        run.seconds.append((time.process_time() - begin) / run.calls)


def ways() -> list[Way]:
    """All of them, the compiled one first."""
    system = load_system("planar_walker")
    walker = hybrid_machine(system, system.defaults() | {"alpha": 0.09})
    after = applied(walker, walker.transition("heel_strike"), 0.0, BEFORE)
    whole = {"mode": "three_link", "events": 2, "just_after": "heel_strike"}
    short = {"mode": "two_link", "events": 3, "at": "heel_strike"}
    exact = _exact(walker, after, **whole)
    fine, coarse = TOLERANCES, [t for t in TOLERANCES if t >= 1e-13]

    def mapped(x: np.ndarray, method: str, **which: object) -> Callable[[float], Callable[[], Result]]:
        step = StepMap(walker, weights=WEIGHTS, method=method, **which)
        return lambda tolerance: lambda: step(0.0, x, tolerance)

    return [
        Way("contwalk, 6 columns", mapped(after, "dop853", **whole), exact, fine),
        Way(
            "contwalk, 4 columns, from before the strike",
            mapped(BEFORE, "dop853", **short),
            _exact(walker, BEFORE, **short),
            fine,
        ),
        Way("contwalk verner98, arc by arc", mapped(after, "verner98", **whole), exact, fine),
        Way("scipy DOP853", lambda tolerance: _scipy(walker, after, tolerance), exact, coarse),
    ]


def _exact(walker: HybridMachine, x: np.ndarray, **which: object) -> Result:
    return StepMap(walker, weights=WEIGHTS, method="verner98", **which)(0.0, x, 1e-14)


def _scipy(walker: HybridMachine, x: np.ndarray, tolerance: float) -> Callable[[], Result]:
    """States and deviations by `solve_ivp`."""
    by_scipy = ByScipy(walker, COLUMNS, WEIGHTS, tolerance)

    def step() -> Result:
        t, state, columns = 0.0, x, np.eye(COLUMNS)
        for mode, name in (FIRST, SECOND):
            t, state, columns, _ = by_scipy.arc(t, state, columns, mode, [name])
        matrix, states = np.zeros((7, 7)), walker.mode("three_link").states
        matrix[np.ix_(states, states)] = columns
        return t, state, matrix

    return step


class ByScipy:
    """Arcs of a machine with deviations by `solve_ivp`, the machine code of field and guards being the same.

    Parameters
    ----------
    machine : HybridMachine
    columns : int
        How many deviations are carried along, which may be none.
    weights : ndarray, shape (n,)
        Typical magnitudes of the states, of full length.
    tolerance : float
        Relative; of the states in units of their weights absolute, too.
    controlled : bool
        Whether the errors of deviations count as those of states do; otherwise they do not count.
    longest : float
        Time after which an arc is given up.
    """

    def __init__(
        self,
        machine: HybridMachine,
        columns: int,
        weights: np.ndarray,
        tolerance: float,
        controlled: bool = True,
        longest: float = 5.0,
    ) -> None:
        self.machine, self.columns, self.weights = machine, columns, weights
        self.tolerance, self.longest = tolerance, longest
        self.of_deviations = tolerance if controlled else math.inf
        self._rates: dict[str, tuple[Callable[[float, np.ndarray], np.ndarray], int, int]] = {}

    def arc(
        self, t: float, x: np.ndarray, columns: np.ndarray, mode: str, names: Collection[str]
    ) -> tuple[float, np.ndarray, np.ndarray, str]:
        """Time, full-length state and deviations right after the first of the named events, and its name."""
        from scipy.integrate import solve_ivp

        flow, n = self.machine.mode(mode), len(self.machine.mode(mode).states)
        rates, first, width = self._rates_in(mode)
        awaited = [transition for transition in flow.transitions if transition.name in names]
        start, atol = np.zeros(first + n * width), np.full(first + n * width, self.of_deviations)
        start[:n], atol[:n] = x[flow.states], self.tolerance * self.weights[flow.states]
        if self.columns:
            start[first:].reshape(n, width)[:, : self.columns] = columns
        found = solve_ivp(
            rates,
            (t, t + self.longest),
            start,
            method="DOP853",
            events=[self._event(mode, transition.name, t) for transition in awaited],
            rtol=self.tolerance,
            atol=atol,
        )
        which = next(i for i, times in enumerate(found.t_events) if len(times))
        t, y, happening = float(found.t_events[which][0]), found.y_events[which][0], awaited[which]
        before = self.machine.full(mode, y[:n])
        if self.columns:
            through = saltation(self.machine, happening, t, before)[0]
            columns = through @ y[first:].reshape(n, width)[:, : self.columns]
        return t, applied(self.machine, happening, t, before), columns, happening.name

    def _event(self, mode: str, name: str, began: float) -> Callable[[float, np.ndarray], float]:
        flow = self.machine.mode(mode)
        guard, n = flow.guards[[each.name for each in flow.transitions].index(name)], len(flow.states)

        def event(t: float, y: np.ndarray) -> float:
            # Right after a transition the guard may be zero; it counts when it has been left.
            return 1.0 if t == began else guard(t, y[:n], flow.p)[0]

        event.terminal, event.direction = True, guard.direction
        return event

    def _rates_in(self, mode: str) -> tuple[Callable[[float, np.ndarray], np.ndarray], int, int]:
        """Rates of a mode's states and of deviations from them, by one call of machine code.

        And where the deviations begin in a vector, and how wide their rows are: both are padded.
        """
        if mode not in self._rates:
            flow, code = self.machine.mode(mode), stages.code("dop853")
            call = Call(flow.field, flow.c, "dop853", None, self.columns)
            if self.columns:
                call.tangents(np.zeros((len(flow.states), self.columns)), [-1] * self.columns)
            address, pointer = call.record.problem, ctypes.c_void_p
            name = "tangent" if self.columns else "plain"
            evaluate = code.function(name, None, pointer, ctypes.c_double, pointer, pointer)

            def rates(t: float, y: np.ndarray) -> np.ndarray:
                given, out = np.ascontiguousarray(y), np.zeros(call.length)
                evaluate(address, t, given.ctypes.data, out.ctypes.data)
                return out

            self._rates[mode] = rates, call.start, call.width
        return self._rates[mode]


if __name__ == "__main__":
    main()

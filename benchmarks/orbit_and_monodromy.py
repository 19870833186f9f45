"""Time of a periodic orbit with its monodromy matrix at the accuracy reached, for several integrators.

    python benchmarks/orbit_and_monodromy.py [--repeats 7] [--orbits lorenz] [--integrators contwalk heyoka]

Each integrator runs at many tolerances. For each the error that is *reached* is measured (state and matrix
against 34-digit arithmetic, orbits.py), and the CPU time at an error of 1e-6, 1e-9 and 1e-12 is interpolated
between them. All runs of an orbit take turns, so that a busy machine slows all of them; medians. Packages
that are not installed are left out: heyoka, numbalsoda and scipy are used if they are there. *Set-up* is the
most that a first result has cost at any tolerance, imports and compilation included as far as they were
needed then.
docs/benchmarks.md says what to make of it.
"""

from __future__ import annotations

import argparse
import math
import os
import platform
import statistics
import time
from dataclasses import dataclass

import numpy as np
from integrators import Integrator, Prepared, integrators
from orbits import Orbit, orbits

TARGETS = (1e-6, 1e-9, 1e-12)
LEAST_SECONDS = 0.004  # a shorter run is repeated within one measurement


@dataclass
class Run:
    """One integrator at one tolerance."""

    tolerance: float
    call: Prepared
    error: float
    calls: int
    seconds: list[float]

    @property
    def median(self) -> float:
        return statistics.median(self.seconds)


@dataclass
class Measured:
    """One integrator: its runs, and what had to be done before the first."""

    integrator: Integrator
    runs: list[Run]
    set_up: float


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--orbits", nargs="*", default=[""], help="parts of the names; all by default")
    parser.add_argument("--integrators", nargs="*", default=[""], help="parts of the names; all by default")
    given = parser.parse_args()
    every = [i for i in integrators() if any(part in i.name for part in given.integrators)]
    installed = [i for i in every if i.installed]
    print(f"python {platform.python_version()}, numpy {np.__version__}, {os.cpu_count()} cores, CPU seconds")
    print(", ".join(dict.fromkeys(f"{i.package} {i.installed}" for i in installed)))
    for name in dict.fromkeys(i.package for i in every if not i.installed):
        print(f"{name}: not installed")
    for orbit in orbits():
        if any(part.lower() in orbit.name.lower() for part in given.orbits):
            _report(orbit, _measure(orbit, installed, given.repeats))


def _measure(orbit: Orbit, chosen: list[Integrator], repeats: int) -> list[Measured]:
    measured = [_prepared(orbit, integrator) for integrator in chosen]
    for _ in range(repeats):
        for run in (run for one in measured for run in one.runs):
            begin = time.process_time()
            for _ in range(run.calls):
                run.call()
            run.seconds.append((time.process_time() - begin) / run.calls)
    return measured


def _prepared(orbit: Orbit, integrator: Integrator) -> Measured:
    """Everything that happens once, the first run included; errors are those of this run."""
    runs, set_up = [], 0.0
    for tolerance in integrator.tolerances:
        begin = time.process_time()
        call = integrator.prepare(orbit, tolerance)
        error = orbit.error(*call())
        set_up = max(set_up, time.process_time() - begin)
        begin = time.process_time()
        call()
        calls = max(1, math.ceil(LEAST_SECONDS / max(time.process_time() - begin, 1e-6)))
        runs.append(Run(tolerance, call, error if math.isfinite(error) else math.inf, calls, []))
    return Measured(integrator, runs, set_up)


def seconds_at(runs: list[Run], target: float) -> float | None:
    """CPU seconds at a reached error, or None if no tolerance reaches it.

    Interpolated, logarithm against logarithm, between the fastest run of at least this accuracy and the
    fastest that misses it by less than the factor of the next tolerances; without one of the latter the
    former stands.
    """
    fine = [run for run in runs if run.error <= target]
    if not fine:
        return None
    best = min(fine, key=lambda run: run.median)
    coarse = [run for run in runs if run.error > target and run.median < best.median]
    if not coarse:
        return best.median
    near = min(coarse, key=lambda run: run.error)
    if not math.isfinite(near.error):
        return best.median
    part = math.log(target / best.error) / math.log(near.error / best.error)
    return best.median * (near.median / best.median) ** part


def _report(orbit: Orbit, measured: list[Measured]) -> None:
    print(f"\n{orbit.name}: {orbit.about}")
    targets = "".join(f"{f'at {target:.0e}':>20}" for target in TARGETS)
    print(f"{'ms, and ratio to the first line':34}{targets}{'best reached':>15}{'set-up, s':>12}")
    base = [seconds_at(measured[0].runs, target) for target in TARGETS] if measured else []
    for one in measured:
        cells = ""
        for target, unit in zip(TARGETS, base, strict=True):
            seconds = seconds_at(one.runs, target)
            ratio = f"({seconds / unit:.2f})" if seconds and unit else ""
            cells += f"{f'{1e3 * seconds:.3f} {ratio:>9}' if seconds else '-':>20}"
        reached = min(run.error for run in one.runs)
        print(f"{one.integrator.name:34}{cells}{reached:>15.0e}{one.set_up:>12.2f}")


if __name__ == "__main__":
    main()

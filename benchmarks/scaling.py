"""Cost of a point over the number of states: equilibria and periodic orbits, each size in its own process.

    python benchmarks/scaling.py [--equilibria 2 8 32 100 200 500 1000] [--orbits 2 8 32 100 200] [--profile]

Equilibria: Bratu's equation u'' + lambda exp(u) = 0 on n inner points of a line, through its fold at
lambda = 3.51 (its matrix is tridiagonal; nothing here makes use of it). Orbits: a chain of n / 2 Brusselators
that diffuse into their neighbours, with slightly different constants, in B.

Prints CPU seconds before the first point (trace, derivatives, machine code that is in no cache, first
solution), CPU milliseconds a point after it, special points included, the peak of the process's memory above
that with the packages imported, and how the time of a point grows from one size to the next: the exponent of
n. `--profile` prints where the time of the points goes at each size instead.
"""

from __future__ import annotations

import argparse
import cProfile
import math
import os
import pstats
import resource
import subprocess
import sys
import tempfile
import time
from itertools import pairwise

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the command line does

import numpy as np

import contwalk as cw
from contwalk.system import Mode, Parameter, State, System

EQUILIBRIA, ORBITS = (2, 8, 32, 100, 200, 500, 1000), (2, 8, 32, 100, 200)
# Points after the first; of equilibria enough to pass the fold, but for the largest.
POINTS, LARGEST = {"equilibria": 40, "orbits": 6}, {"equilibria": 500, "orbits": 1000}
FEW = 8
DIFFUSION, SPREAD = 1.0, 0.02
PERIOD = 6.577284341905899  # of one Brusselator with A = 1, B = 2.5


def bratu(n: int) -> System:
    """Bratu's equation, u = 0 at both ends, by differences."""
    size = float((n + 1) ** 2)

    def field(t, x, p, dx):  # type: ignore[no-untyped-def]
        for i in range(n):
            before = x[i - 1] if i > 0 else 0.0
            after = x[i + 1] if i < n - 1 else 0.0
            dx[i] = size * (before - 2.0 * x[i] + after) + p.lam * np.exp(x[i])

    states = tuple(State(f"u{i}") for i in range(n))
    return System("bratu", states=states, parameters=(Parameter("lam", 0.5),), modes=(Mode("only", field),))


def brusselators(n: int) -> System:
    """A chain of n / 2 Brusselators."""
    cells = n // 2

    def field(t, x, p, dx):  # type: ignore[no-untyped-def]
        for i in range(cells):
            u, v = x[2 * i], x[2 * i + 1]
            own = p.B + SPREAD * math.cos(3.0 * i)
            dx[2 * i] = 1.0 - (own + 1.0) * u + u * u * v
            dx[2 * i + 1] = own * u - u * u * v
            for j in (i - 1, i + 1):
                if 0 <= j < cells:
                    dx[2 * i] += DIFFUSION * (x[2 * j] - u)
                    dx[2 * i + 1] += DIFFUSION * (x[2 * j + 1] - v)

    states = tuple(State(f"{name}{i}") for i in range(cells) for name in "uv")
    return System("chain", states=states, parameters=(Parameter("B", 2.5),), modes=(Mode("only", field),))


def points_of(kind: str, n: int) -> int:
    """How many points are measured."""
    return POINTS[kind] if n < LARGEST[kind] else FEW


def walk(kind: str, n: int, profile: bool) -> tuple[float, float, int]:
    """CPU seconds up to the first point, and of a point after it; how many there were."""
    begin, most = time.process_time(), points_of(kind, n)
    if kind == "equilibria":
        system = bratu(n)
        problem = cw.Equilibrium(system, system.defaults(), "lam")
        points = cw.points(problem, np.zeros(n), (0.0, 4.0), max_points=most + 1)
    else:
        system = brusselators(n)
        orbit = cw.PeriodicOrbit(system, system.defaults(), "B")
        # On the orbit of one Brusselator, where u passes 1 downwards, nearly.
        start = np.tile([1.0, 3.15], n // 2)
        points = cw.points(orbit, start, (2.4, 2.8), period=PERIOD, until="settled", max_points=most + 1)
    next(points)
    first = time.process_time()
    recorder = cProfile.Profile()
    if profile:
        recorder.enable()
    count = sum(point.special is None for point in points)
    recorder.disable()
    if profile:
        pstats.Stats(recorder).sort_stats("tottime").print_stats(12)
    return first - begin, (time.process_time() - first) / max(count, 1), count


def memory() -> float:
    """Peak memory of this process, MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def main() -> None:
    """Measure each size in a process of its own, and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--equilibria", type=int, nargs="*", default=EQUILIBRIA)
    parser.add_argument("--orbits", type=int, nargs="*", default=ORBITS)
    parser.add_argument("--profile", action="store_true")
    parser.add_argument("--one", nargs=2, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.one:
        _one(given.one[0], int(given.one[1]), given.profile)
        return
    for kind in ("equilibria", "orbits"):
        print(
            f"\n{kind}\n{'states':>8}{'first, s':>12}{'point, ms':>12}{'MB':>8}{'exponent':>10}", flush=True
        )
        rows: list[tuple[int, float]] = []
        for n in getattr(given, kind):
            first, point, size, count = _measured(kind, n, given.profile)
            rows.append((n, point))
            grown = ""
            for (a, before), (b, after) in pairwise(rows[-2:]):
                grown = f"{math.log(after / before) / math.log(b / a):.1f}"
            short = "" if count == points_of(kind, n) else f"  ({count} points)"
            print(f"{n:8}{first:12.2f}{1e3 * point:12.2f}{size:8.0f}{grown:>10}{short}", flush=True)


def _measured(kind: str, n: int, profile: bool) -> tuple[float, float, float, int]:
    command = [sys.executable, __file__, "--one", kind, str(n), *(["--profile"] if profile else [])]
    with tempfile.TemporaryDirectory() as folder:
        # What integrators share is compiled beforehand; what belongs to the system is not.
        environment = {**os.environ, "CONTWALK_CACHE_DIR": os.environ.get("CONTWALK_CACHE_DIR", folder)}
        done = subprocess.run(command, check=True, capture_output=True, text=True, env=environment)
    *told, last = done.stdout.splitlines()
    if profile:
        print("\n".join(told))
    first, point, size, count = last.split()
    return float(first), float(point), float(size), int(count)


def _one(kind: str, n: int, profile: bool) -> None:
    walk(kind, 2, False)  # imports, and what is compiled once for all systems
    before = memory()
    first, point, count = walk(kind, n, profile)
    print(first, point, memory() - before, count)


if __name__ == "__main__":
    main()

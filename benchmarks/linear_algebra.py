"""Cost of the linear algebra of one continuation step, over the number of unknowns.

    python benchmarks/linear_algebra.py

Orbits of legs with as many states as the planar walker (4) and as a walker in space (28), with random
derivatives. A step is taken as 4 Newton corrections and a tangent, and twice, at its end and on the steps
made for the next, an orientation, an error bound and null vectors (in three rounds; at a multiplier one is
enough). CPU milliseconds: condensed leg by leg as soon as that pays, by dense LU, and of a single SVD of the
same size. Medians, in turns.
"""

from __future__ import annotations

import os
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

for library in ("OPENBLAS", "MKL", "OMP"):  # as the command line does
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

import numpy as np  # noqa: E402

from contwalk.numerics.linear import Factored  # noqa: E402
from contwalk.problems.orbit.condensed import factored  # noqa: E402
from contwalk.problems.orbit.layout import Layout  # noqa: E402
from contwalk.problems.orbit.null_vectors import critical_vectors  # noqa: E402

ROOT = Path(__file__).resolve().parent.parent
REPEATS = 7
CASES = [(4, 2), (4, 4), (4, 8), (4, 16), (4, 32), (4, 64), (28, 2), (28, 5), (28, 10), (28, 20)]


class _Orbit:
    """What null vectors ask of an orbit."""

    def __init__(self, factor: Callable[[np.ndarray, np.ndarray], Any]) -> None:
        self.factored = factor


def step(matrix: np.ndarray, cycle: np.ndarray, factor: Callable[[np.ndarray, np.ndarray], Any]) -> None:
    """The linear algebra of one step."""
    weights, right = np.ones(len(matrix)), np.ones(len(matrix))
    for _ in range(4):
        last = factor(matrix, weights)
        last.solve(right)
    last.solve(right)
    for _ in range(2):
        there = factor(matrix, weights)
        there.orientation()
        there.error(right[:-1], weights)
        critical_vectors(_Orbit(factor), cycle)


def main() -> None:
    """Measure and print."""
    sys.path.insert(0, str(ROOT / "tests" / "problems" / "hybrid"))
    from chains import random_matrix

    print(f"{'states':>8}{'legs':>6}{'unknowns':>10}{'condensed':>12}{'dense LU':>12}{'one SVD':>12}")
    for states, legs in CASES:
        layout, rng = Layout((states,) * legs, False, 0), np.random.default_rng(1)
        matrix = random_matrix(layout, 1, rng)
        cycle = matrix[: layout.size, : layout.size].copy()

        def condensed(m: np.ndarray, w: np.ndarray, layout: Layout = layout) -> Any:
            return factored(layout, m, w)

        works = [
            lambda m=matrix, c=cycle, f=condensed: step(m, c, f),
            lambda m=matrix, c=cycle: step(m, c, Factored),
            lambda c=cycle: np.linalg.svd(c),
        ]
        spent: list[list[float]] = [[], [], []]
        for _ in range(REPEATS):
            for work, times in zip(works, spent, strict=True):
                begin = time.process_time()
                work()
                times.append(1e3 * (time.process_time() - begin))
        found = "".join(f"{statistics.median(times[1:]):>12.2f}" for times in spent)
        print(f"{states:>8}{legs:>6}{len(matrix):>10}{found}")


if __name__ == "__main__":
    main()

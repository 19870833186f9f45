"""What a right-hand side in mass-matrix form costs, against the same equations solved by hand.

    python benchmarks/mass_matrix.py

The double pendulum of tests/peers/machines: `M(q) q'' = f` by `numpy.linalg.solve`, and by Cramer's rule.
Both are integrated over the same steps; CPU microseconds for each evaluation, medians, in turns.
"""

from __future__ import annotations

import os
import statistics
import sys
import time
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the command line does

import numpy as np

from contwalk import flow
from contwalk.flow.compiled.traced import field_of

ROOT = Path(__file__).resolve().parent.parent
STEPS, STAGES, REPEATS = 20_000, 12, 21


def main() -> None:
    """Measure and print."""
    sys.path.insert(0, str(ROOT / "tests"))
    from peers.machines.double_pendulum import BY_HAND, SYSTEM

    times, x = np.linspace(0.0, 20.0, STEPS + 1), np.array([0.3, -0.2, 0.5, 1.0])
    fields = {"mass matrix": field_of(SYSTEM), "by hand": field_of(BY_HAND)}
    spent: dict[str, list[float]] = {name: [] for name in fields}
    for _ in range(REPEATS):
        for name, field in fields.items():
            c = field.constants(list(SYSTEM.defaults().values()))
            begin = time.process_time()
            flow.along(field, c, times, x, "dop853")
            spent[name].append(1e6 * (time.process_time() - begin) / (STEPS * STAGES))
    medians = {name: statistics.median(found[1:]) for name, found in spent.items()}
    for name, median in medians.items():
        print(f"{name:12} {median:8.4f} us")
    print(f"ratio        {medians['mass matrix'] / medians['by hand']:8.2f}")


if __name__ == "__main__":
    main()

"""Cost of continuing equilibria: whole process and inside the engine, on two studies of the autobalancer.

    make bench
    python benchmarks/equilibria.py [--repeats 5]

Prints, for the omega run and the load run: CPU seconds of the whole process without figures, on the first
start after installation (no bytecode cached) and warm; CPU seconds per point inside the engine; the accuracy
reached (largest relative error of the special points against 40-digit values); and a branch with scipy's
general tools (fsolve at fixed parameter steps and numpy eigenvalues, no derivatives, no location) as a
yardstick, as a ratio per point. Medians of the repetitions. docs/benchmarks.md says what to make of it.
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
STUDIES = {"omega": "autobalancer_omega.yaml", "load": "autobalancer_load.yaml"}
# Verified in 40-digit arithmetic.
TRUTH = {
    "omega": [0.5591662709753222, 1.7362881790318407, 1.0272112844508665],
    "load": [0.02, 0.00282047183506846],
}


def main() -> None:
    """Run and print everything."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--repeats", type=int, default=5)
    repeats = parser.parse_args().repeats
    print(f"python {sys.version.split()[0]}, numpy {np.__version__}, {os.cpu_count()} cores\n")
    help_seconds = statistics.median(_cpu(["--help"], {}) for _ in range(repeats))
    print(f"contwalk --help: {help_seconds:.2f} s CPU\n")
    for name, file in STUDIES.items():
        _study(name, ROOT / "runs" / file, repeats)


def _study(name: str, run_file: Path, repeats: int) -> None:
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "out.h5"
        command = ["continue", str(run_file), "--quiet", "--no-figures", "--force", "--output", str(output)]
        cold = _cpu(command, {"PYTHONPYCACHEPREFIX": str(Path(folder) / "cache")})
        warm = [_cpu(command, {}) for _ in range(repeats)]
        seconds, points, error = _inside(run_file, output, TRUTH[name], repeats)
    yardstick = statistics.median(_yardstick(run_file) for _ in range(repeats))
    print(f"{name} run ({points} points)")
    print(f"  whole process, cold: {cold:.2f} s CPU")
    print(f"  whole process, warm: {statistics.median(warm):.2f} s CPU (lowest {min(warm):.2f})")
    print(f"  inside the engine:   {1e3 * seconds / points:.2f} ms a point, all tests and locations included")
    print(f"  accuracy reached:    {error:.1e} relative, worst special point")
    print(f"  fsolve and eigvals:  {1e3 * yardstick:.2f} ms a point, at fixed steps")
    print(f"  ratio of the two:    {seconds / points / yardstick:.1f}\n")


def _cpu(arguments: list[str], environment: dict[str, str]) -> float:
    """User and system seconds of one `contwalk` process."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(
        [sys.executable, "-m", "contwalk", *arguments],
        check=True,
        stdout=subprocess.DEVNULL,
        env={**os.environ, **environment},
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def _inside(run_file: Path, output: Path, truth: list[float], repeats: int) -> tuple[float, int, float]:
    """CPU seconds and points of the run in this process, once it is warm, and the worst relative error."""
    from contwalk.workflow.run_file.reading import read_run_file
    from contwalk.workflow.runner import run

    study = read_run_file(run_file, output=str(output))
    result = run(study, force=True, figures=False)
    times = []
    for _ in range(repeats):
        start = time.process_time()
        result = run(study, force=True, figures=False)
        times.append(time.process_time() - start)
    seconds = statistics.median(times)
    found = [
        point.parameters[branch.info.free[0]]
        for branch in result.branches
        for point in branch.special_points
        if point.label in ("LP", "BP", "HB")
    ]
    error = max(min(abs(value - true) / abs(true) for value in found) for true in truth)
    return seconds, sum(len(branch) for branch in result.branches), error


def _yardstick(run_file: Path, steps: int = 200) -> float:
    """CPU seconds a point of scipy's fsolve and a differenced Jacobian's eigenvalues, at fixed steps."""
    from types import SimpleNamespace

    from scipy.optimize import approx_fprime, fsolve

    from contwalk.workflow.run_file.reading import read_run_file

    study = read_run_file(run_file)
    system, field = study.system, study.system.modes[0].field
    x = system.named_states("opposite", study.parameters)[0]

    def residual(x: np.ndarray, p: SimpleNamespace) -> np.ndarray:
        dx = np.empty_like(x)
        field(0.0, x, p, dx)
        return dx

    start = time.process_time()
    for value in np.linspace(study.parameters[study.free], study.range[1], steps):
        p = SimpleNamespace(**{**study.parameters, study.free: value})
        x = fsolve(residual, x, args=(p,), xtol=1e-12)
        np.linalg.eigvals(approx_fprime(x, residual, 1e-8, p))
    return (time.process_time() - start) / steps


if __name__ == "__main__":
    main()

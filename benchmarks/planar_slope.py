"""Cost of the slope study of the planar walker: the gait, its fold, three period doublings, its ends.

    python benchmarks/planar_slope.py [--repeats 5]

Runs `contwalk continue runs/planar_slope.yaml` and prints CPU seconds (user and system) of the whole
process without figures and inside the engine, once as the run file has it (slopes up to 0.3, on all
branches) and once up to 0.12, with the points of each branch and how far the special points are from values
verified in independent arithmetic. Medians. docs/benchmarks.md says what to make of it.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from cpu_time import seconds_of

ROOT = Path(__file__).resolve().parent.parent
RUN_FILE = ROOT / "runs" / "planar_slope.yaml"
REFERENCE = json.loads(
    (ROOT / "tests" / "thesis" / "planar_walker_reference.json").read_text(encoding="utf-8")
)
RANGES = {"up to 0.3": "[0.03, 0.3]", "up to 0.12": "[0.03, 0.12]"}


def truth(most: float) -> dict[str, float]:
    """The verified special points up to a slope."""
    slope = REFERENCE["slope"]
    points = {"fold": float(slope["fold"]["alpha"]), **slope["period_doublings"]}
    points |= {event["label"]: event["alpha"] for event in slope["events"]}
    points["grazing heel strike"] = slope["grazing_heel_strike_end"]["alpha"]
    return {name: float(alpha) for name, alpha in points.items() if float(alpha) < most}


def main() -> None:
    """Run everything in turns and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--repeats", type=int, default=5)
    repeats = parser.parse_args().repeats
    print(f"python {sys.version.split()[0]}, numpy {np.__version__}, {os.cpu_count()} cores, CPU seconds\n")
    with tempfile.TemporaryDirectory() as folder:
        for name, span in RANGES.items():
            whole, inside, result = list[float](), list[float](), None
            _whole(Path(folder), span)  # the first run compiles, or loads what was compiled
            for _ in range(repeats):
                whole.append(_whole(Path(folder), span))
                result, spent = _inside(Path(folder), span)
                inside.append(spent)
            assert result is not None
            medians = statistics.median(whole), statistics.median(inside)
            print("{}: whole process {:.2f}, inside the engine {:.2f}".format(name, *medians))
            print("  points: " + ", ".join(f"{branch.name} {len(branch)}" for branch in result.branches))
            points = [point for branch in result.branches for point in branch.special_points]
            found = [point.parameters["alpha"] for point in points]
            for label, alpha in truth(float(span.strip("[]").split(",")[1])).items():
                print(f"  {label:34}{min(abs(a - alpha) for a in found):>9.0e}")


def _whole(folder: Path, span: str) -> float:
    output = str(folder / "out.h5")
    options = ["--quiet", "--no-figures", "--force", "--output", output, "--set", f"continue.range={span}"]
    return seconds_of([sys.executable, "-m", "contwalk", "continue", str(RUN_FILE), *options])


def _inside(folder: Path, span: str) -> tuple[Any, float]:
    """The result and CPU seconds of the run in this process."""
    from contwalk.workflow.run_file.reading import read_run_file
    from contwalk.workflow.runner import run

    study = read_run_file(RUN_FILE, [f"continue.range={span}"], output=str(folder / "out.h5"))
    begin = time.process_time()
    result = run(study, force=True, figures=False)
    return result, time.process_time() - begin


if __name__ == "__main__":
    for library in ("OPENBLAS", "MKL", "OMP"):  # as the command line does
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    main()

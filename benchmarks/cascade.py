"""Cost of a cascade of period doublings: from an equilibrium over a Hopf point to the cycle of period 8 T.

    python benchmarks/cascade.py [--repeats 5]
    CONTWALK_AUTO=/path/to/auto-07p python benchmarks/cascade.py

Runs `contwalk continue runs/autobalancer_cascade.yaml` and prints CPU seconds (user and system) of the whole
process without figures and inside the engine, and how far the four period doublings are from values verified
in independent arithmetic. Where AUTO-07p is at hand, its own cascade runs in turn with it (auto_cascade.py
says how to get and build it). Medians. docs/benchmarks.md says what to make of it.
"""

from __future__ import annotations

import argparse
import os
import statistics
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from auto_cascade import SETTINGS, Auto
from cpu_time import seconds_of

ROOT = Path(__file__).resolve().parent.parent
RUN_FILE = ROOT / "runs" / "autobalancer_cascade.yaml"
# delta at which the cycles of period T, 2 T, 4 T, 8 T double; right to the digits given.
TRUTH = [0.00326757880587, 0.00305875641347, 0.00302990131111, 0.00302521443315]
START = 0.01  # delta of the balanced equilibrium from which AUTO starts


def main() -> None:
    """Run everything in turns and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--repeats", type=int, default=5)
    repeats = parser.parse_args().repeats
    print(f"python {sys.version.split()[0]}, numpy {np.__version__}, {os.cpu_count()} cores, CPU seconds\n")
    home = os.environ.get("CONTWALK_AUTO")
    with tempfile.TemporaryDirectory() as folder:
        auto = Auto(Path(home), Path(folder), START) if home else None
        seconds: dict[str, list[float]] = {}
        found: dict[str, list[float]] = {}
        _inside(Path(folder))  # the first run of a process compiles, or loads what was compiled
        for _ in range(repeats):
            seconds.setdefault("contwalk, whole process", []).append(_whole(Path(folder)))
            doublings, spent = _inside(Path(folder))
            seconds.setdefault("contwalk, inside the engine", []).append(spent)
            found["contwalk, whole process"] = found["contwalk, inside the engine"] = doublings
            for setting in SETTINGS if auto else []:
                found[setting.name], spent = auto.cascade(setting)  # type: ignore[union-attr]
                seconds.setdefault(setting.name, []).append(spent)
    _report(seconds, found)
    if auto is None:
        print("\nAUTO: not measured; auto_cascade.py says how to get it, then set CONTWALK_AUTO")


def _arguments(folder: Path) -> list[str]:
    output = str(folder / "out.h5")
    return ["continue", str(RUN_FILE), "--quiet", "--no-figures", "--force", "--output", output]


def _whole(folder: Path) -> float:
    return seconds_of([sys.executable, "-m", "contwalk", *_arguments(folder)])


def _inside(folder: Path) -> tuple[list[float], float]:
    """The four period doublings and CPU seconds of the run in this process."""
    from contwalk.workflow.run_file.reading import read_run_file
    from contwalk.workflow.runner import run

    study = read_run_file(RUN_FILE, output=str(folder / "out.h5"))
    begin = time.process_time()
    result = run(study, force=True, figures=False)
    spent = time.process_time() - begin
    points = [
        point.parameters["delta"]
        for branch in result.branches
        for point in branch.special_points
        if point.label == "PD"
    ]
    if len(points) < len(TRUTH):
        raise SystemExit(f"only {len(points)} of {len(TRUTH)} period doublings were found")
    return [min(points, key=lambda value: abs(value - true)) for true in TRUTH], spent


def _report(seconds: dict[str, list[float]], found: dict[str, list[float]]) -> None:
    base = statistics.median(seconds["contwalk, whole process"])
    inside = statistics.median(seconds["contwalk, inside the engine"])
    errors = "".join(f"{name:>10}" for name in ("PD", "PD 2T", "PD 4T", "PD 8T"))
    print(f"{'':30}{'CPU s':>8}{'to whole':>10}{'to engine':>11}   errors of delta: {errors.lstrip()}")
    for name, values in seconds.items():
        median = statistics.median(values)
        reached = "".join(f"{abs(x - true):>10.0e}" for x, true in zip(found[name], TRUTH, strict=True))
        print(f"{name:30}{median:>8.3f}{median / base:>10.2f}{median / inside:>11.2f}   {'':16}{reached}")


if __name__ == "__main__":
    main()

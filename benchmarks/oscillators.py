"""Cost of families of cycles from one Hopf point to the other: FitzHugh-Nagumo, Hodgkin-Huxley, Morris-Lecar.

    CONTWALK_AUTO=/path/to/auto-07p python benchmarks/oscillators.py [--repeats 5]

Runs the studies of `tests/peers/problems/` inside the engine, in turn with AUTO-07p (`auto_program.py` says
how to build it) from the same equilibrium to the second Hopf point and from the first one along the cycles
until they are back at an equilibrium, and prints CPU seconds, medians, with what each has found.
docs/benchmarks.md says what to make of it.
"""

from __future__ import annotations

import argparse
import os
import shutil
import statistics
import sys
import tempfile
import time
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import numpy as np
from auto_program import Row, built, equation_file, run

import contwalk as cw
from contwalk.branch import Branch

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))
FOLD, DOUBLING = "5", "7"  # types in AUTO's output


@dataclass(frozen=True)
class Setting:
    """Constants of AUTO: intervals, first and largest steps of equilibria and of cycles, steps of cycles."""

    problem: str
    intervals: int  # NTST
    equilibria: tuple[float, float]  # DS, DSMAX
    cycles: tuple[float, float]
    steps: int  # NMX
    last: float  # RL1


SETTINGS = (
    Setting("fitzhugh_nagumo", 40, (0.01, 0.1), (0.002, 0.05), 200, 2.0),
    # Ten times shorter steps, which find the other fold.
    Setting("fitzhugh_nagumo", 60, (0.01, 0.1), (0.0002, 0.005), 1700, 2.0),
    Setting("hodgkin_huxley", 60, (0.5, 5.0), (0.1, 5.0), 80, 200.0),
    Setting("morris_lecar", 60, (0.5, 5.0), (0.1, 5.0), 84, 300.0),
)


def main() -> None:
    """Run all by turns and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--repeats", type=int, default=5)
    repeats, home = parser.parse_args().repeats, os.environ.get("CONTWALK_AUTO")
    if not home:
        raise SystemExit("auto_program.py says how to get AUTO; then set CONTWALK_AUTO")
    for setting in SETTINGS:
        with tempfile.TemporaryDirectory() as folder:
            _compare(setting, Path(home), Path(folder), repeats)


def _compare(setting: Setting, home: Path, folder: Path, repeats: int) -> None:
    states = _built(setting.problem, home, folder)
    engine, auto = list[float](), list[float]()
    _inside(setting.problem, folder)  # the first run of a process compiles, or loads what was compiled
    for _ in range(repeats):
        seconds, rows = _auto(setting, states, folder)
        auto.append(seconds)
        seconds, branches = _inside(setting.problem, folder)
        engine.append(seconds)
    ratio = statistics.median(a / b for a, b in zip(engine, auto, strict=True))
    medians = f"engine {statistics.median(engine):.2f}, AUTO {statistics.median(auto):.3f}"
    print(f"{setting.problem}: {medians}, {ratio:.1f} times")
    print("  AUTO:", ", ".join(f"{row.value:.10g}" for row in rows if row.label in (FOLD, DOUBLING)))
    found = [point for branch in branches for point in branch.special_points if point.label in ("LP", "PD")]
    print("  engine:", ", ".join(f"{point.label} {point.parameters['I']:.10g}" for point in found))


def _built(problem: str, home: Path, folder: Path) -> int:
    """AUTO's program of a problem, from its equilibrium; how many states it has."""
    module = import_module(f"peers.problems.{problem}")
    system, given = module.SYSTEM, module.PEER.studies[0].run
    state = np.array([given["start"]["state"][name] for name in system.state_names])
    branch = cw.continue_branch(cw.Equilibrium(system, system.defaults(), "I"), state, (0.0, 1e-3))
    built(home, folder, equation_file(system, system.defaults(), ["I"], branch.points[0]["state"]))
    return len(system.states)


def _inside(problem: str, folder: Path) -> tuple[float, list[Branch]]:
    """CPU seconds of the study in this process, and its branches."""
    from peers.running import peers, write_run_file

    path = folder / "study.yaml"
    write_run_file(problem, peers()[problem].studies[0], path)
    study = cw.read_run_file(path, output=folder / "study.h5")
    begin = time.process_time()
    result = cw.run(study, force=True, figures=False)
    return time.process_time() - begin, result.branches


def _auto(setting: Setting, states: int, folder: Path) -> tuple[float, list[Row]]:
    """CPU seconds of both starts, and the points of the second."""
    first, _ = run(folder, _constants(setting, states, False))
    solution = folder / "equilibria"
    shutil.move(folder / "fort.8", solution)
    second, rows = run(folder, _constants(setting, states, True), solution)
    return first + second, rows


def _constants(setting: Setting, states: int, cycles: bool) -> str:
    """AUTO's constants file: equilibria up to the second Hopf point, or cycles from the first one."""
    step, largest = setting.cycles if cycles else setting.equilibria
    return f"""NDIM= {states}, IPS= {2 if cycles else 1}, IRS= {"'HB1'" if cycles else 0}, ILP= 1
ICP= {[1, 11] if cycles else [1]}, ISP= 2, ISW= 1
NTST= {setting.intervals}, NCOL= 6, IAD= 3
IPLT= 0, NBC= 0, NINT= 0, NMX= {setting.steps if cycles else 2000}, NPR= 0, MXBF= 0, IID= 0, JAC= 1
ITMX= 12, ITNW= 8, NWTN= 3
EPSL= 1e-10, EPSU= 1e-10, EPSS= 1e-9
DS= {step}, DSMIN= 1e-7, DSMAX= {largest}, IADS= 1
NPAR= 11, THL= {{11: 0.0}}, THU= {{}}
RL0= -0.1, RL1= {setting.last}, SP= {[] if cycles else ["HB2"]}
"""


if __name__ == "__main__":
    for library in ("OPENBLAS", "MKL", "OMP"):  # as the command line does
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    main()

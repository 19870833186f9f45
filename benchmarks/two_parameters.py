"""Cost of curves in two parameters: those of AUTO-07p's demos ab, pp2, plp and abcb.

    CONTWALK_AUTO=/path/to/auto-07p python benchmarks/two_parameters.py [--repeats 3]

Follows curves of folds, Hopf points, folds of cycles and cycles of one period inside the engine, by turns
with AUTO-07p (`auto_program.py` says how to build it), in the same ranges. Both begin at special points that
they have found along one parameter; that is not timed. Prints CPU seconds, medians, and the special points
and marks that either has found. docs/benchmarks.md says what to make of it.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import statistics
import sys
import tempfile
import time
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from auto_program import Row, built, equation_file, run

import contwalk as cw
from contwalk.branch import Branch
from contwalk.system import System

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))
# AUTO's types of points, by its numbers; regular points and ends are not told.
TYPES = {"-21": "BT", "22": "CP", "-22": "CP", "-32": "GH", "55": "LP", "-59": "MX"} | dict.fromkeys(
    ("-4", "-24", "-34", "-54"), "UZ"
)


@dataclass(frozen=True)
class Demo:
    """A demo of AUTO: the study along one parameter, and constants of AUTO by which it finds the same points.

    `free` are both parameters, as AUTO numbers them: PAR(1), PAR(2). `cycles` is None where there are none.
    """

    name: str
    problem: str  # of `tests/peers/problems/`
    free: tuple[str, str]
    study: dict[str, Any]
    equilibria: dict[str, Any]
    cycles: dict[str, Any] | None = None


@dataclass(frozen=True)
class Curve:
    """A curve of a demo: the point at which it begins, by the name that it has in the engine and in AUTO, the
    ranges of both parameters and values to mark, and constants of AUTO.

    AUTO tells turns in the parameter that is named first.
    """

    demo: Demo
    title: str
    point: str
    auto: str
    ranges: dict[str, tuple[float, float]]
    marks: dict[str, list[float | str]]
    constants: dict[str, Any]
    of_cycles: bool = False

    @property
    def folds_of_cycles(self) -> bool:
        """Whether AUTO needs a start of its own that makes the first solution."""
        return self.of_cycles and self.auto.startswith("LP")

    @property
    def numbers(self) -> dict[str, int]:
        """The free parameters as AUTO numbers them."""
        return {name: 1 + self.demo.free.index(name) for name in self.ranges}


AB = Demo(
    *("ab", "ab"),
    ("p1", "p3"),
    {
        "parameters": {"p2": 14.0, "p3": 2.0},
        "start": {"state": {"u1": 0.0, "u2": 0.0}},
        "continue": {"parameter": "p1", "range": [0.0, 0.15]},
        "diagram": "none",
    },
    {"RL0": 0.0, "RL1": 0.15, "DS": 0.01, "DSMAX": 0.05},
)
PP2 = Demo(
    *("pp2", "pp2"),
    ("quota", "p2"),
    {
        "start": {"state": {"fish": 0.0, "sharks": 0.0}},
        "continue": {"parameter": "quota", "range": [0.0, 1.0]},
        "mark": {"period": [36.0]},
    },
    {"RL0": 0.0, "RL1": 1.0, "DS": 0.02, "DSMAX": 0.06, "MXBF": 10, "A1": 5.0},
    {"NTST": 90, "DS": 0.02, "DSMAX": 0.06, "UZSTOP": {11: 36.0}},
)
PLP = Demo(
    *("plp", "plp"),
    ("rho", "s0"),
    {
        "start": {"state": {"s": 45.55974, "a": 177.7987}},
        "continue": {"parameter": "rho", "range": [2.0, 6.0]},
    },
    {"RL0": 2.0, "RL1": 6.0, "DS": 0.1, "DSMAX": 3.0},
    {"NTST": 60, "DS": 0.1, "DSMAX": 3.0, "STOP": ["LP1"]},
)
ABCB = Demo(
    *("abcb", "abc"),
    ("d", "alpha"),
    {
        "start": {"state": {"u1": 0.0, "u2": 0.0, "u3": 0.0}},
        "continue": {"parameter": "d", "range": [0.0, 1.0]},
        "diagram": {"follow": ["HB"], "depth": 1},
    },
    {"RL0": 0.0, "RL1": 1.0, "DS": 0.01, "DSMAX": 0.1},
    {"NTST": 60, "DS": 0.01, "DSMAX": 0.1, "STOP": ["LP1"]},
)
BOX_AB = {"p1": (1e-3, 0.25), "p3": (-0.5, 3.0)}
BOX_PP2 = {"quota": (0.0, 1.0), "p2": (1.0, 4.0)}
BOX_PLP = {"rho": (0.1, 20.0), "s0": (109.0, 150.0)}
BOX_ABCB = {"alpha": (0.9, 1.4), "d": (0.1, 1.0)}
SHORT = {"DS": 0.01, "DSMAX": 0.1}
CURVES = (
    Curve(AB, "folds", "b1/LP1", "LP1", BOX_AB, {"p3": [1.0]}, SHORT),
    Curve(AB, "Hopf points", "b1/HB1", "HB1", BOX_AB, {"p3": [1.0]}, SHORT),
    # Another tolerance for points finds the generalized Hopf point; of the folds it loses the cusp.
    Curve(AB, "Hopf points", "b1/HB1", "HB1", BOX_AB, {"p3": [1.0]}, SHORT | {"EPSS": 1e-11}),
    Curve(PP2, "folds", "b2/LP1", "LP1", BOX_PP2, {"p2": [2.0]}, SHORT),
    Curve(PP2, "Hopf points", "b3/HB1", "HB1", BOX_PP2, {"p2": [2.5]}, SHORT),
    Curve(
        *(PP2, "cycles of period 36", "b4/UZ1", "UZ1", BOX_PP2, {"p2": [3.5]}),
        {"ISW": 1, "NTST": 90, "DS": 0.02, "DSMAX": 0.06},
        of_cycles=True,
    ),
    Curve(PLP, "Hopf points", "b1/HB1", "HB1", BOX_PLP, {}, {"DS": 0.1, "DSMAX": 3.0}),
    # With longer steps AUTO passes over the end of the range where points are located to 1e-11, and with 1e-9
    # they are off by 6e-8.
    Curve(
        *(PLP, "folds of cycles", "b2/LP1", "LP1", BOX_PLP, {"s0": [111.0]}),
        {"NTST": 40, "EPSS": 1e-11, "DS": 0.1, "DSMAX": 0.75},
        of_cycles=True,
    ),
    Curve(
        *(ABCB, "folds of cycles", "b2/LP1", "LP1", BOX_ABCB, {"alpha": [1.05, "extremum"]}),
        {"NTST": 60, "DS": 0.01, "DSMAX": 0.1},
        of_cycles=True,
    ),
)


def main() -> None:
    """Run all by turns and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--repeats", type=int, default=3)
    repeats, home = parser.parse_args().repeats, os.environ.get("CONTWALK_AUTO")
    if not home:
        raise SystemExit("auto_program.py says how to get AUTO; then set CONTWALK_AUTO")
    for demo in (AB, PP2, PLP, ABCB):
        with tempfile.TemporaryDirectory() as folder:
            _prepared(demo, Path(home), Path(folder))
            for curve in CURVES:
                if curve.demo is demo:
                    _compare(curve, Path(folder), repeats)


def _system(demo: Demo) -> System:
    found: System = import_module(f"peers.problems.{demo.problem}").SYSTEM
    return found


def _prepared(demo: Demo, home: Path, folder: Path) -> None:
    """Find the special points that curves begin at, in either program."""
    system, path = _system(demo), folder / "study.yaml"
    values = {**system.defaults(), **demo.study.get("parameters", {})}
    _write(path, demo.study, demo)
    first = cw.run(cw.read_run_file(path, output=folder / "study.h5"), figures=False).branches[0]
    built(home, folder, equation_file(system, values, demo.free, first.points[0]["state"]))
    run(folder, _constants(demo, {"IPS": 1, "IRS": 0, "ICP": [1], **demo.equilibria}))
    shutil.move(folder / "fort.8", folder / "equilibria")
    if demo.cycles:
        given = {"IPS": 2, "IRS": "HB1", "ICP": [1, 11], **demo.cycles}
        run(folder, _constants(demo, given), folder / "equilibria")
        shutil.move(folder / "fort.8", folder / "cycles")


def _write(path: Path, text: dict[str, Any], demo: Demo) -> None:
    """A run file of a demo's plugin."""
    plugin = ROOT / "tests" / "peers" / "problems" / f"{demo.problem}.py"
    path.write_text(json.dumps({"system": str(plugin), **text}))  # JSON is YAML


def _compare(curve: Curve, folder: Path, repeats: int) -> None:
    engine, auto = list[float](), list[float]()
    _inside(curve, folder)  # the first run of a process compiles, or loads what was compiled
    for _ in range(repeats):
        seconds, rows = _auto(curve, folder)
        auto.append(seconds)
        seconds, branch = _inside(curve, folder)
        engine.append(seconds)
    ratio = statistics.median(a / b for a, b in zip(engine, auto, strict=True))
    medians = f"engine {statistics.median(engine):.3f}, AUTO {statistics.median(auto):.3f}"
    print(f"{curve.demo.name}, {curve.title}: {medians}, {ratio:.0f} times")
    print(f"  engine, {len(branch)} points, {branch.outcome.reason}:")
    for point in branch.special_points:
        values = " ".join(f"{point.parameters[name]:.13g}" for name in curve.ranges)
        print(f"    {point.name} {values}, error {point.error}")
    print(f"  AUTO, {len(rows)} points:")
    second = 2 + len(_system(curve.demo).states)  # after the first parameter, the norm and the states
    for row in rows:
        if row.label in TYPES:
            print(f"    {TYPES[row.label]} {row.value:.10g} {float(row.columns[second]):.10g}", flush=True)


def _inside(curve: Curve, folder: Path) -> tuple[float, Branch]:
    """CPU seconds of the curve in this process, and the curve."""
    path, ranges = folder / "curve.yaml", {name: list(ends) for name, ends in curve.ranges.items()}
    text = {
        "start": {"from": "study.h5", "point": curve.point},
        "continue": {"parameters": list(curve.ranges), "range": ranges},
        "mark": curve.marks,
    }
    _write(path, text, curve.demo)
    study = cw.read_run_file(path, output=folder / "curve.h5")
    begin = time.process_time()
    result = cw.run(study, force=True, figures=False)
    return time.process_time() - begin, result.branches[0]


def _auto(curve: Curve, folder: Path) -> tuple[float, list[Row]]:
    """CPU seconds of all starts of AUTO that follow a curve in both directions, and its points."""
    (first, along), (second, across) = curve.ranges.items()
    numbers, period = curve.numbers, [11] * curve.folds_of_cycles
    marks = {name: [v for v in values if v != "extremum"] for name, values in curve.marks.items()}
    given = {
        "IPS": 2 if curve.of_cycles else 1,
        "IRS": curve.auto,
        "ISW": 2,
        "ICP": [numbers[first], numbers[second], *period],
        "RL0": along[0],
        "RL1": along[1],
        "UZSTOP": {numbers[second]: list(across)},
        "UZR": {numbers[name]: values for name, values in marks.items()},
        **curve.constants,
    }
    begun, seconds, rows = folder / ("cycles" if curve.of_cycles else "equilibria"), 0.0, list[Row]()
    if curve.folds_of_cycles:  # its first free parameter is that along which the fold was found
        plain = {name: value for name, value in given.items() if name not in ("RL0", "RL1", "UZSTOP", "UZR")}
        seconds, _ = run(folder, _constants(curve.demo, {**plain, "ICP": [1, 2, 11]}), begun)
        begun = folder / "begun"
        shutil.move(folder / "fort.8", begun)
        given["IRS"] = "EP1"
    for step in (given["DS"], -given["DS"]):
        more, found = run(folder, _constants(curve.demo, {**given, "DS": step}), begun)
        seconds, rows = seconds + more, rows + found
    return seconds, rows


def _constants(demo: Demo, given: dict[str, Any]) -> str:
    """AUTO's constants file."""
    usual = f"""NDIM= {len(_system(demo).states)}, ILP= 1, ISP= 2, ISW= 1, NTST= 50, NCOL= 4, IAD= 3
IPLT= 0, NBC= 0, NINT= 0, NMX= 2000, NPR= 0, MXBF= 0, IID= 0, JAC= 1
ITMX= 12, ITNW= 8, NWTN= 3, EPSL= 1e-10, EPSU= 1e-10, EPSS= 1e-9
DSMIN= 1e-7, IADS= 1, NPAR= 11, THL= {{11: 0.0}}, THU= {{}}
"""
    return usual + "\n".join(f"{name}= {value!r}" for name, value in given.items()) + "\n"


if __name__ == "__main__":
    for library in ("OPENBLAS", "MKL", "OMP"):  # as the command line does
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    main()

"""Cost of the 3D walker: its equations, its steps, a point of its branches, a whole study.

    python benchmarks/walker3d.py [--repeats 7] [--slow-repeats 3] [--only field steps point] [--points 20]
    python benchmarks/walker3d.py --only study [--slow-repeats 3]

*field*: one evaluation, in loops of machine code. *steps*: half a stride of the preset `overlap`, from right
after its first event to the mirror image of that, and the whole stride, as in hybrid_step.py: each way runs
at many tolerances, the error *reached* is measured (time, states, and the matrix against its largest entry,
all in units of the states' magnitudes), and the CPU time at an error of 1e-6 and 1e-9 is interpolated. The
reference is computed by another method, arc by arc, at 1e-13; how well it closes upon its mirror image is
printed. *point*: the straight gait
in the inclination, as runs/walker3d_overlap_inclination.yaml has it, up from the printed state, in this
process; and which parts of the package its CPU seconds go to. *study*: `contwalk continue
runs/walker3d_figure9.yaml` with `diagram.follow=none`, the whole process; it takes minutes.

Set-up is not in the times; runs that are compared take turns; medians. docs/benchmarks.md says what to make
of it.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import os
import platform
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from cpu_shares import Part, Shares
from cpu_time import seconds_of
from event_map import StepMap
from hybrid_step import ByScipy, prepared, take_turns
from orbit_and_monodromy import Run, seconds_at

from contwalk import flow
from contwalk.errors import ContwalkError
from contwalk.fields.llvm import Code, code_of
from contwalk.flow.compiled.compiled_field import EACH
from contwalk.flow.explicit import stages
from contwalk.flow.explicit.driver_call import Call
from contwalk.flow.hybrid.event_integrator import EventIntegrator
from contwalk.flow.hybrid.event_records import ARRIVED
from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import HybridMachine, MotionSegment, hybrid_machine, motion_segments
from contwalk.system import load_system
from contwalk.workflow.run_file.reading import read_run_file
from contwalk.workflow.runner import Reporter, RunResult, run

Result = tuple[float, np.ndarray, np.ndarray]
Prepare = Callable[[float], Callable[[], Result]]

ROOT = Path(__file__).resolve().parent.parent
REFERENCE = ROOT / "tests" / "systems" / "walker3d_reference.json"
GAIT = json.loads(REFERENCE.read_text(encoding="utf-8"))["gaits"]["overlap"]
MODE = "swing1_toe21_toe22_knee2"
METHOD, OTHER_METHOD, EXACT = "dop853", "verner98", 1e-13
TARGETS = (1e-6, 1e-9)
TOLERANCES = [10.0 ** (-k / 2) for k in range(9, 27)]
OF_SCIPY = [10.0**-k for k in range(5, 14)]
BRANCH, STUDY = (ROOT / "runs" / f"walker3d_{name}.yaml" for name in ("overlap_inclination", "figure9"))
# Evaluations of the field in one measurement; steps of a march, and how long one is, in seconds.
EVALUATIONS, IN_PYTHON, STEPS, STEP = 2000, 20, 200, 2e-5
PARTS = (
    Part("compiled motion with tangents", ["contwalk.flow.integrate:tangents"]),
    Part(
        "compiled motion alone",
        [
            *(f"contwalk.flow.integrate:{name}" for name in ("adaptive", "along", "dense", "interpolation")),
            "contwalk.flow.explicit.runge_kutta:Interpolation.__call__",
        ],
    ),
    Part(
        "linear algebra",
        modules=[
            "numpy.linalg",
            *("contwalk.numerics.linear", "contwalk.problems.orbit.null_vectors"),
            *("contwalk.problems.orbit.condensed", "contwalk.problems.orbit.elimination"),
        ],
    ),
    Part("margins", ["contwalk.problems.hybrid.limits:margins"]),
    Part("soft transitions, by simulation", ["contwalk.problems.hybrid.softness:passed"]),
    Part(
        "steps made anew (mesh adaptation)",
        [
            "contwalk.problems.hybrid.hybrid_orbit:HybridOrbit.adapted_to",
            "contwalk.problems.hybrid.soft_orbit:SoftOrbit.adapted_to",
        ],
    ),
    Part("rates of multipliers", ["contwalk.problems.orbit.rates:of_modulus"]),
    Part("observables, the reported state", modules=["contwalk.problems.orbit.observing"]),
    Part("Newton's corrections", ["contwalk.continuation.newton:correct"]),
    Part("records on disk", modules=["contwalk.storage"]),
)


def main() -> None:
    """Measure and print."""
    parts: dict[str, Callable[[argparse.Namespace], None]] = {
        "field": _fields,
        "steps": _steps,
        "point": _points,
        "study": _study,
    }
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--repeats", type=int, default=7, help="of compiled code")
    parser.add_argument("--slow-repeats", type=int, default=3, help="of SciPy, branches and studies")
    parser.add_argument("--points", type=int, default=20, help="of the branch")
    parser.add_argument("--only", nargs="*", choices=parts, default=["field", "steps", "point"])
    parser.add_argument("--study", action="store_true", help="the study as well")
    given = parser.parse_args()
    print(f"python {platform.python_version()}, numpy {np.__version__}, {os.cpu_count()} cores, CPU seconds")
    for name in [*given.only, *(["study"] if given.study and "study" not in given.only else [])]:
        parts[name](given)


# -- the gait ------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Stride:
    """The gait from right after its first event on.

    Parameters
    ----------
    machine : HybridMachine
    weights : ndarray, shape (28,)
    mode, last : str
        The mode that it begins in, and the event that has led into it.
    x : ndarray, shape (28,)
    arcs : list of MotionSegment
        Of a whole stride.
    """

    machine: HybridMachine
    weights: np.ndarray
    mode: str
    last: str
    x: np.ndarray
    arcs: list[MotionSegment]

    @property
    def columns(self) -> list[int]:
        """The states that exist at its beginning: derivatives are by these."""
        return self.machine.mode(self.mode).states.tolist()

    def modes(self, events: int) -> list[str]:
        """Those that it leads through."""
        find = self.machine.system.transition
        after = [find(arc.transition, arc.mode).target for arc in self.arcs[:events]]
        return list(dict.fromkeys([self.mode, *after]))

    def map(self, events: int, method: str = METHOD) -> StepMap:
        """The map over a number of events."""
        return StepMap(
            self.machine,
            self.mode,
            events,
            self.weights,
            just_after=self.last,
            modes=self.modes(events),
            method=method,
            longest=2.0 * GAIT["T"],
        )


def _stride() -> Stride:
    """The gait on file, by the method that is not measured."""
    system = load_system("walker3d")
    machine = hybrid_machine(system, system.defaults() | dict(system.presets["overlap"]))
    weights = np.array([state.scale for state in system.states])
    control, x, longest = Control(EXACT, weights, OTHER_METHOD), np.array(GAIT["x"]), 2.0 * GAIT["T"]
    first = next(motion_segments(machine, 0.0, x, MODE, longest, control))
    mode, last, x = system.transition(first.transition, MODE).target, str(first.transition), first.after
    found = motion_segments(machine, 0.0, x, mode, longest, control, last)
    return Stride(machine, weights, mode, last, x, list(itertools.islice(found, len(GAIT["events"]))))


# -- one evaluation ------------------------------------------------------------------------------------------

# `evaluate(problem, t, y, k)` of the integrators as `(t, y, (evaluate, problem), k)`, which `EACH` calls.
_EVALUATED = """
define void @evaluated(double %t, ptr %y, ptr %c, ptr %k) nounwind {
  %evaluate = load ptr, ptr %c
  %problem_at = getelementptr i64, ptr %c, i64 1
  %problem = load ptr, ptr %problem_at
  tail call void %evaluate(ptr %problem, double %t, ptr %y, ptr %k)
  ret void
}
"""


class Evaluations:
    """Evaluations of a mode's field at one state, again and again, in machine code.

    All that they read and write stays in the processor's cache, as it does within the steps of an integrator.
    """

    def __init__(self, machine: HybridMachine, mode: str, x: np.ndarray) -> None:
        self.machine, self.mode, self.full = machine, machine.mode(mode), x
        self.field, self.c, self.x = self.mode.field, self.mode.c, x[self.mode.states]
        self.n, self._times = self.field.n, np.zeros(EVALUATIONS)
        self._call = Call(self.field, self.c, METHOD, self.x, self.n)
        self._call.tangents(np.eye(self.n), [-1] * self.n)
        tangent = stages.code(METHOD).addresses["tangent"]
        self._told = np.array([tangent, self._call.record.problem], dtype=np.int64)
        self._code: Code = code_of(_EVALUATED, ["evaluated"])
        self._out = np.zeros(max(self._call.length, self.n + len(self.field.col)))

    @property
    def ways(self) -> list[tuple[str, int, Callable[[], Any]]]:
        """What can be measured, how many evaluations a call makes, and the call."""
        per_march = STEPS * stages.TABLEAUS[METHOD].stages_of_step
        return [
            ("right-hand side as the plugin writes it, in Python", IN_PYTHON, self._written),
            ("right-hand side", EVALUATIONS, self._each(self.field.rhs_address)),
            ("right-hand side, Jacobian", EVALUATIONS, self._each(self.field.rhs_jac_address)),
            (f"right-hand side, Jacobian times {self.n} tangents", EVALUATIONS, self._tangent),
            ("a stage of a step", per_march, self._march),
            (f"a stage of a step with {self.n} tangents", per_march, self._march_with_tangents),
        ]

    def _written(self) -> None:
        mode, rates = self.machine.system.mode(self.mode.name), np.zeros(len(self.full))
        p = SimpleNamespace(**self.machine.parameters, **mode.constants)
        for _ in range(IN_PYTHON):
            mode.field(0.0, self.full, p, rates)

    def _each(self, function: int) -> Callable[[], int]:
        return lambda: self._repeated(function, self.x, self.c)

    def _tangent(self) -> int:
        return self._repeated(self._code.addresses["evaluated"], self._call.vectors[stages.Y], self._told)

    def _repeated(self, function: int, x: np.ndarray, c: np.ndarray) -> int:
        # Of states and results of length 0 the next one is where the last one was.
        out, times = self._out.ctypes.data, self._times.ctypes.data
        return EACH(function, EVALUATIONS, times, x.ctypes.data, 0, c.ctypes.data, out, 0)

    def _march(self) -> np.ndarray:
        return flow.along(self.field, self.c, STEP * np.arange(STEPS + 1), self.x, METHOD)

    def _march_with_tangents(self) -> np.ndarray:
        times, own = STEP * np.arange(STEPS + 1), [-1] * self.n
        return flow.tangents(self.field, self.c, times, self.x, np.eye(self.n), own, METHOD)[1]


def _fields(given: argparse.Namespace) -> None:
    stride = _stride()
    fullest = max(stride.arcs, key=lambda arc: len(stride.machine.mode(arc.mode).states))
    measured = Evaluations(stride.machine, fullest.mode, fullest.states[0])
    spent: dict[str, list[float]] = {name: [] for name, _, _ in measured.ways}
    for turn in range(given.repeats + 1):
        for name, count, call in measured.ways:
            begin = time.process_time()
            call()
            if turn:  # the first one compiles
                spent[name].append((time.process_time() - begin) / count)
    entries = f"{measured.n} states, {len(measured.field.col)} entries of the Jacobian"
    print(f"\n{f'one evaluation: {entries}; microseconds':62}")
    for name, seconds in spent.items():
        print(f"  {name:60}{1e6 * statistics.median(seconds):>10.2f}")


# -- steps ---------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Way:
    """A way to compute something: `prepare(tolerance)` gives a function that does."""

    name: str
    prepare: Prepare
    tolerances: list[float]
    repeats: int


@dataclass(frozen=True, eq=False)
class Group:
    """Ways to compute the same thing, and what is known of it."""

    name: str
    exact: Result
    weights: np.ndarray
    ways: list[Way]

    def error(self, found: Result) -> float:
        """The largest error of the time, the state, and the matrix if there is one; NaN for none."""
        t, x, matrix = (np.asarray(part) - exact for part, exact in zip(found, self.exact, strict=True))
        errors = [abs(t), np.abs(x / self.weights).max()]
        if matrix.size:
            scaled, size = (self._scaled(each) for each in (matrix, self.exact[2]))
            errors.append(np.abs(scaled).max() / np.abs(size).max())
        return float(np.max(errors))

    def _scaled(self, matrix: np.ndarray) -> np.ndarray:
        return matrix * self.weights / self.weights[:, None]


def _steps(given: argparse.Namespace) -> None:
    stride, whole = _stride(), len(GAIT["events"])
    exact = {n: stride.map(n, OTHER_METHOD)(0.0, stride.x, EXACT) for n in (whole // 2, whole)}
    _print_closure(stride, exact[whole // 2])
    measured = []
    for group in _groups(stride, exact, given):
        table = [
            [prepared(_told_lost(way.prepare), group.error, tolerance) for tolerance in way.tolerances]
            for way in group.ways
        ]
        measured.append((group, table))
    for turn in range(max(given.repeats, given.slow_repeats)):
        for group, table in measured:
            for way, runs in zip(group.ways, table, strict=True):
                take_turns(each for each in runs if turn < way.repeats)
    for group, table in measured:
        _print_group(group, table)


def _print_closure(stride: Stride, half: Result) -> None:
    """How well the reference closes upon its mirror image, and agrees with the period on file."""
    system, image = stride.machine.system, np.zeros(len(stride.x))
    system.symmetries[0].map(0.0, half[1], SimpleNamespace(**stride.machine.parameters), image)
    held = [system.state_names.index(neutral.pin) for neutral in system.neutral]
    apart = np.delete(np.abs(image - stride.x) / stride.weights, held).max()
    off = abs(half[0] - GAIT["T"] / 2.0)
    print(f"\nreference: closes upon its mirror image to {apart:.0e}, has the period on file to {off:.0e}")


def _print_group(group: Group, table: list[list[Run]]) -> None:
    targets = "".join(f"{f'at {target:.0e}':>22}" for target in TARGETS)
    print(f"\n{group.name + '; milliseconds':52}{targets}{'best reached':>15}")
    base = [seconds_at(table[0], target) for target in TARGETS]
    for way, runs in zip(group.ways, table, strict=True):
        cells = ""
        for target, unit in zip(TARGETS, base, strict=True):
            seconds = seconds_at(runs, target)
            ratio = f"({seconds / unit:.2f})" if seconds and unit else ""
            cells += f"{f'{1e3 * seconds:.2f} {ratio:>9}' if seconds else '-':>22}"
        print(f"  {way.name:50}{cells}{min(each.error for each in runs):>15.0e}")


def _told_lost(prepare: Prepare) -> Prepare:
    """As `prepare`, where a motion that takes another course has no result but NaN."""

    def given(tolerance: float) -> Callable[[], Result]:
        call = prepare(tolerance)

        def called() -> Result:
            try:
                return call()
            except (ContwalkError, LookupError, ValueError, StopIteration):
                return math.nan, np.array(math.nan), np.array(math.nan)

        return called

    return given


def _groups(stride: Stride, exact: dict[int, Result], given: argparse.Namespace) -> list[Group]:
    half, whole = exact
    states, derivatives = stride.columns, f"derivatives by {len(stride.columns)} states"

    def compiled(name: str, prepare: Prepare) -> Way:
        return Way(name, prepare, TOLERANCES, given.repeats)

    def by_scipy(name: str, columns: list[int], controlled: bool = True) -> Way:
        prepare = partial(_scipy, stride, half, columns, controlled)
        return Way(f"scipy DOP853{name}", prepare, OF_SCIPY, given.slow_repeats)

    def mapped(events: int) -> Prepare:
        step = stride.map(events)
        return lambda tolerance: lambda: step(0.0, stride.x, tolerance)

    t, x, _ = exact[half]
    return [
        Group(
            "half a stride, the motion alone",
            (t, x, np.empty(0)),
            stride.weights,
            [
                compiled("contwalk, one call", _walked(stride, half)),
                compiled("contwalk, arc by arc, as `simulate` does", _simulated(stride, half)),
                by_scipy("", []),
            ],
        ),
        Group(
            f"half a stride, {derivatives}",
            exact[half],
            stride.weights,
            [
                compiled("contwalk", mapped(half)),
                by_scipy(", errors of derivatives controlled", states),
                by_scipy(", errors of states controlled", states, False),
            ],
        ),
        Group(
            f"a whole stride, {derivatives}",
            exact[whole],
            stride.weights,
            [compiled("contwalk", mapped(whole))],
        ),
    ]


def _walked(stride: Stride, events: int) -> Prepare:
    """The motion in one call of compiled code."""
    walk = EventIntegrator(stride.machine, stride.weights, stride.modes(events), 0, events)

    def prepare(tolerance: float) -> Callable[[], Result]:
        def call() -> Result:
            walk.begin(0.0, stride.x, stride.mode, stride.last)
            if walk(2.0 * GAIT["T"], tolerance) != ARRIVED:
                raise LookupError
            mode = walk.modes[walk.happened.mode]
            state = stride.machine.full(mode, walk.places[mode].state)
            return float(walk.clock[0]), state, np.empty(0)

        return call

    return prepare


def _simulated(stride: Stride, events: int) -> Prepare:
    """The arcs of the motion, what is watched located too."""
    given = stride.machine, 0.0, stride.x, stride.mode, 2.0 * GAIT["T"]

    def prepare(tolerance: float) -> Callable[[], Result]:
        def call() -> Result:
            found = motion_segments(*given, Control(tolerance, stride.weights, METHOD), stride.last)
            *_, last = itertools.islice(found, events)
            return float(last.times[-1]), last.after, np.empty(0)

        return call

    return prepare


def _scipy(
    stride: Stride, events: int, columns: list[int], controlled: bool, tolerance: float
) -> Callable[[], Result]:
    """The motion and its derivatives by some states by `solve_ivp`."""
    machine, n = stride.machine, len(stride.x)
    by_scipy = ByScipy(machine, len(columns), stride.weights, tolerance, controlled)

    def call() -> Result:
        t, x, mode = 0.0, stride.x, stride.mode
        moved = np.eye(n)[np.ix_(stride.columns, columns)]
        for _ in range(events):
            acting = [each.name for each in machine.mode(mode).transitions if each.role != "watched"]
            t, x, moved, name = by_scipy.arc(t, x, moved, mode, acting)
            mode = machine.system.transition(name, mode).target
        if not columns:
            return t, x, np.empty(0)
        matrix = np.zeros((n, n))
        matrix[np.ix_(machine.mode(mode).states, columns)] = moved
        return t, x, matrix

    return call


# -- branches ------------------------------------------------------------------------------------------------


@dataclass
class Clock(Reporter):
    """When points were stored, in CPU seconds; from the second one to the last, `shares` are taken."""

    last: int
    shares: Shares | None = None
    at: list[float] = field(default_factory=list)

    def point(self, info: Any, parameter: float, step: float, unstable: int, number: int) -> None:
        """Told of each point."""
        self.at.append(time.process_time())
        if self.shares is not None and len(self.at) == 2:
            self.shares.start()
        if self.shares is not None and len(self.at) == self.last:
            self.shares.stop()


def _points(given: argparse.Namespace) -> None:
    before, each = list[float](), list[np.ndarray]()
    _branch(Clock(given.points))  # what is traced and compiled once
    for _ in range(given.slow_repeats):
        clock, begin = Clock(given.points), time.process_time()
        _branch(clock)
        before.append(clock.at[0] - begin)
        each.append(np.diff(clock.at))
    measured = {
        "seconds before the first is stored": (statistics.median(before), 2),
        "milliseconds from one to the next, mean": (1e3 * statistics.median(map(np.mean, each)), 0),
        "milliseconds from one to the next, median": (1e3 * statistics.median(map(np.median, each)), 0),
    }
    print(f"\n{len(clock.at)} points of the straight gait, inside the engine, warm")
    for name, (value, digits) in measured.items():
        print(f"  {name:60}{value:>10.{digits}f}")
    shares = Shares(PARTS)
    _branch(Clock(given.points, shares))
    _print_shares(shares)


def _branch(clock: Clock) -> RunResult:
    """The branch, as far as the clock counts."""
    changes = ["diagram.follow=none", f"continue.max_points={clock.last}"]
    with tempfile.TemporaryDirectory() as folder:
        study = read_run_file(BRANCH, changes, output=str(Path(folder) / "out.h5"))
        return run(study, force=True, figures=False, reporter=clock)


def _print_shares(shares: Shares) -> None:
    print(f"\n{'percent of the time between points':62}{'in all':>10}{'of its own':>12}")
    for part, within, own in zip(shares.parts, shares.within, shares.own, strict=True):
        print(f"  {part.name:60}{100.0 * within / shares.total:>10.0f}{100.0 * own / shares.total:>12.0f}")
    print(f"  {'none of these':60}{'':>10}{100.0 * (1.0 - sum(shares.own) / shares.total):>12.0f}")


def _study(given: argparse.Namespace) -> None:
    from contwalk import open_database

    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "out.h5"
        options = ["--quiet", "--no-figures", "--force", "--output", str(output)]
        options += ["--set", "diagram.follow=none"]
        command = [sys.executable, "-m", "contwalk", "continue", str(STUDY), *options]
        first, *spent = [seconds_of(command) for _ in range(given.slow_repeats + 1)]
        with open_database(output) as database:
            branches = database.branches()
    points, special = (sum(map(len, each)) for each in (branches, [b.special_points for b in branches]))
    print(
        f"\n{STUDY.stem}, diagram.follow=none: {len(branches)} branches, {points} points, {special} special"
    )
    print(f"  {'seconds of the whole process, the first':60}{first:>10.1f}")
    if spent:
        print(f"  {'seconds of the whole process, after it':60}{statistics.median(spent):>10.1f}")
    for branch in branches:
        labels = " ".join(point.label for point in branch.special_points)
        print(f"  {branch.name + ',':5}{len(branch):>4} points: {labels}")


if __name__ == "__main__":
    single = {f"{library}_NUM_THREADS": "1" for library in ("OPENBLAS", "MKL", "OMP")}
    if not single.keys() <= os.environ.keys():  # as the command line does; numpy has looked there by now
        os.execve(sys.executable, [sys.executable, *sys.argv], single | os.environ)
    main()

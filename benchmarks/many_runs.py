"""Many runs at once: whether whatever computes them leaves the same bytes; what a task costs by itself.

    python benchmarks/many_runs.py same [margins] [sample] [sweep] [starts]
    python benchmarks/many_runs.py overhead
    python benchmarks/many_runs.py wall [runs/walker3d_overlap.yaml] [margins.states=[q5,u1,u3] ...]

`same`: --jobs 1, 2 and 4, and dask clusters of 2 and 3 processes of which one is killed, for four studies:
margins of an oscillator beside a wall, motions drawn at random, the lines of a sweep, a diagram with several
starts. A worker is killed when the second task is sent, or the second result has come. Compared is everything
that is stored but for the hour and the seconds that it took. `overhead`: seconds to begin and milliseconds a
task beside its work, in two processes and on a cluster of two. `wall`: wall time and processor time of the
margins that a run file asks for, by --jobs 1 and 2; for the wall time the machine must have nothing else to
do.

The clusters need `pip install 'contwalk[distributed]'`.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the command line does

from contwalk.storage import open_database
from contwalk.storage.trajectory import read_samples
from contwalk.workflow import sampling
from contwalk.workflow.cluster import Cluster
from contwalk.workflow.many_runs import Runs
from contwalk.workflow.margins import margins
from contwalk.workflow.run_file.margins import read_margins
from contwalk.workflow.run_file.reading import read_run_file
from contwalk.workflow.run_file.sample import read_sampling
from contwalk.workflow.runner import run

ROOT = Path(__file__).parents[1]
PLUGIN = """
import math
from contwalk.system import Mode, Observable, Parameter, Start, State, System


def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -x[0] - 2.0 * p.zeta * x[1] + p.bend * x[0] ** 2 - p.load * x[0] ** 3


SYSTEM = System(
    "beside_a_wall",
    states=(State("x", "m", scale=1.0), State("v", "m/s", scale=1.0)),
    parameters=tuple(Parameter(name, 0.1 * (name == "zeta")) for name in ("zeta", "bend", "load")),
    modes=(Mode("free", field),),
    observables=(Observable("height", lambda t, x, p: x[:, 0].max()),),
    starts=(
        Start("rest", lambda p: [[0.0, 0.0]]),
        Start("all", lambda p: [[0.0, 0.0], [1.2, 0.0], [2.8, 0.0]]),
    ),
    fallen=lambda t, x, p: x[0] - 1.0,
)
"""
STUDY = """
system: ./beside_a_wall.py
start: {{equilibrium: {start}}}
continue: {{parameter: zeta, range: [-0.3, 0.3], max_points: 20}}
diagram: {{follow: [HB], depth: 1}}
{more}
"""
FILES = {
    "rest.yaml": STUDY.format(start="rest", more=""),
    "sweep.yaml": STUDY.format(start="rest", more="sweep: {load: {from: 0.1, to: 0.9, count: 5}}"),
    "starts.yaml": STUDY.format(start="all", more="parameters: {bend: 1.2, load: 0.3}"),
    "margins.yaml": STUDY.format(
        start="rest",
        more="""margins:
  of: {from: rest.h5, point: b1/EP2}
  random: {count: 40}
  survive: {time: 60}
  accuracy: 1e-9""",
    ),
    "sample.yaml": """
system: ./beside_a_wall.py
start: {state: {x: 1.0, v: 0.0}}
sample:
  count: 900
  draw: {x: [0.2, 0.9], zeta: [0.05, 0.3]}
  measure: {observable: height, level: 0.1, direction: falling, crossing: last}
  settled: {equilibrium: rest, within: {x: 1e-6, v: 1e-6}}
  until: 400
""",
}


class Killing(Cluster):
    """A cluster of this machine that loses a worker in the middle of what it computes."""

    def __init__(self, client: Any, workers: Any) -> None:
        super().__init__(client)
        self._workers, self._sent = workers, 0

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Any:
        self._sent += 1
        if self._sent == 2:
            self._kill()
        return super().submit(function, *arguments)

    def _results(self, function: Callable[..., Any], *arguments: Any) -> Iterator[Any]:
        for number, result in enumerate(super()._results(function, *arguments)):
            if number == 1:
                self._kill()
            yield result

    def _kill(self) -> None:
        self._workers[0].process.process.kill()
        print("        a worker is killed", file=sys.stderr)


@contextlib.contextmanager
def cluster(processes: int, killing: bool = True) -> Iterator[Cluster]:
    """A cluster of processes of this machine."""
    import distributed

    with (
        distributed.LocalCluster(processes, threads_per_worker=1, dashboard_address=None) as local,
        distributed.Client(local, set_as_default=False) as client,
    ):
        yield Killing(client, local.workers) if killing else Cluster(client)


def stored_margins(output: str, **how: Any) -> list[bytes]:
    """The bytes of the files of a margins study."""
    result = margins(read_margins("margins.yaml", (), output), figures=False, **how)
    return [file.read_bytes() for file in result.files]


def stored_samples(output: str, **how: Any) -> list[bytes]:
    """What is stored of a sampling."""
    jobs = how.pop("jobs", 1)
    found = sampling.sample(read_sampling("sample.yaml", (), output), threads=jobs, figures=False, **how)
    stored = read_samples(found.files[0])
    return [getattr(stored, name).tobytes() for name in ("draws", "values", "settled", "crossed", "ends")]


def stored_branches(file: str) -> Callable[..., list[bytes]]:
    """What is stored of the branches of a run file, but for the seconds that they took."""

    def stored(output: str, **how: Any) -> list[bytes]:
        run_file = read_run_file(file, (), output)
        run(run_file, figures=False, **how)
        found = []
        with open_database(run_file.output) as db:
            for branch in db.branches():
                columns = sorted(set(branch.points.dtype.names) - {"seconds"})
                found += [branch.points[name].tobytes() for name in columns]
                found += [repr(vars(point)).encode() for point in branch.special_points]
                found.append(repr((branch.info, branch.outcome)).encode())
        return found

    return stored


STUDIES: dict[str, Callable[..., list[bytes]]] = {
    "margins": stored_margins,
    "sample": stored_samples,
    "sweep": stored_branches("sweep.yaml"),
    "starts": stored_branches("starts.yaml"),
}


def same(names: list[str]) -> int:
    """Compare; the exit code is the number of computations that differ."""
    sampling.PART = 50  # so that a cluster has something to lose
    differing = 0
    for name in names:
        stored = STUDIES[name]
        one = stored(f"{name}-1.h5")
        print(f"{name}: {len(one)} arrays and files, {sum(map(len, one))} bytes")
        for jobs in (2, 4):
            differing += _told(f"--jobs {jobs}", stored(f"{name}-{jobs}.h5", jobs=jobs) == one)
        for processes in (2, 3):
            with cluster(processes) as executor:
                found = stored(f"{name}-c{processes}.h5", executor=executor)
            differing += _told(f"cluster of {processes}, one killed", found == one)
    return differing


def _told(what: str, equal: bool) -> int:
    print(f"    {what}: {'the same' if equal else 'DIFFERENT'}", flush=True)
    return not equal


def slept(shared: Any, seconds: float) -> float:
    """A task that only takes time."""
    time.sleep(seconds)
    return seconds


def overhead() -> int:
    """Print what beginning and a task cost, and what that makes of 1000 cores."""
    shared = os.urandom(500_000)  # of the size of a 3D walker's study
    print("workers, tasks, ms each: seconds in all, of which ms a task beside its work")
    with Runs(slept, shared, jobs=2) as runs:
        _timed("processes 2", runs, 2)
    with cluster(2, killing=False) as executor, Runs(slept, shared, executor=executor) as runs:
        _timed("cluster   2", runs, 2)
    return 0


def _timed(name: str, runs: Runs[Any, float, float], workers: int) -> None:
    begun = time.perf_counter()
    list(runs.in_order([0.0] * workers))
    print(f"{name}: {time.perf_counter() - begun:.2f} s to begin")
    for count, each in ((400, 0.0), (400, 0.01), (100, 0.1)):
        begun, used = time.perf_counter(), time.process_time()
        list(runs.in_order([each] * count))
        taken, used = time.perf_counter() - begun, time.process_time() - used
        beside = (taken - count * each / workers) / count
        print(
            f"    {count} tasks of {1e3 * each:.0f} ms: {taken:.2f} s, {1e3 * beside:.2f} ms a task; "
            f"processor time of the one that hands out: {1e3 * used / count:.2f} ms a task"
        )


def wall(given: list[str]) -> int:
    """Print what the margins of a run file take by one process and by two."""
    source, *changes = given or [str(ROOT / "runs" / "walker3d_overlap.yaml")]
    file = Path(source).name
    Path(file).write_text((ROOT / source).read_text(encoding="utf-8"), encoding="utf-8")
    contwalk = [sys.executable, "-c", "from contwalk.cli.entry import main; main()"]
    more = [word for change in changes for word in ("--set", change)]
    subprocess.run([*contwalk, "continue", file, "--no-figures", "--quiet"], check=True)
    alone = 0.0
    for jobs in (1, 2):
        begun, used = time.perf_counter(), _of_children()
        how = ["--jobs", str(jobs), "--no-figures", "--quiet", "--force"]
        subprocess.run([*contwalk, "margins", file, *more, *how], check=True)
        taken, used = time.perf_counter() - begun, _of_children() - used
        alone = alone or taken
        print(
            f"--jobs {jobs}: {taken:.1f} s, {taken / alone:.3f} of one's; {used:.1f} s of processor time",
            flush=True,
        )
    return 0


def _of_children() -> float:
    """Processor time of the processes that have ended, with those that they have waited for."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main() -> int:
    """Run what is asked for in a folder of its own."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", choices=("same", "overhead", "wall"))
    parser.add_argument("studies", nargs="*", metavar="study", help=f"{', '.join(STUDIES)}; or a run file")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        if given.what == "wall":
            return wall(given.studies)
        Path("beside_a_wall.py").write_text(PLUGIN, encoding="utf-8")
        for name, text in FILES.items():
            Path(name).write_text(text, encoding="utf-8")
        if given.what == "overhead":
            return overhead()
        run(read_run_file("rest.yaml", (), "rest.h5"), figures=False)
        return same(given.studies or list(STUDIES))


if __name__ == "__main__":
    sys.exit(main())

"""`kill -9` at random moments of a cascade of orbits: --resume ends with the same diagram, bit by bit."""

import multiprocessing
import os
import random
from pathlib import Path

import numpy as np

from contwalk.storage import open_database
from contwalk.workflow.run_file import read_run_file
from contwalk.workflow.runner import Reporter, run

RUN = """
contwalk: 1
system: autobalancer
model: {masses: 2}
preset: heavy
parameters: {omega: 5.0}
start: {equilibrium: balanced, parameters: {delta: 0.0065}}
continue: {parameter: delta, range: [0.0030, 0.0065], direction: backward}
diagram: {follow: [HB, PD], depth: 3}
mark: {delta: [0.0045]}
"""
KILLS = 8
# Parts of the time of an uninterrupted run after which a run is killed: early ones and late ones.
SHORTEST, LONGEST = 0.05, 0.6


def compute(folder: Path, output: str) -> None:
    """A run in a process of its own, which goes on with what there is."""
    run_file = read_run_file(folder / "run.yaml", output=str(folder / output))
    run(run_file, resume=True, figures=False)


def test_killed_cascades_end_as_an_uninterrupted_one(tmp_path):
    (tmp_path / "run.yaml").write_text(RUN)
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["contwalk.workflow.runner", "contwalk.workflow.run_file"])

    def start(output: str) -> multiprocessing.Process:
        process = context.Process(target=compute, args=(tmp_path, output))
        process.start()
        return process

    start("warm.h5").join()  # what is compiled once is in the cache now
    (tmp_path / "warm.h5").unlink()
    whole = start("whole.h5")
    whole.join()
    assert whole.exitcode == 0
    with open_database(tmp_path / "whole.h5") as db:
        seconds = sum(branch.cost["seconds"] for branch in db.branches())
        names = [branch.info.origin for branch in db.branches()]
    assert [name.split("/")[-1] for name in names[1:]] == ["HB1", "PD1", "PD1"]

    moments, path, kills, finished, rows = random.Random(11), tmp_path / "killed.h5", 0, 0, []
    while kills < KILLS and finished < 3 * KILLS:
        process = start(path.name)
        process.join(moments.uniform(SHORTEST, LONGEST) * max(seconds, 0.5))
        if process.exitcode is None:
            process.kill()
            process.join()
            kills += 1
            rows.append(stored(path))
        else:
            assert process.exitcode == 0
            finished += 1
            assert_same(tmp_path / "whole.h5", path)
            path.unlink()
    process = start(path.name)
    process.join()
    assert process.exitcode == 0
    assert_same(tmp_path / "whole.h5", path)
    assert kills == KILLS
    assert max(rows) > 0, "no run was killed after its first point: kill later"


class Ending(Reporter):
    """Ends the process, as a kill would, at the report of a given number."""

    def __init__(self, number: int) -> None:
        self._left = number

    def _count(self) -> None:
        if self._left == 0:
            os._exit(9)
        self._left -= 1

    def point(self, info, parameter, step, unstable, number):
        self._count()

    def special(self, info, point):
        self._count()


def compute_until(folder: Path, output: str, number: int) -> None:
    """As `compute`, ended at a report."""
    run_file = read_run_file(folder / "run.yaml", output=str(folder / output))
    run(run_file, resume=True, figures=False, reporter=Ending(number))


def test_runs_ended_beside_special_points_and_at_births_go_on_to_the_same_diagram(tmp_path):
    """Ended at every third report of the last two branches, where special points and births are dense."""
    (tmp_path / "run.yaml").write_text(RUN)
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["contwalk.workflow.runner", "contwalk.workflow.run_file"])

    def ended(output: str, number: int) -> int | None:
        process = context.Process(target=compute_until, args=(tmp_path, output, number))
        process.start()
        process.join()
        return process.exitcode

    assert ended("whole.h5", -1) == 0
    with open_database(tmp_path / "whole.h5") as db:
        sizes = [len(branch) for branch in db.branches()]
    for number in range(sum(sizes[:2]) - 6, sum(sizes), 3):
        output = f"ended_{number}.h5"
        assert ended(output, number) == 9
        assert ended(output, -1) == 0
        assert_same(tmp_path / "whole.h5", tmp_path / output)


def stored(path: Path) -> int:
    """Number of stored points of orbits."""
    if not path.exists():
        return 0
    with open_database(path) as db:
        return sum(len(b) for b in db.branches() if b.info.problem == "periodic_orbit")


def assert_same(whole: Path, path: Path) -> None:
    """The two databases hold the same diagram, to the last bit."""
    with open_database(whole) as a, open_database(path) as b:
        assert a.branch_names() == b.branch_names()
        for one, other in zip(a.branches(), b.branches(), strict=True):
            assert one.info == other.info
            columns = ("s", "free", "state", "period", "unknowns", "tangent", "weights", "spectrum")
            for column in (*columns, "observables", "trivial_error", "unstable", "special", "step"):
                same = np.array_equal(one.points[column], other.points[column], equal_nan=True)
                assert same, (one.name, column)
            assert one.outcome == other.outcome
            assert described(one) == described(other)


def described(branch) -> list[tuple]:
    """Special points as plain values."""
    return [
        (p.name, p.index, p.s, p.parameters, p.period, p.error, p.criticality, p.coefficients, p.spectrum)
        for p in branch.special_points
    ]

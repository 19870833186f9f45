"""`kill -9` at 50 random moments: nothing stored is lost, and --resume ends with the same diagram."""

import multiprocessing
import os
import random
import time
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from contwalk.storage import open_database
from contwalk.workflow.run_file.reading import read_run_file
from contwalk.workflow.runner import Reporter, run

pytestmark = pytest.mark.slow


PLUGIN = """
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0] = p.mu * x[0] - x[0] * x[0] * x[0] + x[1] * x[0]
    dx[1] = -x[1] - 0.1 * x[0] * x[0]

SYSTEM = System(
    name="fork",
    states=(State("x"), State("y")),
    parameters=(Parameter("mu", -0.5),),
    modes=(Mode("smooth", field),),
)
"""
RUN = """
contwalk: 1
system: ./fork.py
start: {state: {x: 0.0, y: 0.0}}
continue: {parameter: mu, range: [-1.0, 1.0]}
mark: {mu: [-0.5, 0.25], max_re: [-0.25]}
engine: {max_step: 0.02}
"""
KILLS, MOST_KILLS = 50, 12
# A run is killed after so many times as long as it takes at the latest: some early, some go on to the end.
LONGEST = 1.0


class Told(Reporter):
    """Says, past all buffers, which points were stored."""

    def __init__(self, path: Path) -> None:
        self._file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND)

    def point(self, info, parameter, step, unstable, number):
        os.write(self._file, f"{info.name} {number}\n".encode())


def compute(folder: Path, output: str) -> None:
    """A run in a process of its own, which goes on with what there is."""
    told = Told(folder / f"{output}.told")
    run(
        read_run_file(folder / "run.yaml", output=str(folder / output)),
        resume=True,
        figures=False,
        reporter=told,
    )


def stored(path: Path) -> dict[str, int]:
    """Rows of each branch; a file that is not there yet has none."""
    if not path.exists():
        return {}
    with open_database(path) as db:
        return {name: len(db.rows(name)) for name in db.branch_names()}


def told(path: Path) -> dict[str, int]:
    """The last point of each branch that was said to be stored."""
    last = Counter()
    for line in path.read_text().splitlines() if path.exists() else []:
        name, number = line.split()
        last[name] = int(number)
    return last


def test_killed_runs_end_with_the_diagram_of_an_uninterrupted_one(tmp_path):
    (tmp_path / "fork.py").write_text(PLUGIN)
    (tmp_path / "run.yaml").write_text(RUN)
    # A server that has imported everything forks the runs: they start in no time.
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(
        ["contwalk.workflow.runner", "contwalk.workflow.run_file.reading", "mpmath"]
    )

    def start(output: str) -> multiprocessing.Process:
        process = context.Process(target=compute, args=(tmp_path, output))
        process.start()
        return process

    for _ in range(2):  # the first one waits for the server's imports
        began = time.perf_counter()
        whole = start("whole.h5")
        whole.join()
        lasts = time.perf_counter() - began
        assert whole.exitcode == 0

    moments, kills, again, finished = random.Random(7), 0, 0, 0
    path = tmp_path / "killed.h5"
    while kills < KILLS:
        process = start(path.name)
        # One that has been killed often enough may end, so that all is compared.
        process.join(moments.uniform(0.0, LONGEST * lasts) if again < MOST_KILLS else None)
        if process.exitcode is None:
            process.kill()
            process.join()
            kills, again = kills + 1, again + 1
            kept, said = stored(path), told(tmp_path / f"{path.name}.told")
            assert all(kept.get(name, 0) >= number for name, number in said.items()), (kept, said)
            assert readable(path)
        else:
            assert process.exitcode == 0
            assert_same(tmp_path / "whole.h5", path)
            finished, again = finished + 1, 0
            path.unlink()
            (tmp_path / f"{path.name}.told").unlink()
    process = start(path.name)
    process.join()
    assert_same(tmp_path / "whole.h5", path)
    assert finished > 0


def readable(path: Path) -> bool:
    """Whether every stored row is complete: finite, and its arclength not seen before."""
    if not path.exists():
        return True
    with open_database(path) as db:
        for branch in db.branches():
            regular = branch.points[~branch.points["special"]]
            if not np.all(np.isfinite(regular["unknowns"])) or len(np.unique(regular["s"])) != len(regular):
                return False
    return True


def assert_same(whole: Path, path: Path) -> None:
    """The two databases hold the same diagram, to the last bit."""
    with open_database(whole) as a, open_database(path) as b:
        assert a.branch_names() == b.branch_names()
        for one, other in zip(a.branches(), b.branches(), strict=True):
            for column in ("s", "free", "unknowns", "spectrum", "unstable", "special", "step"):
                assert np.array_equal(one.points[column], other.points[column]), (one.name, column)
            assert one.outcome == other.outcome
            found = [(p.name, p.index, p.parameters, p.error) for p in one.special_points]
            assert found == [(p.name, p.index, p.parameters, p.error) for p in other.special_points]

"""Runs in processes of their own that are killed, and databases compared bit by bit."""

from __future__ import annotations

import multiprocessing
import os
import random
import shutil
import time
from collections.abc import Iterable, Mapping, Sequence
from itertools import count
from pathlib import Path

import numpy as np

from contwalk.storage import open_database
from contwalk.workflow.run_file.reading import read_run_file
from contwalk.workflow.runner import Reporter, run

# Parts of the time of an uninterrupted process after which one is killed: early ones and late ones.
SHORTEST, LONGEST = 0.2, 0.9
NONE: Mapping[int, Path] = {}
# A supercritical pitchfork at mu = 0, with a state that only follows the parameter.
FORK_PLUGIN = """
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0] = p.mu * x[0] - x[0] ** 3
    dx[1] = p.mu - x[1]

SYSTEM = System(
    name="fork",
    states=(State("x"), State("y")),
    parameters=(Parameter("mu", -0.5),),
    modes=(Mode("smooth", field),),
)
"""


class Counting(Reporter):
    """Numbers the reports, from 0 on."""

    def __init__(self) -> None:
        self._numbers = count()

    def point(self, info, parameter, step, unstable, number):
        self.reported(next(self._numbers))

    def special(self, info, point):
        self.reported(next(self._numbers))

    def reported(self, number: int) -> None:
        """What is done at a report."""


class Ending(Counting):
    """Ends the process, as a kill would, at the report of a given number."""

    def __init__(self, number: int) -> None:
        super().__init__()
        self._last = number

    def reported(self, number: int) -> None:
        if number == self._last:
            os._exit(9)


class Copying(Counting):
    """Keeps what a process that is killed at some reports leaves: the file as it is on disk then."""

    def __init__(self, output: Path, copies: Mapping[int, Path]) -> None:
        super().__init__()
        self._output, self._copies = output, copies

    def reported(self, number: int) -> None:
        if number in self._copies:
            shutil.copyfile(self._output, self._copies[number])


def compute(
    path: Path, overrides: Sequence[str], output: Path, number: int = -1, copies: Mapping[int, Path] = NONE
) -> None:
    """A run that goes on with what there is; ended at the report of this number, or copied at some."""
    run_file = read_run_file(path, overrides, str(output))
    reporter = Copying(output, copies) if copies else Ending(number)
    run(run_file, resume=True, figures=False, reporter=reporter)


class Runs:
    """A run file as processes.

    Parameters
    ----------
    path : Path
    folder : Path
        Where databases go.
    overrides : sequence of str
    """

    def __init__(self, path: Path, folder: Path, overrides: Sequence[str] = ()) -> None:
        self.path, self.folder, self.overrides = path, folder, tuple(overrides)
        self.context = multiprocessing.get_context("forkserver")
        self.context.set_forkserver_preload(
            ["contwalk.workflow.runner", "contwalk.workflow.run_file.reading"]
        )

    def start(
        self, output: str, number: int = -1, copies: Mapping[int, Path] = NONE
    ) -> multiprocessing.Process:
        given = self.path, self.overrides, self.folder / output, number, copies
        process = self.context.Process(target=compute, args=given)
        process.start()
        return process

    def ended(self, output: str, number: int = -1) -> int | None:
        """Exit code of a run that is waited for."""
        process = self.start(output, number)
        process.join()
        return process.exitcode

    def left(self, numbers: Iterable[int]) -> list[str]:
        """What runs that end at the reports of these numbers leave, all of one run; names of the files."""
        copies = {number: self.folder / f"ended_{number}.h5" for number in numbers}
        process = self.start("copied.h5", copies=copies)
        process.join()
        assert process.exitcode == 0
        assert_same(self.folder / "whole.h5", self.folder / "copied.h5")
        assert all(path.exists() for path in copies.values())
        return [path.name for path in copies.values()]

    def whole(self) -> float:
        """Run without interruption into whole.h5; seconds that the process took."""
        assert self.ended("warm.h5") == 0  # what is compiled once is in the cache now
        (self.folder / "warm.h5").unlink()
        began = time.monotonic()
        assert self.ended("whole.h5") == 0
        return time.monotonic() - began

    def killed(self, seconds: float, kills: int, problem: str, seed: int = 11) -> int:
        """Kill runs at random moments until so many were killed, each goes on with what the one before left.

        Returns the most points of `problem` that a killed run left.
        """
        moments, path, done, finished, rows = random.Random(seed), self.folder / "killed.h5", 0, 0, []
        while done < kills and finished < 3 * kills:
            process = self.start(path.name)
            process.join(moments.uniform(SHORTEST, LONGEST) * seconds)
            if process.exitcode is None:
                process.kill()
                process.join()
                done += 1
                rows.append(stored(path, problem))
            else:
                assert process.exitcode == 0
                finished += 1
                assert_same(self.folder / "whole.h5", path)
                path.unlink()
        assert self.ended(path.name) == 0
        assert_same(self.folder / "whole.h5", path)
        assert done == kills
        return max(rows)


def stored(path: Path, problem: str) -> int:
    """Number of stored points of branches of a kind."""
    if not path.exists():
        return 0
    with open_database(path) as db:
        return sum(len(b) for b in db.branches() if b.info.problem == problem)


def assert_same(whole: Path, path: Path) -> None:
    """The two databases hold the same diagram, to the last bit."""
    with open_database(whole) as a, open_database(path) as b:
        assert a.branch_names() == b.branch_names()
        for one, other in zip(a.branches(), b.branches(), strict=True):
            assert one.info == other.info
            columns = ("s", "free", "state", "period", "unknowns", "tangent", "weights", "spectrum")
            more = ("observables", "trivial_error", "unstable", "stable", "admissible", "special", "step")
            for column in (*columns, *more):
                same = np.array_equal(one.points[column], other.points[column], equal_nan=True)
                assert same, (one.name, column)
            assert one.outcome == other.outcome
            assert described(one) == described(other)


def described(branch) -> list[tuple]:
    """Special points as plain values."""
    fields = (
        "name",
        "kind",
        "index",
        "s",
        "parameters",
        "state",
        "period",
        "period_full",
        "error",
        "spectrum",
    )
    more = (
        "criticality",
        "coefficients",
        "margin",
        "admissible",
        "note",
        "unstable_before",
        "unstable_after",
    )
    return [tuple(getattr(p, name) for name in (*fields, *more)) for p in branch.special_points]

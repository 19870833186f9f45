"""What a run leaves when the disk is full, when it is told to end, and while it goes on."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from contwalk.cli import progress
from contwalk.storage import hdf5_branch, open_database
from contwalk.storage.hdf5 import Hdf5Database
from contwalk.storage.records import RecordLog
from contwalk.workflow import runner

LONG = ("--set", "diagram={follow: [BP]}", "--set", "engine={max_share: 0.01}")


def columns(path):
    """All that a run has stored, but for the time it took."""
    with open_database(path) as db:
        names = [name for name in db["b1"].points.dtype.names if name != "seconds"]
        return [[branch.name, branch.outcome, *(branch.points[n].tobytes() for n in names)] for branch in db]


def limited(folder, *arguments, size):
    """A command in a process that may write files of so many bytes."""

    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

    command = [sys.executable, "-m", "contwalk", *arguments]
    return subprocess.run(command, cwd=folder, preexec_fn=limit, capture_output=True, text=True, check=False)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("size", [140_000, 200_000, 280_000])
def test_a_limit_on_the_size_of_files(contwalk, folder, size):
    assert contwalk("continue", "run.yaml", *LONG, "--output", "whole.h5", "--quiet").code == 0
    assert (folder / "whole.h5").stat().st_size > 300_000
    done = limited(folder, "continue", "run.yaml", *LONG, "--quiet", size=size)
    assert done.returncode == 1
    assert "ulimit -f): fork.h5 cannot grow. Every point stored before is kept." in done.stderr
    assert "--resume" in done.stderr
    with open_database("fork.h5") as db:
        assert len(db["b1"]) > 10
    assert contwalk("show", "fork.h5").code == 0
    assert contwalk("continue", "run.yaml", *LONG, "--resume", "--quiet").code == 0
    assert columns("fork.h5") == columns("whole.h5")


def test_no_room_to_begin(folder):
    done = limited(folder, "continue", "run.yaml", "--quiet", size=10_000)
    assert done.returncode == 2
    assert "ulimit -f): fork.h5 cannot be created" in done.stderr
    assert not list(folder.glob("*.h5"))


class Terminating(progress.NoteKeeper):
    """Is told to end at the fifth point, as by `kill`."""

    def point(self, info, parameter, step, unstable, number):
        if number == 5:
            os.kill(os.getpid(), signal.SIGTERM)


def test_sigterm(contwalk, folder, monkeypatch):
    before = signal.getsignal(signal.SIGTERM)
    with monkeypatch.context() as patched:
        patched.setattr(progress, "reporter_for", lambda ends, quiet: Terminating())
        done = contwalk("continue", "run.yaml")
    assert done.code == 143
    assert done.err == (
        "Terminated; everything found is stored. Go on with:\n  contwalk continue run.yaml --resume\n"
    )
    assert signal.getsignal(signal.SIGTERM) is before
    with open_database("fork.h5") as db:
        assert db["b1"].outcome.reason == "interrupted"
        assert len(db["b1"]) >= 5
    assert contwalk("continue", "run.yaml", "--resume", "--quiet").code == 0


WRITES = ("start_branch", "append", "append_special", "finish", "write_note", "_rewrite")


class Interrupting:
    """Ctrl-C right before or right after a write, or a part of one."""

    def __init__(self, patch, which=-1, within=None):
        self.which, self.count = which, 0
        for name in WRITES:
            self.around(patch, Hdf5Database, name)
        if within is not None:
            self.around(patch, *within)

    def around(self, patch, owner, name):
        real = getattr(owner, name)

        def watched(*given, **options):
            self.reached()
            result = real(*given, **options)
            self.reached()
            return result

        patch.setattr(owner, name, watched)

    def reached(self):
        self.count += 1
        if self.count == self.which:
            raise KeyboardInterrupt


@pytest.mark.parametrize("within", [None, (hdf5_branch, "publish"), (RecordLog, "append")])
def test_an_interruption_at_any_write(contwalk, folder, monkeypatch, within):
    """At each of the first ones, while the first branch is made, and at some of all others."""
    short = ("--set", "continue.max_points=12", "--set", "diagram={follow: [BP]}")
    with monkeypatch.context() as patch:
        counted = Interrupting(patch, within=within)
        assert contwalk("continue", "run.yaml", *short, "--output", "whole.h5", "--quiet").code == 0
    whole = columns("whole.h5")
    for which in (*range(1, 12), *range(12, counted.count, counted.count // 6), counted.count - 1):
        with monkeypatch.context() as patch:
            Interrupting(patch, which, within)
            done = contwalk("continue", "run.yaml", *short, "--force", "--quiet")
        assert done.code == 130, (which, done)
        assert "Go on with:\n  contwalk continue run.yaml" in done.err, which
        assert contwalk("show", "fork.h5").code == 0
        assert contwalk("continue", "run.yaml", *short, "--resume", "--quiet").code == 0
        assert columns("fork.h5") == whole, which


def test_a_run_can_be_looked_at_while_it_goes_on(contwalk, folder, monkeypatch):
    seen, real = [], runner.Reporter.point

    class Watched(progress.NoteKeeper):
        def point(self, info, parameter, step, unstable, number):
            real(self, info, parameter, step, unstable, number)
            if number == 6:
                with open_database("fork.h5") as db:
                    seen.append((len(db[info.name]), db[info.name].outcome.message))
                command = [sys.executable, "-m", "contwalk", "continue", "run.yaml", "--force", "--quiet"]
                seen.append(subprocess.run(command, capture_output=True, text=True, check=False))

    with monkeypatch.context() as patched:
        patched.setattr(progress, "reporter_for", lambda ends, quiet: Watched())
        assert contwalk("continue", "run.yaml").code == 0
    (rows, message), second = seen
    assert rows >= 6
    assert "is still being computed" in message
    assert second.returncode == 2
    assert "fork.h5 is in use: another process writes it" in second.stderr
    with open_database("fork.h5") as db:
        assert db["b1"].complete
        assert np.all(np.diff(db["b1"]["s"]) >= 0.0)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("{bifurcation_diagram: {file: a.gif}}", "the format .gif is not known. Allowed: .png, .svg, .pdf"),
        ("{bifurcation_diagram: {file: nowhere/a.png}}", "nowhere/a.png cannot be created: the directory"),
        ("{bifurcation_diagram: {file: " + 300 * "a" + ".png}}", "is too long for a file"),
    ],
)
def test_names_of_figures_are_refused_before_anything_is_computed(contwalk, folder, given, said):
    done = contwalk("continue", "run.yaml", "--set", f"figures=[{given}]")
    assert (done.code, said in done.err) == (2, True), done.err
    assert not (folder / "fork.h5").exists()
    undrawn = contwalk("continue", "run.yaml", "--no-figures", "--quiet", "--set", f"figures=[{given}]")
    # A format that is not known is an error of the run file; where a file cannot be is one where it is drawn.
    assert undrawn.code == (2 if "format" in said else 0), undrawn.err


DRAWS = 'def draw(axes, t, x, p):\n    raise SystemExit("no")\n'


def test_a_figure_that_cannot_be_drawn_is_said_and_the_others_are_drawn(contwalk, folder):
    text = (folder / "fork.py").read_text(encoding="utf-8")
    start = text.index("def draw")
    end = text.index("SYSTEM")
    (folder / "fork.py").write_text(text[:start] + DRAWS + text[end:], encoding="utf-8")
    figures = "figures=[machine, phase_portrait, bifurcation_diagram]"
    done = contwalk("continue", "run.yaml", "--set", figures)
    assert done.code == 0
    assert "note: The figure 'machine' was not drawn: " in done.out
    assert "fork.py, line" in done.out
    assert "note: The figure 'phase_portrait' was not drawn: No branch has periodic orbits" in done.out
    assert [path.name for path in folder.glob("*.png")] == ["fork_bifurcation_diagram.png"]
    assert "internal error" not in done.err


CIRCLE = """
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    growth = p.mu - x[0] ** 2 - x[1] ** 2
    dx[0] = growth * x[0] - x[1]
    dx[1] = x[0] + growth * x[1]

SYSTEM = System("circle", (State("x"), State("y")), (Parameter("mu", 0.5),), (Mode("only", field),))
"""
CYCLES = """
contwalk: 1
system: ./circle.py
start: {simulate: {state: {x: 0.7, y: 0.0}, until: settled}}
continue: {parameter: mu, range: [0.4, 0.6], max_points: 4}
output: circle.h5
"""


def as_it_was(db, ended):
    """A copy of an open database as a version wrote it that stored no extremes of states."""
    old = Hdf5Database.create("old.h5", db.header)
    for branch in db.branches():
        info = replace(branch.info, observables=("max_abs",))
        old.start_branch(info)
        for row in db.rows(branch.name):
            fewer = np.zeros(1, info.point_dtype())
            for name in fewer.dtype.names:
                fewer[name][0] = row[name][-1:] if name == "observables" else row[name]
            old.append(branch.name, fewer)
        for point in db.specials(branch.name):
            old.append_special(branch.name, point)
        if ended:
            old.finish(branch.name, branch.outcome, branch.cost)
    old.close()


@pytest.mark.parametrize("ended", [True, False])
def test_a_database_from_before_a_column_is_read_but_not_gone_on_with(contwalk, folder, ended):
    (folder / "circle.py").write_text(CIRCLE, encoding="utf-8")
    (folder / "circle.yaml").write_text(CYCLES, encoding="utf-8")
    assert contwalk("continue", "circle.yaml", "--quiet").code == 0
    with open_database("circle.h5") as db:
        as_it_was(db, ended)
    done = contwalk("continue", "circle.yaml", "--resume", "--quiet", "--output", "old.h5")
    if ended:
        assert (done.code, done.err) == (0, "")
    else:
        assert done.code == 2
        assert done.err == (
            "error: Branch b1 cannot be gone on with: its stored points have no max:x, max:y, min:x, min:y. "
            "Another version of contwalk began it. "
            "Go on with that version, give another --output, or --force to start anew.\n"
        )
    with open_database("old.h5") as db, open_database("circle.h5") as now:
        assert np.array_equal(db["b1"]["mu"], now["b1"]["mu"])
        assert db["b1"].complete is ended
    assert contwalk("plot", "old.h5", "-y", "max_abs", "-o", "old.svg").code == 0
    assert contwalk("plot", "old.h5", "-o", "default.svg").code == 0
    assert contwalk("show", "old.h5").code == 0

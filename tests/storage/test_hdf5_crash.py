"""`kill -9` at any moment loses at most the point that was being written."""

import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager

import h5py
import numpy as np
import pytest

from contwalk.branch import Outcome
from contwalk.storage import Hdf5Database, open_database
from contwalk.storage.hdf5_branch import StoredBranch
from contwalk.storage.records import RecordLog

pytestmark = pytest.mark.slow

KEPT = 5

WRITER = """
import os, signal, sys
import numpy as np
from contwalk.branch import BranchInfo, SpecialPoint
from contwalk.storage.database import RunHeader
from contwalk.storage.hdf5 import Hdf5Database

def write(path, told):
    info = BranchInfo("b1", "equilibrium", tuple(f"q{k}" for k in range(28)), (), ("m",), {"m": 1.0}, 28, 28)
    db = Hdf5Database.create(path, RunHeader("oscillator"))
    db.start_branch(info)
    row = np.zeros((), info.point_dtype())
    for s in range(100000):
        row["s"] = row["free"] = s
        db.append("b1", row)
        os.write(told, b"p")
        if s % 3 == 0:
            db.append_special("b1", SpecialPoint("UZ", float(s), parameters={"m": 1.0}, note="x" * 100))
            os.write(told, b"s")

# One process imports; each line of its input is a path, and each run a fork, so that 50 of them are fast.
for line in sys.stdin:
    read, told = os.pipe()
    child = os.fork()
    if child == 0:
        write(line.strip(), os.open(line.strip() + ".told", os.O_WRONLY | os.O_CREAT, 0o600))
    print(child, flush=True)
    os.waitpid(child, 0)
    os.close(read), os.close(told)
    print("ended", flush=True)
"""


def killed_runs(tmp_path, count):
    """Paths of databases whose writers were killed at random moments."""
    random = np.random.default_rng(20240611)
    parent = subprocess.Popen(
        [sys.executable, "-c", WRITER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1
    )
    try:
        for run in range(count):
            path = tmp_path / f"run{run}.h5"
            parent.stdin.write(f"{path}\n")
            parent.stdin.flush()
            child = int(parent.stdout.readline())
            told = path.with_name(path.name + ".told")
            while not (told.exists() and told.stat().st_size):
                time.sleep(0.001)
            time.sleep(random.uniform(0.0, 0.15))
            os.kill(child, signal.SIGKILL)
            assert parent.stdout.readline() == "ended\n"
            yield path, told.read_bytes()
    finally:
        parent.stdin.close()
        parent.wait()
        parent.stdout.close()


def test_fifty_kills(tmp_path):
    lengths = set()
    for path, told in killed_runs(tmp_path, 50):
        points, specials = told.count(b"p"), told.count(b"s")
        with open_database(path) as db:
            rows, special_points = db.rows("b1"), db.specials("b1")
            assert not db.branch("b1").complete
        # What was acknowledged is there; the one being written may be, whole.
        assert len(rows) in (points, points + 1)
        assert len(special_points) in (specials, specials + 1)
        assert rows["s"].tolist() == [float(s) for s in range(len(rows))]
        assert [point.s for point in special_points] == [float(3 * k) for k in range(len(special_points))]
        with Hdf5Database.open(path, writable=True) as db:
            row = rows[-1].copy()
            row["s"] = -1.0
            db.append("b1", row)
        with open_database(path) as db:
            assert db.rows("b1")["s"].tolist() == [*rows["s"].tolist(), -1.0]
        if len(lengths) >= KEPT:  # what is left is read again, and held against the interface
            path.unlink()
        lengths.add(len(rows))
    assert len(lengths) > 10  # the kills did come at different moments


def torn_file(tmp_path, header, make_info, make_row, tear):
    path = tmp_path / "torn.h5"
    with Hdf5Database.create(path, header) as db:
        db.start_branch(make_info())
        for s in range(5):
            db.append("b1", make_row(make_info(), float(s)))
    with h5py.File(path, "r+") as file:
        tear(file["branches/b1/points"])
    return path


def test_a_row_never_written_is_ignored_and_replaced(tmp_path, header, make_info, make_row):
    path = torn_file(tmp_path, header, make_info, make_row, lambda points: points.resize((6,)))
    with open_database(path) as db:
        assert db.branch("b1")["s"].tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]
    with Hdf5Database.open(path, writable=True) as db:
        db.append("b1", make_row(make_info(), 5.0))
    with h5py.File(path) as file:
        assert file["branches/b1/points"]["s"].tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]


def test_a_row_written_in_part_is_ignored(tmp_path, header, make_info, make_row):
    def tear(points):
        row = points[4]
        row["tangent"] = 0.0
        points[4] = row

    path = torn_file(tmp_path, header, make_info, make_row, tear)
    with open_database(path) as db:
        assert db.rows("b1")["s"].tolist() == [0.0, 1.0, 2.0, 3.0]


def test_an_append_that_was_interrupted_leaves_no_gap(tmp_path, header, make_info, make_row, monkeypatch):
    """Ctrl-C between growing the dataset and writing the row."""
    info = make_info()
    with Hdf5Database.create(tmp_path / "run.h5", header) as db:
        db.start_branch(info)
        db.append("b1", make_row(info, 0.0))

        def interrupted(*_args):
            raise KeyboardInterrupt

        with monkeypatch.context() as patch:
            patch.setattr(RecordLog, "_write", interrupted)
            with pytest.raises(KeyboardInterrupt):
                db.append("b1", make_row(info, 1.0))
        assert db.rows("b1")["s"].tolist() == [0.0]
        db.append("b1", make_row(info, 2.0))
        assert db.rows("b1")["s"].tolist() == [0.0, 2.0]


@contextmanager
def finished_branch(tmp_path, header, make_info, make_row, spoil):
    """A finished branch of two points, as another process sees it after something was done to its points."""
    path = tmp_path / "finished.h5"
    with Hdf5Database.create(path, header) as db:
        db.start_branch(make_info())
        for s in (0.0, 1.0):
            db.append("b1", make_row(make_info(), s))
        db.finish("b1", Outcome("complete", "bound", "Reached the end."), {"seconds": 1.0, "rhs": 80})
    with h5py.File(path, "r+") as file:
        spoil(file["branches/b1/points"])
    with h5py.File(path) as file:
        yield StoredBranch.open(file["branches/b1"])


def doubled(points):
    points[1] = points[0]  # each row is whole, as its checksum says


@pytest.mark.parametrize(
    ("spoil", "told"),
    [
        (doubled, "the rows of branch b1 are not those that it was finished with"),
        (lambda points: points.resize((1,)), "has 1 of its 2 rows"),
    ],
)
def test_other_rows_than_those_that_a_branch_was_finished_with_are_refused(
    tmp_path, header, make_info, make_row, spoil, told
):
    finished = finished_branch(tmp_path, header, make_info, make_row, spoil)
    with finished as branch, pytest.raises(ValueError, match=told):
        branch.rows()


def test_a_finished_branch_has_its_rows(tmp_path, header, make_info, make_row):
    with finished_branch(tmp_path, header, make_info, make_row, lambda points: None) as branch:
        assert branch.rows()["s"].tolist() == [0.0, 1.0]

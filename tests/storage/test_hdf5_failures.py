"""Files that cannot be read or written: a sentence and a remedy, and nothing lost."""

import errno
import os
import resource
import shutil
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

from contwalk.errors import DatabaseError, WriteError
from contwalk.storage import Hdf5Database, RunHeader, failures, hdf5, open_database
from contwalk.storage.records import RecordLog
from contwalk.storage.schema import SCHEMA_VERSION


@pytest.fixture
def stored(tmp_path, header, make_info, make_row):
    """A file with one branch of 20 points."""
    path = tmp_path / "stored.h5"
    with Hdf5Database.create(path, header) as db:
        db.start_branch(make_info())
        for s in range(20):
            db.append("b1", make_row(make_info(), float(s)))
    return path


@pytest.fixture
def tiny_disk(tmp_path):
    """A file system of 1 MiB."""
    place = tmp_path / "disk"
    place.mkdir()
    mount = shutil.which("mount")
    command = [mount or "mount", "-t", "tmpfs", "-o", "size=1m", "none", str(place)]
    if mount is None or subprocess.run(command, capture_output=True, check=False).returncode:
        pytest.skip("mounting a small file system needs root")
    yield place
    subprocess.run(["umount", "-l", str(place)], check=True)


def test_missing_file_names_those_that_exist(stored):
    with pytest.raises(DatabaseError, match="does not exist") as caught:
        open_database(stored.with_name("store.h5"))
    assert "stored.h5" in caught.value.remedy


def test_of_two_that_create_a_file_at_once_one_is_refused(tmp_path, header, monkeypatch):
    path, create = tmp_path / "run.h5", hdf5.create_file

    def overtaken(*given):
        path.write_bytes(b"of the other one")
        return create(*given)

    monkeypatch.setattr(hdf5, "create_file", overtaken)
    with pytest.raises(DatabaseError, match=r"run\.h5 exists"):
        Hdf5Database.create(path, header)
    assert path.read_bytes() == b"of the other one"
    assert list(tmp_path.iterdir()) == [path]


def test_missing_directory(tmp_path, header):
    with pytest.raises(DatabaseError, match="does not exist"):
        open_database(tmp_path / "no" / "run.h5")
    with pytest.raises(DatabaseError, match=r"the directory .*no does not exist"):
        Hdf5Database.create(tmp_path / "no" / "run.h5", header)


def test_directory(tmp_path, header):
    with pytest.raises(DatabaseError, match="is a directory"):
        open_database(tmp_path)
    with pytest.raises(DatabaseError, match="is a directory"):
        Hdf5Database.create(tmp_path, header, overwrite=True)


def test_not_a_regular_file(header):
    with pytest.raises(DatabaseError, match="not a regular file"):
        Hdf5Database.create("/dev/null", header, overwrite=True)


@pytest.mark.parametrize("content", [b"", b"contwalk: 1\n", b"\x89PNG\r\n\x1a\n" + b"x" * 100])
def test_not_hdf5(tmp_path, content):
    path = tmp_path / "run.h5"
    path.write_bytes(content)
    with pytest.raises(DatabaseError, match="not an HDF5 file"):
        open_database(path)


@pytest.mark.parametrize("mark", [None, "other", np.array([1.0, 2.0])])
def test_hdf5_of_another_program(tmp_path, mark):
    path = tmp_path / "run.h5"
    with h5py.File(path, "w") as file:
        if mark is not None:
            file.attrs["format"] = mark
    with pytest.raises(DatabaseError, match="of another program"):
        open_database(path)


def test_newer_schema(stored):
    with h5py.File(stored, "r+") as file:
        file.attrs["schema_version"] = SCHEMA_VERSION + 1
    with pytest.raises(DatabaseError, match=f"schema version {SCHEMA_VERSION + 1}") as caught:
        open_database(stored)
    assert "upgrade" in caught.value.remedy


@pytest.mark.parametrize("part", [0.01, 0.2, 0.5, 0.9, 0.99])
def test_truncated_file(stored, part):
    content = stored.read_bytes()
    stored.write_bytes(content[: int(len(content) * part)])
    with pytest.raises(DatabaseError, match="is damaged"):
        open_database(stored)


def test_damaged_bytes_never_give_a_traceback_or_wrong_numbers(stored):
    """Blocks of zeros or noise anywhere: the same points, or a DatabaseError."""
    content = stored.read_bytes()
    right = open_database(stored).rows("b1").tobytes()
    random = np.random.default_rng(5)
    refused = 0
    for trial in range(150):
        broken = bytearray(content)
        start = int(random.integers(0, len(content) - 64))
        broken[start : start + 64] = bytes(64) if trial % 2 else random.bytes(64)
        stored.write_bytes(broken)
        try:
            with open_database(stored) as db:
                rows = db.rows("b1").tobytes()
                db.branches(), db.notes()
        except DatabaseError:
            refused += 1
        else:
            assert right.startswith(rows)
            assert len(right) - len(rows) <= len(right) // 20  # the last of 20 may look torn
    assert refused > 0


def test_damage_in_the_middle_names_the_row(stored):
    with h5py.File(stored, "r+") as file:
        points = file["branches/b1/points"]
        row = points[7]
        row["s"] = 0.5
        points[7] = row
    with open_database(stored) as db, pytest.raises(DatabaseError, match="row 7 of 20"):
        db.branch("b1")


@pytest.mark.parametrize("log", ["header", "branches/b1/info"])
def test_damaged_header_or_info(stored, log):
    with h5py.File(stored, "r+") as file:
        row = file[log][0]
        row["text"] = b"{}"
        file[log][0] = row
    with pytest.raises(DatabaseError, match="is damaged"):
        open_database(stored)


@pytest.mark.parametrize(
    "part", ["header", "catalogue", "notes", "branches/b1/points", "branches/b1/outcome"]
)
def test_missing_part(stored, part):
    with h5py.File(stored, "r+") as file:
        del file[part]
    with pytest.raises(DatabaseError, match="is damaged"):
        open_database(stored)


def test_existing_output_is_kept_unless_overwritten(stored, header):
    before = stored.read_bytes()
    with pytest.raises(DatabaseError, match="exists") as caught:
        Hdf5Database.create(stored, header)
    assert "--force" in caught.value.remedy
    with pytest.raises(DatabaseError, match="cannot be stored"):
        Hdf5Database.create(stored, RunHeader("x", {"choice": object()}), overwrite=True)
    assert stored.read_bytes() == before
    with Hdf5Database.create(stored, header, overwrite=True) as db:
        assert db.branch_names() == []
    assert [path.name for path in stored.parent.iterdir()] == [stored.name]


def test_a_failed_creation_leaves_the_old_file(stored, header, monkeypatch):
    before = stored.read_bytes()

    def full(*_args):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(hdf5, "create_file", full)
    with pytest.raises(DatabaseError, match="disk is full"):
        Hdf5Database.create(stored, header, overwrite=True)
    assert stored.read_bytes() == before
    assert [path.name for path in stored.parent.iterdir()] == [stored.name]


def test_a_damaged_output_can_be_overwritten(tmp_path, header):
    path = tmp_path / "run.h5"
    path.write_bytes(b"\x89HDF\r\n\x1a\n" + b"\0" * 50)
    Hdf5Database.create(path, header, overwrite=True).close()
    assert open_database(path).header == header


def test_a_symbolic_link_stays_one(stored, header):
    link = stored.with_name("link.h5")
    link.symlink_to(stored)
    Hdf5Database.create(link, header, overwrite=True).close()
    assert link.is_symlink()
    assert open_database(stored).branch_names() == []


@pytest.mark.parametrize("code", [errno.EACCES, errno.EROFS, errno.EPERM])
def test_read_only_directory(tmp_path, header, monkeypatch, code):
    # not by chmod, which does not bind root
    def refused(*_args):
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(hdf5, "create_file", refused)
    with pytest.raises(DatabaseError, match="cannot be created: " + os.strerror(code)) as caught:
        Hdf5Database.create(tmp_path / "run.h5", header)
    assert "permissions" in caught.value.remedy


def test_read_only_file_system(tiny_disk, header):
    subprocess.run(["mount", "-o", "remount,ro", str(tiny_disk)], check=True)
    with pytest.raises(DatabaseError, match="cannot be created: Read-only file system"):
        Hdf5Database.create(tiny_disk / "run.h5", header)


def test_writing_to_a_file_open_for_reading(stored, make_info, make_row):
    with open_database(stored) as db:
        writes = (
            lambda: db.start_branch(make_info("b2")),
            lambda: db.append("b1", make_row(make_info(), 0.0)),
            lambda: db.write_note("a", "b"),
            lambda: db.drop("b1"),
            lambda: db.truncate("b1", 1, []),
        )
        for write in writes:
            with pytest.raises(DatabaseError, match="open for reading only"):
                write()
        assert len(db.rows("b1")) == 20


def test_a_file_that_another_process_writes(stored, header):
    child = subprocess.Popen(
        [
            sys.executable,
            "-c",
            "import sys; from contwalk.storage.hdf5 import Hdf5Database\n"
            "db = Hdf5Database.open(sys.argv[1], writable=True); print('open', flush=True); sys.stdin.read()",
            str(stored),
        ],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    )
    try:
        assert child.stdout.readline() == b"open\n"
        with open_database(stored) as db:
            assert len(db.rows("b1")) == 20
        for use in (
            lambda: Hdf5Database.open(stored, writable=True),
            lambda: Hdf5Database.create(stored, header, overwrite=True),
        ):
            with pytest.raises(DatabaseError, match="another process"):
                use()
    finally:
        child.communicate()
    with open_database(stored) as db:
        assert len(db.rows("b1")) == 20


def test_the_lock_goes_on_where_a_file_takes_the_place_of_another(stored, header, make_info):
    with Hdf5Database.open(stored, writable=True) as db:
        for change in (lambda: db.truncate("b1", 5, []), lambda: db.drop("b1"), lambda: None):
            change()
            with pytest.raises(DatabaseError, match="is in use"):
                Hdf5Database.open(stored, writable=True)
            with pytest.raises(DatabaseError, match="is in use"):
                Hdf5Database.create(stored, header, overwrite=True)
        db.start_branch(make_info("b2"))
    with Hdf5Database.open(stored, writable=True) as db:
        assert db.branch_names() == ["b2"]
    assert [path.name for path in stored.parent.iterdir()] == [stored.name]


def fill(db, info, make_row, make_special, why="disk is full"):
    """Append until the database refuses; how many points and special points it has acknowledged."""
    done = [0, 0]

    def forever():
        while True:
            db.append("b1", make_row(info, float(done[0])))
            done[0] += 1
            db.append_special("b1", make_special("UZ", float(done[1])))
            done[1] += 1

    with pytest.raises(WriteError, match=why) as caught:
        forever()
    assert "--resume" in caught.value.remedy
    assert caught.value.exit_code == 1
    return done


@pytest.mark.parametrize("foresight", [True, False])
def test_full_disk_keeps_every_point(
    tiny_disk, header, make_info, make_row, make_special, monkeypatch, foresight
):
    """With the check of the free space before a write, and where the disk fills up behind it."""
    if not foresight:
        monkeypatch.setattr(failures, "RESERVE", -(1 << 40))
    info = make_info()
    path = tiny_disk / "run.h5"
    db = Hdf5Database.create(path, header)
    db.start_branch(info)
    points, specials = fill(db, info, make_row, make_special)
    db.close()
    assert points > 10
    with open_database(path) as again:
        assert again.rows("b1")["s"].tolist()[:points] == [float(s) for s in range(points)]
        assert [point.s for point in again.specials("b1")][:specials] == [float(s) for s in range(specials)]


@pytest.mark.drawn(1)
@pytest.mark.parametrize("foresight", [True, False])
def test_a_limit_on_the_size_of_files_keeps_every_point(
    tmp_path, header, make_info, make_row, make_special, monkeypatch, foresight
):
    """With the check before a write, and where HDF5 is refused in the middle of one."""
    if not foresight:
        monkeypatch.setattr(failures, "largest_file", lambda: None)
    info, before = make_info(), resource.getrlimit(resource.RLIMIT_FSIZE)
    for size in range(90_000, 240_000, 7_300):
        path = tmp_path / f"{size}.h5"
        db = Hdf5Database.create(path, header)
        db.start_branch(info)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
        try:
            points, specials = fill(db, info, make_row, make_special, "limited")
            with pytest.raises(DatabaseError, match="limited"):
                db.write_note("later", "what has failed is not tried again")
            db.close()
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)
        with open_database(path) as again:
            assert again.rows("b1")["s"].tolist()[:points] == [float(s) for s in range(points)]
            assert [p.s for p in again.specials("b1")][:specials] == [float(s) for s in range(specials)]
        with Hdf5Database.open(path, writable=True) as again:
            again.append("b1", make_row(info, -1.0))
            assert len(again.rows("b1")) >= points + 1


def test_full_disk_reported_by_hdf5(stored, make_info, make_row, monkeypatch):
    with Hdf5Database.open(stored, writable=True) as db:

        def full(_log, _record):
            raise OSError(f"Can't write data ({os.strerror(errno.ENOSPC)})")

        monkeypatch.setattr(RecordLog, "_write", full)
        with pytest.raises(DatabaseError, match="disk is full"):
            db.append("b1", make_row(make_info(), 20.0))
    with open_database(stored) as db:
        assert len(db.rows("b1")) == 20


def test_a_failed_rewrite_leaves_the_file_and_no_draft(stored, monkeypatch):
    db = Hdf5Database.open(stored, writable=True)

    def full(*_args):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(DatabaseError, match="disk is full"):
        db.truncate("b1", 3, [])
    monkeypatch.undo()
    db.close()
    assert [path.name for path in stored.parent.iterdir()] == [stored.name]
    with open_database(stored) as again:
        assert len(again.rows("b1")) == 20


@pytest.mark.parametrize(("soft", "most"), [(1000, 1000), (resource.RLIM_INFINITY, None)])
def test_the_limit_on_the_size_of_files_is_the_one_that_is_enforced(monkeypatch, soft, most):
    """A process may raise it up to the hard one, but has not."""
    monkeypatch.setattr(resource, "getrlimit", lambda which: (soft, 5000))
    assert failures.largest_file() == most


def test_a_broken_disk_is_told_in_few_words():
    """HDF5 says it in a paragraph, and h5py again where it lets go of the file."""
    text = (
        "Disable slist failed (file write failed: errno = 5, error message = 'Input/output error', buf = 0x1)"
    )
    error = failures.explained(Path("x.h5"), "create", RuntimeError(text))
    assert str(error) == "x.h5 cannot be created: Input/output error. Choose another output."

"""Files that are written whole: whatever stands in the way of one, and whoever writes beside."""

from __future__ import annotations

import errno
import os
import stat
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from contwalk.errors import ContwalkError
from contwalk.files import drafts
from contwalk.files.drafts import AlreadyThereError, put_in_place, written
from contwalk.plotting import save
from contwalk.storage import Hdf5Database, RunHeader
from contwalk.storage.csv_files import write_csv
from contwalk.storage.failures import refuse_existing
from contwalk.storage.trajectory import Margins, Samples, write_margins, write_samples

EMPTY = np.empty(0)


def samples(path: Path) -> None:
    write_samples(path, Samples("s", ("x",), "time", EMPTY.reshape(0, 1), EMPTY, EMPTY, EMPTY, EMPTY))


def margins(path: Path) -> None:
    instant = {"fraction": 0.0, "time": 0.0, "mode": "m", "state": [0.0]}
    write_margins(path, Margins("s", ("x",), (), (instant,)))


def database(path: Path) -> None:
    Hdf5Database.create(path, RunHeader("s"), overwrite=True).close()


def reopened(path: Path) -> None:
    if not path.exists():
        database(path)
    Hdf5Database.open(path, writable=True).close()


def table(path: Path) -> None:
    write_csv(path, ["x"], [[1.0]])


def figure(path: Path) -> None:
    figure = Figure()
    figure.add_subplot()
    save(figure, path)


WRITERS: dict[str, tuple[str, Callable[[Path], None]]] = {
    "samples": ("x.h5", samples),
    "margins": ("x.h5", margins),
    "database": ("x.h5", database),
    "reopened": ("x.h5", reopened),
    "table": ("x.csv", table),
    "figure": ("x.png", figure),
}


@pytest.fixture(params=WRITERS)
def writer(request, tmp_path) -> tuple[Path, Callable[[Path], None]]:
    """Each kind of file that contwalk writes: its name, and what writes it."""
    name, write = WRITERS[request.param]
    return tmp_path / name, write


def test_nothing_is_left_beside_a_file(writer):
    path, write = writer
    write(path)
    write(path)
    assert os.listdir(path.parent) == [path.name]


@pytest.mark.skipif(not os.path.isdir("/proc/self/fd"), reason="descriptors have no names")
def test_a_file_is_on_the_disk_before_its_name_and_the_name_after_it(writer, monkeypatch):
    path, write = writer
    synchronise, replace, link, happened = os.fsync, Path.replace, os.link, []

    def synchronised(descriptor: int) -> None:
        synchronise(descriptor)
        name, status = os.readlink(f"/proc/self/fd/{descriptor}"), os.fstat(descriptor)
        happened.append(("on disk", name, status.st_ino, status.st_size))

    def replaced(draft: Path, target: Path) -> Path:
        happened.append(("named", str(target), draft.stat().st_ino, draft.stat().st_size))
        return replace(draft, target)

    def linked(draft: Path, target: Path) -> None:
        happened.append(("named", str(target), draft.stat().st_ino, draft.stat().st_size))
        link(draft, target)

    monkeypatch.setattr(os, "link", linked)
    monkeypatch.setattr(os, "fsync", synchronised)
    monkeypatch.setattr(Path, "replace", replaced)
    write(path)
    whole = path.stat()
    named = [k for k, (what, name, *_) in enumerate(happened) if (what, name) == ("named", str(path))]
    assert named
    before, after = happened[: named[-1]], happened[named[-1] + 1 :]
    assert ("on disk", whole.st_ino) in [(what, inode) for what, _, inode, _ in before]
    assert ("on disk", str(path.parent)) in [(what, name) for what, name, *_ in after]
    last = [size for what, _, inode, size in happened if (what, inode) == ("on disk", whole.st_ino)][-1]
    assert last == whole.st_size, "what was written last is on the disk as well, as a seal"


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o664])
def test_who_may_read_a_file_stays_as_it_is(writer, mode):
    path, write = writer
    write(path)
    path.chmod(mode)
    write(path)
    assert stat.S_IMODE(path.stat().st_mode) == mode


def test_who_may_read_a_new_file_is_what_the_user_has_set(writer):
    path, write = writer
    before = os.umask(0o027)
    try:
        write(path)
    finally:
        os.umask(before)
    assert stat.S_IMODE(path.stat().st_mode) == 0o640


def test_a_file_that_is_there_to_be_read_only_stays(writer):
    path, write = writer
    write(path)
    before = path.read_bytes()
    path.chmod(0o444)
    with pytest.raises(ContwalkError, match=r"cannot be .*Permission denied"):
        write(path)
    with pytest.raises(ContwalkError, match="Permission denied"):  # and before anything is computed
        refuse_existing([path], force=True)
    assert path.read_bytes() == before
    assert os.listdir(path.parent) == [path.name]


def test_a_link_to_itself_is_no_output(writer):
    path, write = writer
    path.symlink_to(path.name)
    with pytest.raises(ContwalkError, match=os.strerror(errno.ELOOP)):
        write(path)
    with pytest.raises(ContwalkError, match=os.strerror(errno.ELOOP)):
        refuse_existing([path], force=False)
    assert path.is_symlink()


def test_a_link_stays_one_and_what_it_leads_to_is_written(writer):
    path, write = writer
    (path.parent / "there").mkdir()
    path.symlink_to(Path("there") / path.name)
    write(path)
    assert path.is_symlink()
    assert (path.parent / "there" / path.name).is_file()
    assert sorted(os.listdir(path.parent)) == ["there", path.name]
    assert os.listdir(path.parent / "there") == [path.name]


def test_a_draft_takes_no_name_that_is_known_beforehand(writer, monkeypatch):
    """Whoever knew it could plant a link there, and what that leads to would be written."""
    path, write = writer
    write(path)
    tokens = iter(["aaaaaaaa", "aaaaaaaa", "bbbbbbbb", "cccccccc"])
    monkeypatch.setattr(drafts.secrets, "token_hex", lambda count: next(tokens))
    victim = path.parent / "victim"
    victim.write_text("mine")
    (path.parent / f".{path.stem}.aaaaaaaa.new{path.suffix}").symlink_to(victim)
    with pytest.raises(ContwalkError, match="cannot be"):
        write(path)
    assert victim.read_text() == "mine"


def test_drafts_of_killed_processes_go_with_the_next_one(writer):
    path, write = writer
    left = path.with_name(f".{path.stem}.0123abcd.new{path.suffix}")
    left.write_text("half")
    others = [path.with_name(".notes.new"), path.with_name(f".other.0123abcd.new{path.suffix}")]
    for other in others:
        other.write_text("mine")
    write(path)
    assert sorted(path.parent.iterdir()) == sorted([path, *others])


def test_a_draft_that_another_process_fills_stays(writer):
    path, write = writer
    code = (
        "import sys; from pathlib import Path; from contwalk.files.drafts import written\n"
        "with written(Path(sys.argv[1])) as file:\n"
        "    file.write(b'other'), file.flush(), print('fills', flush=True), sys.stdin.read()\n"
    )
    given = [sys.executable, "-c", code, str(path)]
    child = subprocess.Popen(given, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert child.stdout is not None
    assert child.stdout.readline() == b"fills\n"
    write(path)
    assert path.read_bytes() != b"other"
    child.communicate()
    assert child.returncode == 0
    assert path.read_bytes() == b"other"  # the last one counts, and either was whole
    assert os.listdir(path.parent) == [path.name]


def test_a_draft_that_was_taken_for_an_abandoned_one_is_made_again(tmp_path, monkeypatch):
    path, lock = tmp_path / "x", drafts.lock
    taken = []

    def removed(draft):
        if not taken:
            taken.append(draft)
            draft.unlink()
        return lock(draft)

    monkeypatch.setattr(drafts, "lock", removed)
    with written(path) as file:
        file.write(b"whole")
    assert path.read_bytes() == b"whole"
    assert list(tmp_path.iterdir()) == [path]


def test_what_fails_leaves_the_file_that_was_there(writer, monkeypatch):
    path, write = writer
    write(path)
    before = path.read_bytes()

    def full(*given):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    for function in ("link", "replace"):
        monkeypatch.setattr(os, function, full)
    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(ContwalkError, match=r"disk is full|No space left"):
        write(path)
    assert path.read_bytes() == before
    assert os.listdir(path.parent) == [path.name]


@pytest.mark.parametrize("links", [True, False])
def test_a_new_file_goes_over_no_other(tmp_path, monkeypatch, links):
    def refused(*given):
        raise PermissionError(errno.EPERM, "no links")

    if not links:
        monkeypatch.setattr(os, "link", refused)
    draft, target = tmp_path / "draft", tmp_path / "target"
    draft.write_text("one")
    put_in_place(draft, target, new=True)
    draft.write_text("two")
    with pytest.raises(AlreadyThereError):
        put_in_place(draft, target, new=True)
    assert target.read_text() == "one"

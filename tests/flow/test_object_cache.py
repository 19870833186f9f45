"""The cache of object code: cold, warm, damaged, unwritable, shared."""

from __future__ import annotations

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from contwalk import object_cache
from contwalk.fields import llvm

_TEXT = "define double @twice(double %x) {\n  %y = fadd double %x, %x\n  ret double %y\n}\n"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("CONTWALK_CACHE_DIR", str(tmp_path))
    return tmp_path / "objects"


@pytest.fixture
def compilations(monkeypatch):
    """Texts that were compiled and not taken from the cache."""
    done, real = [], llvm.compiled

    def counted(text):
        done.append(text)
        return real(text)

    monkeypatch.setattr(llvm, "compiled", counted)
    return done


def twice():
    import ctypes

    code = llvm.code_of(_TEXT, ("twice",))
    return code.function("twice", ctypes.c_double, ctypes.c_double)(21.0)


def test_compiled_once(folder, compilations):
    assert [twice(), twice(), twice()] == [42.0, 42.0, 42.0]
    assert len(compilations) == 1
    assert len(list(folder.iterdir())) == 1


def test_another_text_is_another_key(folder, compilations):
    twice()
    llvm.code_of(_TEXT.replace("fadd", "fmul"), ("twice",))
    assert len(compilations) == 2


@pytest.mark.parametrize(
    "damage", [lambda b: b[:-1], lambda b: b[:40], lambda b: b"", lambda b: b[:50] + b"x" + b[51:]]
)
def test_a_damaged_file_is_compiled_anew(folder, compilations, damage):
    twice()
    (file,) = folder.iterdir()
    whole = file.read_bytes()
    file.write_bytes(damage(whole))
    assert twice() == 42.0
    assert len(compilations) == 2
    assert file.read_bytes() == whole


@pytest.mark.parametrize("kind", ["file in the way", "missing root"])
def test_a_directory_that_cannot_be_written_is_no_error(tmp_path, monkeypatch, compilations, kind):
    blocked = tmp_path / "file"
    blocked.write_text("not a directory")
    monkeypatch.setenv("CONTWALK_CACHE_DIR", str(blocked if kind == "file in the way" else blocked / "below"))
    assert [twice(), twice()] == [42.0, 42.0]
    assert len(compilations) == 2


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write everywhere")
def test_a_directory_without_permission_is_no_error(tmp_path, monkeypatch, compilations):
    tmp_path.chmod(0o500)
    monkeypatch.setenv("CONTWALK_CACHE_DIR", str(tmp_path))
    assert [twice(), twice()] == [42.0, 42.0]
    assert len(compilations) == 2


@pytest.mark.parametrize("mode", [0o702, 0o777, 0o1777, 0o722])
@pytest.mark.parametrize("which", ["objects", "folder"])
def test_a_folder_that_others_may_write_to_is_not_used(folder, monkeypatch, mode, which):
    object_cache.store("kept", b"code")
    assert object_cache.load("kept") == b"code"
    monkeypatch.setattr(object_cache, "_are_own", {})
    monkeypatch.setattr(object_cache, "refusal", "")
    place = folder if which == "objects" else folder.parent
    place.chmod(mode)
    assert object_cache.load("kept") is None
    object_cache.store("new", b"code")
    assert sorted(path.name for path in folder.iterdir()) == ["kept.o"]
    assert f"is not used, since others may write into {place}:" in object_cache.refusal
    assert "CONTWALK_CACHE_DIR" in object_cache.refusal


def test_a_folder_of_another_user_is_not_used(folder, monkeypatch):
    object_cache.store("kept", b"code")
    monkeypatch.setattr(object_cache, "_are_own", {})
    monkeypatch.setattr(object_cache, "refusal", "")
    monkeypatch.setattr(os, "geteuid", lambda: folder.stat().st_uid + 1)
    if folder.stat().st_uid == 0:  # what the superuser has put there is no one else's
        assert object_cache.load("kept") == b"code"
    else:
        assert object_cache.load("kept") is None


def test_a_new_folder_is_of_its_user_alone_whatever_the_mask(folder, monkeypatch):
    monkeypatch.setenv("CONTWALK_CACHE_DIR", str(folder.parent / "new"))
    before = os.umask(0)
    try:
        object_cache.store("kept", b"code")
    finally:
        os.umask(before)
    assert object_cache.load("kept") == b"code"
    assert (folder.parent / "new").stat().st_mode & 0o077 == 0


def test_nothing_is_left_half_written(folder):
    content = os.urandom(100_000)
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda _: object_cache.store("same", content), range(40)))
    assert [file.name for file in folder.iterdir()] == ["same.o"]
    assert object_cache.load("same") == content


def test_the_oldest_files_make_room(folder, monkeypatch):
    monkeypatch.setattr(object_cache, "MOST_BYTES", 3500)
    for i in range(5):
        object_cache.store(f"object{i}", bytes(1000))
        os.utime(folder / f"object{i}.o", (i, i))
    assert sorted(file.name for file in folder.iterdir()) == ["object2.o", "object3.o", "object4.o"]


def test_what_is_used_stays(folder, monkeypatch):
    """Machine code of a machine that is studied every day is older than that of any tried since."""
    monkeypatch.setattr(object_cache, "MOST_BYTES", 3500)
    for i in range(3):
        object_cache.store(f"object{i}", bytes(1000))
        os.utime(folder / f"object{i}.o", (i, i))
    assert object_cache.load("object0") == bytes(1000)
    object_cache.store("object3", bytes(1000))
    assert sorted(file.name for file in folder.iterdir()) == ["object0.o", "object2.o", "object3.o"]


def test_what_was_used_just_now_is_not_dated_anew(folder, monkeypatch):
    object_cache.store("object", bytes(1000))
    monkeypatch.setattr(os, "utime", lambda path: pytest.fail("written to"))
    assert object_cache.load("object") == bytes(1000)


def test_the_folder_is_not_listed_at_each_write(folder, monkeypatch):
    """With many files that takes longer than compiling does: 400 functions of a machine are 1800 files."""
    listed, scandir = [], os.scandir
    monkeypatch.setattr(os, "scandir", lambda path: (listed.append(path), scandir(path))[1])
    for i in range(50):
        object_cache.store(f"object{i}", bytes(1000))
    assert len(listed) <= 1
    assert len(list(folder.iterdir())) == 50
    listed.clear()
    again = "object_cache._made_room = None; object_cache.store('other', bytes(9))"
    subprocess.run([sys.executable, "-c", f"from contwalk import object_cache; {again}"], check=True)
    assert len(list(folder.iterdir())) == 51, "another process counts on"
    monkeypatch.setattr(object_cache, "MOST_BYTES", 50_000)
    object_cache.store("last", bytes(1000))
    assert len(listed) == 1
    assert len(list(folder.iterdir())) < 50


def test_where_it_is(monkeypatch):
    monkeypatch.delenv("CONTWALK_CACHE_DIR", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", "/somewhere")
    assert object_cache.directory() == Path("/somewhere/contwalk")


def test_parts_of_a_key_do_not_run_together():
    assert object_cache.key("ab", "c") != object_cache.key("a", "bc")


_PROGRAM = """
import sys
from flow_fields import compiled, van_der_pol
from contwalk import flow
field = compiled(van_der_pol, 2, 1)
path = flow.adaptive(field, field.constants([1.0]), 0.0, [2.0, 0.0], 5.0, 1e-9, [1.0, 1.0])
print("numba" in sys.modules, path.status, path.states[-1].tobytes().hex())
"""


def test_a_warm_process_does_without_numba(tmp_path):
    """And gives the same bits as the one that compiled."""
    environment = {
        **os.environ,
        "CONTWALK_CACHE_DIR": str(tmp_path),
        "PYTHONPATH": str(Path(__file__).parent),
    }

    def run():
        command = [sys.executable, "-c", _PROGRAM]
        return subprocess.run(
            command, env=environment, capture_output=True, text=True, check=True
        ).stdout.split()

    cold, warm = run(), run()
    assert cold[:2] == ["True", "ok"]
    assert warm[:2] == ["False", "ok"]
    assert cold[2] == warm[2]

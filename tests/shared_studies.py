"""Studies that several files of tests look at, computed once for all processes and for later test runs.

Databases are kept beside pytest's own temporary folders. The name of each is a digest of all that decides its
content: the run file, what is set in it, the code, the libraries and the environment. One process computes,
under a lock; others wait for it.
"""

from __future__ import annotations

import fcntl
import hashlib
import importlib.metadata
import os
import platform
import sys
import tempfile
import time
from functools import cache
from pathlib import Path

from contwalk.branch import Branch
from contwalk.storage import open_database
from contwalk.workflow.run_file.reading import read_run_file
from contwalk.workflow.runner import run

ROOT = Path(__file__).parents[1]
# Databases that nobody has asked for so many seconds are taken away.
KEPT = 86_400.0
# Whatever else the environment may say changes no number.
DECIDING = ("CONTWALK_", "OPENBLAS_", "MKL_", "NPY_", "NUMBA_", "LD_PRELOAD")
BESIDE = ("CONTWALK_CACHE_DIR", "CONTWALK_TEST_DRAW")
LIBRARIES = ("numpy", "numba", "llvmlite", "scipy", "h5py")


def shared_branches(
    path: Path, overrides: tuple[str, ...] = (), place: Path | None = None
) -> tuple[Branch, ...]:
    """All branches of a run file whose system comes with this project, without its figures."""
    place = place or _folder()
    place.mkdir(parents=True, exist_ok=True)
    database = place / f"{path.stem}-{_digest(path, overrides)}.h5"
    with open(database.with_suffix(".lock"), "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not database.exists():
            _clear(place)
            with tempfile.TemporaryDirectory(dir=place) as own:
                made = run(read_run_file(path, overrides, str(Path(own) / f"{path.stem}.h5")), figures=False)
                os.replace(made.path, database)
    os.utime(database)
    with open_database(database) as db:
        return tuple(db.branches())


def _folder() -> Path:
    """A folder of this user's."""
    return Path(tempfile.gettempdir()) / f"contwalk-studies-of-{os.getuid()}"


def _digest(path: Path, overrides: tuple[str, ...]) -> str:
    asked = "\0".join((path.read_text(encoding="utf-8"), *overrides, _code(), _place()))
    return hashlib.sha256(asked.encode()).hexdigest()[:32]


@cache
def _code() -> str:
    """Texts of the package and of the systems that come with it."""
    digest = hashlib.sha256()
    for folder in ("contwalk", "systems"):
        for file in sorted((ROOT / folder).rglob("*.py")):
            digest.update(file.relative_to(ROOT).as_posix().encode() + b"\0" + file.read_bytes() + b"\0")
    return digest.hexdigest()


def _place() -> str:
    """The machine, the libraries, and what the environment says to them."""
    versions = [f"{name} {importlib.metadata.version(name)}" for name in LIBRARIES]
    said = [f"{k}={v}" for k, v in sorted(os.environ.items()) if k.startswith(DECIDING) and k not in BESIDE]
    return "\0".join((sys.version, platform.machine(), *versions, *said))


def _clear(place: Path) -> None:
    """Take away what nobody has asked for in a day; a lock is as young as the last question."""
    for file in place.glob("*.*"):
        if file.is_file() and time.time() - file.stat().st_mtime > KEPT:
            file.unlink(missing_ok=True)

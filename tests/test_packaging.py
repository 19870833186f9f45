"""What is installed, what it is called, and what a fresh machine needs."""

from __future__ import annotations

import fnmatch
import os
import subprocess
import sys
import tomllib
from importlib.metadata import entry_points
from pathlib import Path

import pytest

import contwalk
from contwalk.system import Family, System

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
SETUPTOOLS = PROJECT["tool"]["setuptools"]
FOLDERS = {
    "contwalk": ROOT / "contwalk",
    "contwalk_systems": ROOT / "systems",
    "contwalk_systems.runs": ROOT / "runs",
}


def packages_on_disk() -> set[str]:
    return {
        ".".join([name, *file.parent.relative_to(folder).parts])
        for name, folder in FOLDERS.items()
        for file in folder.rglob("__init__.py")
    }


def test_every_package_is_shipped():
    assert set(SETUPTOOLS["packages"]) == packages_on_disk()


def test_every_data_file_is_shipped():
    patterns = SETUPTOOLS["package-data"]
    for name, folder in FOLDERS.items():
        for file in folder.rglob("*"):
            # Beside compiled modules there are, for an instant, those that other processes are writing.
            if not file.is_file() or file.suffix == ".py" or file.parent.name == "__pycache__":
                continue
            if file == ROOT / "runs/README.md":  # a page of the documentation
                continue
            package = ".".join([name, *file.parent.relative_to(folder).parts])
            assert any(fnmatch.fnmatch(file.name, pattern) for pattern in patterns.get(package, [])), file


def test_version_is_said_once():
    assert PROJECT["project"]["version"] == contwalk.__version__
    assert f"## {contwalk.__version__}" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


def test_systems_are_found_under_their_names():
    declared = PROJECT["project"]["entry-points"]["contwalk.systems"]
    found = {point.name: point for point in entry_points(group="contwalk.systems")}
    for name, value in declared.items():
        assert found[name].value == value
        loaded = found[name].load()
        assert isinstance(loaded, System | Family)
        assert loaded.name == name


def loaded_by(statement: str) -> set[str]:
    """Top-level modules that a statement imports."""
    code = f"import sys; {statement}; print(*{{name.split('.')[0] for name in sys.modules}})"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


@pytest.mark.parametrize("statement", ["import contwalk", "import contwalk.cli"])
def test_import_costs_nothing(statement):
    heavy = {"numpy", "h5py", "matplotlib", "pydantic", "ruamel", "mpmath", "numba", "scipy"}
    assert loaded_by(statement) & heavy == set()


def test_public_names_exist():
    for name in contwalk.__all__:
        assert getattr(contwalk, name) is not None
    with pytest.raises(AttributeError, match="no_such_name"):
        _ = contwalk.no_such_name


def test_ci_runs_the_test_command_of_the_readme():
    script = ROOT / ".ci/run"
    assert os.access(script, os.X_OK)
    lines = script.read_text(encoding="utf-8").splitlines()
    assert lines[0] == "#!/usr/bin/env bash"
    assert "set -euo pipefail" in lines
    assert "make test" in lines
    assert "make slow || slow=$?" in lines
    assert "    make test" in (ROOT / "README.md").read_text(encoding="utf-8").splitlines()


def make_venv(where: Path, *python: str, path: str | None = None) -> subprocess.CompletedProcess[str]:
    environment = dict(os.environ) if path is None else {"PATH": path}
    return subprocess.run(
        ["/bin/sh", str(ROOT / "tools/make_venv.sh"), str(where), *python],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


def test_no_python_at_all_is_said_clearly(tmp_path):
    done = make_venv(tmp_path / "venv", path=str(tmp_path))
    assert done.returncode == 1
    assert "No Python 3.11 or newer" in done.stderr
    assert not (tmp_path / "venv").exists()


def test_python_that_is_too_old_is_refused(tmp_path):
    old = tmp_path / "python3.9"
    old.write_text("#!/bin/sh\nexit 1\n", encoding="utf-8")
    old.chmod(0o755)
    done = make_venv(tmp_path / "venv", str(old))
    assert done.returncode == 1
    assert f"PYTHON={old} is not a Python 3.11 or newer" in done.stderr


def test_python_that_does_not_run_is_passed_over(tmp_path):
    """A version manager's placeholder exists under every name and fails for all but one."""
    for name in ("python3", "python3.13"):
        (tmp_path / name).write_text("#!/bin/sh\necho not active >&2; exit 127\n", encoding="utf-8")
        (tmp_path / name).chmod(0o755)
    (tmp_path / "python3.12").write_text(f'#!/bin/sh\nexec "{sys.executable}" "$@"\n', encoding="utf-8")
    (tmp_path / "python3.12").chmod(0o755)
    where = tmp_path / "venv"
    done = make_venv(where, path=str(tmp_path))
    assert done.returncode == 0, done.stderr
    assert (where / "bin/python").exists()
    (where / "kept").touch()
    again = make_venv(where, path=str(tmp_path))  # idempotent: nothing to do, nothing said
    assert (again.returncode, again.stdout) == (0, "")
    assert (where / "kept").exists()

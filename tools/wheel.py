"""Try the wheel of `dist/` as a stranger would: an empty environment, an empty folder, no checkout.

python -m tools.wheel            the libraries are those of the environment that runs this: no network
python -m tools.wheel --real     pip gets them; times and sizes are told, for docs/release.md
python -m tools.wheel --real --python python3.12
"""

from __future__ import annotations

import argparse
import os
import resource
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import time
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# Of the newcomer's tests those that take what is installed and read no file of contwalk's own.
TESTS = (
    "tests/closed_forms/test_folds.py",
    "tests/cli/test_entry.py",
    "tests/cli/test_show.py",
    "tests/cli/test_examples.py",
    "tests/cli/test_new.py",
)
COMMANDS = (
    "contwalk --version",
    "contwalk examples",
    "contwalk examples autobalancer_load",
    "contwalk continue autobalancer_load.yaml --quiet",
    "contwalk plot autobalancer_load.h5 --kind eigenvalues --branch b1 -o eigenvalues.pdf",
    "contwalk explore autobalancer_load.h5 -o autobalancer_load.html",
    "contwalk verify autobalancer_load.h5 b1/BP1",
    "contwalk systems list",
    "contwalk new my_machine",
    "contwalk systems check my_machine.py",
    "contwalk continue my_machine.yaml --quiet",
    "contwalk show my_machine.h5 b1/HB1",
)
MADE = (
    "autobalancer_load_bifurcation_diagram.png",
    "autobalancer_load.html",
    "eigenvalues.pdf",
    "my_machine_bifurcation_diagram.png",
)


def main() -> int:
    """Make the environment, and try it; 0 where all is well."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--real", action="store_true", help="install the dependencies from the registry")
    parser.add_argument("--python", default=sys.executable, help="the Python of the environment")
    parser.add_argument("--lowest", action="store_true", help="with --real: the lowest versions")
    given = parser.parse_args()
    wheels = sorted(ROOT.glob("dist/*.whl"))
    if len(wheels) != 1:
        print(f"There are {len(wheels)} wheels in dist/, not one. Make it: make dist")
        return 2
    with tempfile.TemporaryDirectory(prefix="wheel-") as name:
        place = Path(name)
        bin_folder = _installed(wheels[0], place / "venv", given)
        folder = place / "empty"
        folder.mkdir()
        environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
        environment |= {"PATH": f"{bin_folder}{os.pathsep}{os.environ['PATH']}", "LC_ALL": "C.UTF-8"}
        if given.real:  # as on a machine that has never run it
            environment["CONTWALK_CACHE_DIR"] = str(place / "cache")
        return _tried(folder, bin_folder, environment, with_tests=not given.real)


def _installed(wheel: Path, where: Path, given: argparse.Namespace) -> Path:
    """An environment with the wheel; the folder of its programs."""
    subprocess.run([given.python, "-m", "venv", "--without-pip", str(where)], check=True)
    bin_folder = where / "bin"
    pip = [sys.executable, "-m", "pip", "--python", str(bin_folder / "python"), "install", "--quiet"]
    if not given.real:
        subprocess.run([*pip, "--no-index", "--no-deps", str(wheel)], check=True)
        libraries = sysconfig.get_path("purelib")
        folder = _packages(where)
        (folder / "borrowed.pth").write_text(libraries)
        print(f"The libraries are those of {libraries}; contwalk is that of {folder}.")
        return bin_folder
    lowest = _lowest() if given.lowest else []
    begun, used = time.perf_counter(), _seconds()
    subprocess.run([*pip, str(wheel), *lowest], check=True)
    wall, cpu = time.perf_counter() - begun, _seconds() - used
    folder = _packages(where)
    print(f"pip install: {wall:.1f} s, {cpu:.1f} s of processor time")
    for part in sorted(folder.iterdir(), key=_size, reverse=True)[:16]:
        print(f"    {_size(part) / 1e6:7.1f} MB  {part.name}")
    print(f"    {_size(folder) / 1e6:7.1f} MB  in all, {len(list(folder.glob('*.dist-info')))} packages")
    return bin_folder


def _packages(where: Path) -> Path:
    """The folder of an environment that has its packages."""
    return next(where.glob("lib/python*/site-packages"))


def _lowest() -> list[str]:
    """The lower bounds of what it depends on, as versions; a part of a version that is not there is 0."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return [f"{each.replace('>=', '~=')}.0" for each in project["dependencies"]]


def _tried(folder: Path, bin_folder: Path, environment: dict[str, str], with_tests: bool) -> int:
    """Run the commands in an empty folder; 0 where all end well, and have made what they should."""
    for command in ("python -c pass", "python -c 'import contwalk'", *COMMANDS):
        begun, used = time.perf_counter(), _seconds()
        done = subprocess.run(
            command, cwd=folder, env=environment, shell=True, capture_output=True, text=True, check=False
        )
        wall, cpu = time.perf_counter() - begun, _seconds() - used
        print(f"{wall:6.2f} s {cpu:6.2f} s  {command}")
        if done.returncode != 0:
            print(f"{done.stdout}\n{done.stderr}\nThe wheel does not do this.")
            return 1
    missing = [name for name in MADE if not (folder / name).is_file()]
    where = "import contwalk, contwalk_systems; print(contwalk.__file__, contwalk_systems.__file__)"
    told = subprocess.run(
        [str(bin_folder / "python"), "-c", where],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split()
    if missing or not all(Path(path).is_relative_to(bin_folder.parent) for path in told):
        print(f"Missing: {missing}. contwalk was taken from {told}.")
        return 1
    return _tests(folder, environment) if with_tests else 0


def _tests(folder: Path, environment: dict[str, str]) -> int:
    """Some tests of the checkout with the wheel: there is no folder `contwalk` beside them."""
    for name in ("tests", "tools", "runs", "docs", "benchmarks"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", folder)
    command = ["python", "-m", "pytest", "-q", "-p", "no:cacheprovider", "-m", "not slow", *TESTS]
    return subprocess.run(command, cwd=folder, env=environment, check=False).returncode


def _seconds() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _size(path: Path) -> int:
    """Bytes of a file, or of all in a folder."""
    files = [path] if path.is_file() else [inner for inner in path.rglob("*") if inner.is_file()]
    return sum(file.stat().st_size for file in files)


if __name__ == "__main__":
    sys.exit(main())

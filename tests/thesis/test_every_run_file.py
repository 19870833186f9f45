"""Every file of runs/ as it is written: its commands end with success, and find what runs/README.md tells.

`make runs` runs them all, which takes an hour of processor time, and prints what each took. Their pages are
left in build/runs, from where `make docs` takes them for the gallery of the site.
"""

from __future__ import annotations

import os
import re
import resource
import shutil
import subprocess
import sys
from decimal import Decimal
from pathlib import Path

import pytest
from autobalancer_figures import RUNS
from documented_values import DOCUMENTED, MEANS, Told

from contwalk.branch import SpecialPoint
from contwalk.errors import DatabaseError
from contwalk.storage import open_database
from contwalk.storage.trajectory import is_of_margins

pytestmark = pytest.mark.thesis

PAGES = RUNS.parent / "build/runs"
# Bytes that a page may have, whatever its study.
MOST = 5e6
NAMES = sorted(path.stem for path in RUNS.glob("*.yaml"))
# Databases of other run files that one begins at, as it names them.
BEGINS_AT = re.compile(r"from: (\w+)\.h5")


def commands(name: str) -> list[str]:
    """What is done with a run file, in this order: what its sections are for."""
    text = (RUNS / f"{name}.yaml").read_text(encoding="utf-8")
    sections = re.findall(r"^(\w+):", text, re.MULTILINE)
    chosen = {
        "sample": "sample",
        "simulate": "simulate",
        "continue": "continue",
        "path": "continue",
        "margins": "margins",
    }
    return list(dict.fromkeys(chosen[section] for section in chosen if section in sections))


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the folder, where the databases come to lie."""
    place = tmp_path_factory.mktemp("runs")
    for path in RUNS.glob("*.yaml"):
        shutil.copy(path, place)
    return place


def run(folder: Path, name: str) -> tuple[float, str]:
    """Run a file's commands; processor seconds, without those of files that it begins at, and the reports."""
    for other in BEGINS_AT.findall((folder / f"{name}.yaml").read_text(encoding="utf-8")):
        if other != name and not (folder / f"{other}.h5").exists():
            run(folder, other)
    before, reports = _seconds(), []
    for command in commands(name):
        done = subprocess.run(
            [sys.executable, "-m", "contwalk", command, f"{name}.yaml", "--force"],
            cwd=folder,
            env=os.environ | {"COLUMNS": "200"},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, f"{command} {name}.yaml: {done.stderr[-2000:]}"
        reports.append(done.stdout)
    return _seconds() - before, "".join(reports)


def _seconds() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def one_unit(text: str) -> float:
    """One unit of the last digit of a number."""
    return 10.0 ** int(Decimal(text).as_tuple().exponent)


def found(points: list[SpecialPoint], told: Told) -> bool:
    """Whether a point is told, to one unit of the last digit of each parameter."""
    label, values = told
    return any(
        point.label == label
        and all(
            name in point.parameters and abs(point.parameters[name] - float(text)) <= one_unit(text)
            for name, text in values.items()
        )
        for point in points
    )


def test_what_is_documented_is_of_run_files_and_of_their_table():
    table = (RUNS / "README.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| `(\w+)` \|(.*)$", table, re.MULTILINE))
    assert set(DOCUMENTED) | set(MEANS) <= set(NAMES)
    for name, told in DOCUMENTED.items():
        for label, values in told:
            assert all(text in rows[name] for text in values.values()), (name, label, values)
    for name, text in MEANS.items():
        assert text in rows[name]


@pytest.mark.slow
@pytest.mark.runs
@pytest.mark.parametrize("name", NAMES)
def test_run_file(name: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    seconds, report = run(folder, name)
    with capsys.disabled():
        print(f"\n{name}: {', '.join(commands(name))}: {seconds:.1f} s of processor time", end=" ")
    _leave_pages(name, folder)
    if name in MEANS:
        mean = re.search(r"mean +([0-9.]+)", report)
        assert mean is not None
        told = MEANS[name].split(" ± ")[0]
        assert abs(float(mean.group(1)) - float(told)) <= one_unit(told)
        return
    if "continue" not in commands(name):
        return
    with open_database(folder / f"{name}.h5") as database:
        points = [point for branch in database.branches() for point in branch.special_points]
    missing = [told for told in DOCUMENTED.get(name, []) if not found(points, told)]
    assert not missing, [(point.label, dict(point.parameters)) for point in points][:40]


def _leave_pages(name: str, folder: Path) -> None:
    """Write the pages of what a run file has left: of its branches, and of its margins."""
    for stem in (name, f"{name}_margins"):
        if not (folder / f"{stem}.h5").exists() or not _shown(folder / f"{stem}.h5"):
            continue
        page = folder / f"{stem}.html"
        done = subprocess.run(
            [sys.executable, "-m", "contwalk", "explore", f"{stem}.h5", "-o", page.name, "--force"],
            cwd=folder,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, f"explore {stem}.h5: {done.stderr[-2000:]}"
        assert page.stat().st_size <= MOST, stem
        PAGES.mkdir(parents=True, exist_ok=True)
        shutil.copy(page, PAGES)


def _shown(database: Path) -> bool:
    """Whether a page can be made of a file: one of motions alone has no branches."""
    if is_of_margins(database):
        return True
    try:
        with open_database(database) as opened:
            return bool(opened.branch_names())
    except DatabaseError:
        return False

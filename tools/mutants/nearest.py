"""Which tests are nearest to a line: those that run it, those whose file mirrors it first."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from collections import Counter
from pathlib import Path

# How many tests of one file are asked at most.
OF_ONE_FILE = 20
# A test that takes longer than this is asked only where nothing else runs the line.
LONG = 12.0


def measure(root: Path, folder: Path, jobs: int) -> None:
    """Run all tests that are not slow once, and keep which lines each of them runs and how long it takes."""
    folder.mkdir(parents=True, exist_ok=True)
    options = ["-q", "-m", "not slow", "-n", str(jobs), "-p", "no:cacheprovider"]
    options += ["--cov=contwalk", "--cov-context=test", "--cov-report="]
    options += [f"--junitxml={folder / 'times.xml'}", "-o", "junit_family=xunit1"]
    environment = os.environ | {"COVERAGE_FILE": str(folder / "coverage"), "OPENBLAS_NUM_THREADS": "1"}
    subprocess.run([sys.executable, "-m", "pytest", *options], cwd=root, env=environment, check=False)


class Nearest:
    """Tests by the lines that they run, as `measure` has found them; `worth` seconds of them for a mutant."""

    def __init__(self, root: Path, folder: Path, worth: float) -> None:
        import coverage

        self._root, self._worth = root, worth
        self._data = coverage.CoverageData(str(folder / "coverage"))
        self._data.read()
        self._seconds = _timed(folder / "times.xml")
        self._lines: dict[str, dict[int, set[str]]] = {}
        self._beside: dict[str, set[str]] = {}

    def to(self, file: str, line: int) -> tuple[list[str], bool]:
        """Tests in the order in which to ask them, and whether they run the line itself.

        What machine code runs is not seen, nor what an import runs. Then those tests are asked that run
        any line of the file, or of files that name it as those do that call the machine code; the tests in
        the folder that mirrors the file's come first.
        """
        lines = self._tests_by_line(file)
        if lines.get(line):
            return self._chosen(lines[line], file), True
        if file not in self._beside:
            around = [file, *self._naming(file)]
            self._beside[file] = set().union(*(t for f in around for t in self._tests_by_line(f).values()))
        return self._chosen(self._beside[file], file), False

    def _naming(self, file: str) -> list[str]:
        """Files whose text has the name of a module."""
        name = re.compile(rf"\b{Path(file).stem}\b")
        paths = sorted((self._root / "contwalk").rglob("*.py"))
        return [str(p.relative_to(self._root)) for p in paths if name.search(p.read_text())]

    def _tests_by_line(self, file: str) -> dict[int, set[str]]:
        if file not in self._lines:
            contexts = self._data.contexts_by_lineno(str(self._root / file))
            self._lines[file] = {
                line: {c.rpartition("|")[0] for c in found} & self._seconds.keys()
                for line, found in contexts.items()
            }
        return self._lines[file]

    def _chosen(self, tests: set[str], file: str) -> list[str]:
        """Those whose file mirrors the mutant's first, the quick ones before the long."""

        def rank(test: str) -> tuple[int, float]:
            return -common_parts(file, test.partition("::")[0]), self._seconds[test]

        chosen: list[str] = []
        spent, of_file = 0.0, Counter[str]()
        for test in sorted(tests, key=rank):
            seconds, home = self._seconds[test], test.partition("::")[0]
            if chosen and (of_file[home] >= OF_ONE_FILE or seconds > LONG or spent + seconds > self._worth):
                continue
            chosen.append(test)
            of_file[home] += 1
            spent += seconds
        return chosen

    def seconds(self, tests: list[str]) -> float:
        """What these tests took when they were measured."""
        return sum(self._seconds[test] for test in tests)


def common_parts(file: str, test: str) -> int:
    """How many folders, and whether the name, of a file of tests are those of a file of the package."""
    path = test.replace("test_", "").removesuffix(".py")
    return len(set(Path(file).with_suffix("").parts[1:]) & set(path.split("/")[1:]))


def _timed(times: Path) -> dict[str, float]:
    """What each test that passed took, by its node."""
    seconds = {}
    for case in ElementTree.parse(times).getroot().iter("testcase"):
        file, name = case.get("file"), case.get("name")
        if (
            file is None
            or name is None
            or any(child.tag in ("failure", "error", "skipped") for child in case)
        ):
            continue
        group = (case.get("classname") or "").rpartition(".")[2]
        inside = "" if group == Path(file).stem else f"{group}::"
        seconds[f"{file}::{inside}{name}"] = float(case.get("time") or 0.0)
    return seconds

"""What tests take, from reports of runs: files in `tests/durations.txt`, costly tests in `tests/turns.txt`.

CONTWALK_TEST_DRAW=all make slow TEST_OPTIONS=--junitxml=slow.xml
CONTWALK_TEST_DRAW=all make test TEST_OPTIONS=--junitxml=test.xml
python -m tools.durations slow.xml test.xml
"""

from __future__ import annotations

import sys
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).parents[1]
# Files that take fewer seconds may come in any order.
LEAST = 3.0
# Tests that take as many, with all their variants, take turns.
COSTLY = 0.2
TURNS = "# Tests that take turns, slow ones first: see turns.py. tools/durations.py writes this list.\n"


def file_of(name: str, root: Path = ROOT) -> str | None:
    """The file of a module or of a class in it, as `tests.flow.test_field.TestField`, or None."""
    parts = name.split(".")
    for k in range(len(parts), 0, -1):
        path = Path(*parts[:k]).with_suffix(".py")
        if (root / path).is_file():
            return path.as_posix()
    return None


def cases(report: Path, root: Path) -> Iterator[tuple[str, str, float]]:
    """File, node without parameters, and seconds of each test of a report whose file there is."""
    for case in ElementTree.parse(report).iter("testcase"):
        module = case.get("classname", "")
        file = file_of(module, root)
        if file is not None:
            owner = module.split(".")[len(Path(file).parts) :]
            node = "::".join([file, *owner, case.get("name", "").partition("[")[0]])
            yield file, node, float(case.get("time", 0.0))


def written(reports: Iterable[Path], root: Path = ROOT) -> str:
    """The table: seconds and file in each line, the longest first."""
    seconds: dict[str, float] = defaultdict(float)
    for report in reports:
        for file, _, taken in cases(report, root):
            seconds[file] += taken
    longest = sorted(seconds.items(), key=lambda entry: (-entry[1], entry[0]))
    return "".join(f"{taken:.0f} {file}\n" for file, taken in longest if taken >= LEAST)


def costly(reports: Iterable[Path], root: Path = ROOT) -> str:
    """The list of tests that take turns, by their nodes without parameters.

    Report by report, so that each part of the suite is divided, and the most costly of each first.
    """
    text, known = TURNS, set[str]()
    for report in reports:
        seconds: dict[str, float] = defaultdict(float)
        for _, node, taken in cases(report, root):
            seconds[node] += taken
        text += in_order({node: taken for node, taken in seconds.items() if node not in known})
        known |= set(seconds)
    return text


def in_order(seconds: Mapping[str, float]) -> str:
    """Lines of the costly ones, by their seconds."""
    longest = sorted(seconds.items(), key=lambda entry: (-entry[1], entry[0]))
    return "".join(f"{node}\n" for node, taken in longest if taken >= COSTLY)


if __name__ == "__main__":
    given = [Path(name) for name in sys.argv[1:]]
    (ROOT / "tests" / "durations.txt").write_text(written(given), encoding="utf-8")
    (ROOT / "tests" / "turns.txt").write_text(costly(given), encoding="utf-8")

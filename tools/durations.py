"""What the files of tests take, written to `tests/durations.txt` from reports of test runs.

make slow TEST_OPTIONS=--junitxml=slow.xml
make test TEST_OPTIONS=--junitxml=test.xml
python -m tools.durations slow.xml test.xml
"""

from __future__ import annotations

import sys
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).parents[1]
# Files that take fewer seconds may come in any order.
LEAST = 3.0


def file_of(name: str, root: Path = ROOT) -> str | None:
    """The file of a module or of a class in it, as `tests.flow.test_field.TestField`, or None."""
    parts = name.split(".")
    for k in range(len(parts), 0, -1):
        path = Path(*parts[:k]).with_suffix(".py")
        if (root / path).is_file():
            return path.as_posix()
    return None


def written(reports: Iterable[Path], root: Path = ROOT) -> str:
    """The table: seconds and file in each line, the longest first."""
    seconds: dict[str, float] = defaultdict(float)
    for report in reports:
        for case in ElementTree.parse(report).iter("testcase"):
            file = file_of(case.get("classname", ""), root)
            if file is not None:
                seconds[file] += float(case.get("time", 0.0))
    longest = sorted(seconds.items(), key=lambda entry: (-entry[1], entry[0]))
    return "".join(f"{taken:.0f} {file}\n" for file, taken in longest if taken >= LEAST)


if __name__ == "__main__":
    (ROOT / "tests" / "durations.txt").write_text(written(map(Path, sys.argv[1:])), encoding="utf-8")

"""The order in which files of tests are given to the processes that share them: the longest first.

A file that begins last keeps one core busy while the others have nothing left. What files take is a table,
`durations.txt`, which `tools/durations.py` writes; it need not be exact, and a file that is not in it is
expected to take what its like take.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

DURATIONS = Path(__file__).parent / "durations.txt"
# Seconds that a test takes on the average, of those marked `slow` and of the others.
SLOW, OTHER = 5.0, 0.1


def table() -> dict[str, float]:
    """Seconds of files, by their paths from the top of the project."""
    lines = DURATIONS.read_text(encoding="utf-8").splitlines()
    return {name: float(seconds) for seconds, name in map(str.split, lines)}


def expected(file: str, slow: int, others: int, known: Mapping[str, float]) -> float:
    """Seconds that a file takes: as the table says, or from how many tests it has."""
    return known.get(file, SLOW * slow + OTHER * others)


def longest_first(files: Sequence[str], slow: Sequence[bool], known: Mapping[str, float]) -> list[int]:
    """Numbers of tests, of which the files and the marks are given, in the order to run them in."""
    counts = Counter(zip(files, slow, strict=True))
    takes = {file: expected(file, counts[file, True], counts[file, False], known) for file in files}
    return sorted(range(len(files)), key=lambda k: (-takes[files[k]], files[k], k))

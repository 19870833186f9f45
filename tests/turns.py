"""Costly tests take turns: of each five that cost about the same, a run tries one, and five runs try all.

`turns.txt` names them, slow ones first, the most costly of each first; `tools/durations.py` writes it. Draw 1
tries the first, sixth, eleventh, draw 2 the second, seventh, twelfth, and so on; `CONTWALK_TEST_DRAW=all`
tries all. What waits is marked `long`. `.ci/run` draws by the number of commits, so that each is tried at
every fifth one; what stands in `quick.txt` never waits.
"""

from __future__ import annotations

import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path

import pytest

HERE = Path(__file__).parent
EVERYTHING = "all"
# So many runs try all of them.
DRAWS = 5


def listed(path: Path) -> list[str]:
    """Lines of a list of tests, comments left out."""
    return [line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]


def table() -> dict[str, int]:
    """Places in the list of those that take turns, by their nodes without parameters."""
    always, named = tuple(listed(HERE / "quick.txt")), listed(HERE / "turns.txt")
    return {node: k for k, node in enumerate(named) if not node.startswith(always)}


def turn_of(seed: str) -> int | None:
    """Which of five is tried, from 0 on; None where all are."""
    if seed == EVERYTHING:
        return None
    return (int(seed) if seed.isdigit() else zlib.crc32(seed.encode())) % DRAWS


def wait_for_their_turn(items: Sequence[pytest.Item], seed: str, known: Mapping[str, int]) -> None:
    """Mark as long what another draw tries."""
    turn = turn_of(seed)
    if turn is None:
        return
    for item in items:
        place = known.get(item.nodeid.partition("[")[0])
        if place is not None and (place + 1) % DRAWS != turn:
            item.add_marker(pytest.mark.long)


def leave_bits_out(items: Sequence[pytest.Item], seed_of_noise: str, named: Sequence[str]) -> None:
    """Where noise changes last bits on purpose, skip the tests that compare these."""
    if not seed_of_noise:
        return
    for item in items:
        if item.nodeid.partition("[")[0] in named:
            item.add_marker(pytest.mark.skip(reason="it compares last bits, which CONTWALK_NOISE changes"))

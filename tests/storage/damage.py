"""Damage to a database, and what reading it then gives."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from contwalk.errors import DatabaseError
from contwalk.storage import document, open_database
from contwalk.storage.seal import LENGTH, append_seal


def answer(path: Path) -> str:
    """Everything that can be read; the sentence of a refusal, after `refused: `."""
    try:
        with open_database(path) as db:
            told = document(db, points=True)
            return json.dumps([told, db.notes(), dict(db.header.provenance)])
    except DatabaseError as error:
        told_where = error.sentence.startswith(str(path)) and error.remedy
        return f"refused: {error}" if told_where else f"no place or no remedy: {error}"


def sealed(path: Path) -> None:
    """Seal a file that another program has changed: how that is done is no secret."""
    append_seal(path)


def with_seal_of(copy: bytes, content: bytes) -> bytes:
    """A damaged copy of what stands before a seal, with that seal behind it."""
    return copy + content[-LENGTH:]


def without_seal(content: bytes) -> bytes:
    """What stands before the seal."""
    return content[:-LENGTH]


def flipped(content: bytes, count: int, seed: int) -> Iterator[bytes]:
    """Copies with one bit flipped, anywhere."""
    for bit in np.random.default_rng(seed).integers(0, 8 * len(content), count):
        broken = bytearray(content)
        broken[bit // 8] ^= 1 << (bit % 8)
        yield bytes(broken)


def truncated(content: bytes, count: int, seed: int) -> Iterator[bytes]:
    """Copies without their end; of the shortest ones only some bytes are missing."""
    random = np.random.default_rng(seed)
    for number in range(count):
        lost = random.integers(1, 200) if number % 4 == 0 else random.integers(1, len(content))
        yield content[: -int(lost)]


def outcomes(path: Path, copies: Iterator[bytes]) -> dict[str, int]:
    """How many damaged copies, read at `path`, give the same answer as it does, are refused, or neither."""
    right = answer(path)
    assert not right.startswith("refused")
    counts = {"same": 0, "refused": 0, "another": 0}
    damaged = path.with_name("damaged.h5")
    for copy in copies:
        damaged.write_bytes(copy)
        found = answer(damaged)
        refused = found.startswith("refused")
        counts["refused" if refused else "same" if found == right else "another"] += 1
    return counts

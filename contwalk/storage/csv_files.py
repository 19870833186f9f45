"""Tables as CSV files: whole, with all digits, and nothing in them that a spreadsheet would compute."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from contwalk.files.drafts import written
from contwalk.printable import printable
from contwalk.storage.failures import creating

# With one of these a text begins what a spreadsheet takes for a formula.
_FORMULAS = ("=", "+", "-", "@", "\t", "\r")


def write_csv(path: Path, header: Sequence[str], rows: Iterable[Sequence[Any]], new: bool = False) -> Path:
    """Write a table; a file that exists is replaced when the new one is complete, or kept if it is `new`.

    Floats have as many digits as reading them back exactly needs, and truth is `true` or `false`. A text that
    a spreadsheet would take for a formula has an apostrophe before it; control characters become their codes.

    Raises
    ------
    DatabaseError
        If it cannot be written, or would go over another.
    """
    with creating(path), written(path, "t", new) as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(map(_cell, header))
        writer.writerows(map(_cell, row) for row in rows)
    return path


def _cell(value: Any) -> Any:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        text = printable(value)
        return f"'{text}" if value.startswith(_FORMULAS) and not _are_numbers(value) else text
    return repr(value) if isinstance(value, float) else value


def _are_numbers(text: str) -> bool:
    try:
        return bool([float(part) for part in text.split(" ")])
    except ValueError:
        return False
